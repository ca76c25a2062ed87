from dataclasses import replace

import numpy as np
import pytest
from cell_fakes import finished, frame, overhand

from executive.core.work import InlineWorker
from perception.cable.orientation import reversed_crossings, reversed_trace
from perception.cable.polyline import arc_lengths
from perception.cable.types import Coverage, Endpoint, Knot, Trace, TraceEnd, TraceStart
from perception.fresh_camera import FrozenError
from skills.cable.account_for_cable import AccountForCable
from skills.cable.connectors import with_connectors
from skills.cable.detect_endpoints import DetectEndpoints
from skills.cable.find_start_points import FindStartPoints
from skills.cable.observe_workspace import ObserveWorkspace
from skills.cable.orient_trace import OrientTrace
from skills.cable.state_claim import StateClaim
from skills.cable.trace_cable import TraceCable


class KnotNearTheEnd:
    """Finds a knot over the last fifth of the path that runs to the right."""

    def __init__(self, trace, covered=None):
        self.forward = trace.points_px
        self.covered = covered

    def knots(self, image, traces, crossings):
        same = np.allclose(traces[0].points_px, self.forward)
        interval = (0.8, 0.9) if same else (0.1, 0.2)
        nothing = np.zeros(2)
        return (Knot(0, interval, nothing, nothing, nothing, nothing, nothing),)

    def endpoints(self, image):
        return ()

    def coverage(self, image, trace):
        return self.covered


class DarkCamera:
    def capture(self):
        dark = frame()
        dark.image[:] = 7
        return dark


def test_a_trace_is_turned_to_the_end_that_is_nearer_to_its_knot():
    trace, crossings, _ = overhand()
    skill = OrientTrace(KnotNearTheEnd(trace), InlineWorker())
    outcome, _ = finished(skill, {"frame": frame(), "trace": trace, "crossings": crossings})
    assert np.allclose(outcome.outputs["trace"].points_px, trace.points_px[::-1])
    assert outcome.outputs["crossings"][0].arc_over == pytest.approx(1 - crossings[0].arc_over)


def test_turning_round_twice_changes_nothing():
    trace, crossings, _ = overhand()
    assert np.allclose(reversed_trace(reversed_trace(trace)).points_px, trace.points_px)
    twice = reversed_crossings(reversed_crossings(crossings))
    assert twice[0].arc_under == pytest.approx(crossings[0].arc_under)


@pytest.mark.parametrize(
    ("covered", "answer"),
    [
        (Coverage(1.0, 0), None),
        (Coverage(0.97, 20), None),
        (Coverage(0.5, 20), "cable.unexplained"),
        (Coverage(0.99, 200), "cable.unexplained"),
    ],
)
def test_cable_that_is_left_over_forbids_a_claim(covered, answer):
    trace, _, _ = overhand()
    skill = AccountForCable(KnotNearTheEnd(trace, covered), InlineWorker())
    outcome, _ = finished(skill, {"frame": frame(), "trace": trace})
    assert (outcome.reason and outcome.reason.code) == answer


@pytest.mark.parametrize(("missing_m", "answer"), [(0.0, None), (0.01, None), (0.1, "cable.short")])
def test_cable_that_is_too_short_hides_some_of_it(missing_m, answer):
    trace, _, _ = overhand()
    whole = with_connectors(replace(trace, end=TraceEnd.ENDPOINT))
    seen_m = arc_lengths(frame().camera.on_plane(whole.points_px))[-1]
    skill = AccountForCable(KnotNearTheEnd(trace, Coverage(1.0, 0)), InlineWorker())
    inputs = {"frame": frame(), "trace": replace(trace, end=TraceEnd.ENDPOINT)}
    outcome, _ = finished(skill, {**inputs, "length_m": seen_m + missing_m})
    assert (outcome.reason and outcome.reason.code) == answer


@pytest.mark.parametrize(("knotted", "untangled"), [(0.04, True), (0.06, False), (0.5, False)])
def test_untangled_is_claimed_only_above_the_confidence(knotted, untangled):
    outcome, _ = finished(StateClaim(), {"knotted_probability": knotted, "confidence": 0.95})
    assert outcome.outputs["claim"].untangled is untangled


def test_no_end_and_no_light_have_reasons():
    trace, _, _ = overhand()
    outcome, _ = finished(
        DetectEndpoints(KnotNearTheEnd(trace), InlineWorker()), {"frame": frame()}
    )
    assert outcome.reason.code == "endpoints.none"
    outcome, _ = finished(ObserveWorkspace(DarkCamera()), {})
    assert outcome.reason.code == "camera.dark"


def test_connectors_belong_to_a_trace_that_has_come_to_an_end_and_to_no_other():
    line = np.column_stack([np.linspace(100.0, 300.0, 50), np.full(50, 200.0)])
    whole = with_connectors(Trace(line, TraceEnd.ENDPOINT, 0.9))
    assert np.allclose(whole.points_px[[0, -1]], [(60.0, 200.0), (340.0, 200.0)])
    lost = Trace(line, TraceEnd.LOST, 0.9)
    assert with_connectors(lost) is lost


class StutteringCamera:
    """Gives its last frame a number of times before there is a new one."""

    def __init__(self, times):
        self.left = times

    def capture(self):
        self.left -= 1
        if self.left >= 0:
            raise FrozenError("camera: has frozen")
        lit = frame()
        lit.image[0, 0] = 200
        return lit


def test_a_camera_that_stutters_is_waited_for_and_one_that_has_frozen_is_broken():
    outcome, ticks = finished(ObserveWorkspace(StutteringCamera(3)), {})
    assert outcome.status == "SUCCESS"
    assert ticks == 5
    with pytest.raises(FrozenError, match="has frozen"):
        finished(ObserveWorkspace(StutteringCamera(1000)), {})


class LostFromTheLeft:
    """Loses the cable on the way from the end at x = 300, and follows it from the other one."""

    def __init__(self):
        self.asked = 0

    def trace(self, image, start_px, endpoints):
        self.asked += 1
        lost = start_px[0, 0] == 300.0
        return Trace(start_px, TraceEnd.LOST if lost else TraceEnd.ENDPOINT, 0.9)


def traced(vision, **more):
    ends = tuple(Endpoint(np.array([x, 300.0]), np.array([1.0, 0.0]), 0.9) for x in (300.0, 700.0))
    skill = TraceCable(vision, InlineWorker())
    inputs = {"frame": frame(), "start": TraceStart.at(ends[0]), "endpoints": ends, **more}
    return finished(skill, inputs)[0].outputs["trace"]


def test_a_trace_that_is_lost_from_one_end_is_begun_at_the_other():
    assert traced(LostFromTheLeft(), other_ends=True).end is TraceEnd.ENDPOINT


def test_the_thesis_traces_from_one_end_only():
    vision = LostFromTheLeft()
    assert traced(vision).end is TraceEnd.LOST
    assert vision.asked == 1


def test_only_an_end_among_strands_is_no_clear_start():
    class Crowded:
        def start_points(self, image, endpoint):
            return None

    ends = (Endpoint(np.array([100.0, 50.0]), np.array([0.0, 1.0]), 0.9),)
    skill = FindStartPoints(Crowded(), InlineWorker())
    outcome, _ = finished(skill, {"frame": frame(), "endpoints": ends})
    assert outcome.reason.code == "start.unclear"
    outcome, _ = finished(skill, {"frame": frame(), "endpoints": ends, "clear": False})
    ahead = np.diff(outcome.outputs["start"].points_px, axis=0)[0]
    assert np.allclose(ahead / np.linalg.norm(ahead), ends[0].direction)
