"""Before a claim: two looks at one cable must show the same, and a mission says how it ended."""

from dataclasses import replace

import numpy as np
import pytest
from cell_fakes import finished, frame

from executive.core.work import InlineWorker
from perception.cable.orientation import reversed_crossings, reversed_trace
from perception.cable.polyline import arc_lengths
from perception.cable.topology.curve import self_intersections
from perception.cable.types import CableClaim, Crossing, Endpoint, Trace, TraceEnd
from skills.cable.compare_looks import CompareLooks
from skills.cable.conclude import Conclude
from skills.cable.find_start_points import FindStartPoints


def looked(over):
    """Return a trefoil's trace with crossings that lie as told."""
    t = np.linspace(0.1, 2.0 * np.pi - 0.1, 400)
    path = 100.0 * np.column_stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t)])
    arcs, rows = arc_lengths(path), np.arange(len(path))
    first, second, _ = self_intersections(path)
    found = []
    for visits, first_over in zip(zip(first, second, strict=True), over, strict=True):
        a, b = (float(np.interp(visit, rows, arcs) / arcs[-1]) for visit in visits)
        up, down = (a, b) if first_over else (b, a)
        found.append(Crossing(path[int(visits[0])], 0, up, 0, down, 0.99))
    return Trace(path, TraceEnd.ENDPOINT, 1.0), tuple(found)


def compared(one, other, beliefs=(0.02, 0.03)):
    """Compare two looks."""
    inputs = {"trace": one[0], "crossings": one[1], "knotted": beliefs[0]}
    inputs |= {"other_trace": other[0], "other_crossings": other[1], "other_knotted": beliefs[1]}
    return finished(CompareLooks(InlineWorker()), inputs)[0]


@pytest.mark.parametrize("beliefs", [(0.02, 0.03), (0.2, 0.01)])
def test_looks_from_both_ends_agree_and_the_less_sure_one_counts(beliefs):
    one = looked((True, True, False))
    other = reversed_trace(one[0]), reversed_crossings(one[1])
    assert compared(one, other, beliefs).outputs == {"knotted_probability": max(beliefs)}


def test_doubt_of_the_path_alone_does_not_count_where_both_came_to_the_same():
    trace, crossings = looked((True, True, False))
    fair = (replace(trace, probability=0.8), crossings)
    agreed = compared((trace, crossings), fair, (0.02, 0.5 * 0.2 + 0.01))
    assert agreed.outputs["knotted_probability"] == pytest.approx(0.02)
    doubtful = compared((trace, crossings), fair, (0.02, 0.5 * 0.2 + 0.06))
    assert doubtful.outputs["knotted_probability"] == pytest.approx(0.06)
    lost = (replace(trace, probability=0.5), crossings)
    assert compared((trace, crossings), lost).reason.code == "looks.unsure"


def test_looks_that_see_another_strand_on_top_disagree():
    outcome = compared(looked((True, False, True)), looked((True, False, False)))
    assert outcome.reason.code == "looks.disagree"


def test_a_twist_that_only_one_look_sees_does_not_matter():
    angle = np.linspace(0.0, 1.5 * np.pi, 120)
    circle = 100.0 * np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])
    lead = np.column_stack([np.linspace(-300.0, 0.0, 100)[:-1], np.zeros(99)])
    trace = Trace(np.vstack([lead, circle, [(-100.0, -200.0)]]), TraceEnd.ENDPOINT, 1.0)
    crossing = Crossing(np.array([-100.0, 0.0]), 0, 0.2, 0, 0.8, 0.99)
    outcome = compared((trace, (crossing,)), (trace, ()))
    assert outcome.outputs["knotted_probability"] == 0.03


def test_a_second_trace_begins_far_from_where_the_first_began():
    trace = looked((True, True, True))[0]
    ends = tuple(Endpoint(place, np.array([1.0, 0.0]), 0.9) for place in trace.points_px[[0, -1]])
    vision = type("Vision", (), {"start_points": staticmethod(lambda *_: None)})()
    skill = FindStartPoints(vision, InlineWorker())
    inputs = {"frame": frame(), "endpoints": ends, "clear": False}
    for path, expected in ((None, ends[0]), (trace, ends[1]), (reversed_trace(trace), ends[0])):
        outcome, _ = finished(skill, {**inputs, "after": path})
        assert outcome.outputs["start"].endpoint is expected


@pytest.mark.parametrize(
    ("claim", "code"),
    [
        (CableClaim(True, 0.01), None),
        (CableClaim(False, 0.99), "cable.knotted"),
        (CableClaim(False, 0.5), "cable.unclear"),
        (CableClaim(False, 0.06), "cable.unclear"),
    ],
)
def test_a_round_ends_with_what_is_known(claim, code):
    outcome = finished(Conclude(), {"claim": claim})[0]
    assert (outcome.reason.code if outcome.reason else None) == code
