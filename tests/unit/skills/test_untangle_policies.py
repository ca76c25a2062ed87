"""The tree of the untangling mission with scripted looks: what each policy does about them."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from cell_fakes import ArrivingArms, frame, overhand

from executive.app.catalogue import port_types, skills
from executive.core.clock import ManualClock
from executive.core.errors import InputError
from executive.core.work import InlineWorker
from executive.engine.loading.loader import load_mission
from executive.engine.nodes.builder import build
from executive.engine.running.runner import MissionOutcome, Runner
from perception.cable.selectable import SelectableVision
from perception.cable.types import CableClaim, Coverage, Endpoint, TraceEnd
from skills.cable.policies import POLICIES, POLICY_NAMES

MISSION = Path(__file__).parents[3] / "trees/missions/untangle.yaml"
TRACE, CROSSINGS, MIDDLE = overhand()
# Held where its strands are farthest apart.
KNOT = replace(
    MIDDLE,
    cage_px=TRACE.points_px[130],
    pinch_px=TRACE.points_px[300],
)


@dataclass(frozen=True)
class Look:
    """What perception answers to one look."""

    end: TraceEnd = TraceEnd.ENDPOINT
    knots: int = 0
    knotted: float = 0.0
    ends: int = 2
    start: bool = True
    explained: float = 1.0
    pieces: bool = True


KNOTTED = Look(knots=1, knotted=0.98)
DONE = Look(knotted=0.01)


class ScriptedVision:
    """A `CableVision` that answers each look from a list, the last one again and again."""

    def __init__(self, *looks):
        self.looks, self.taken = looks, 0

    @property
    def now(self):
        return self.looks[min(self.taken, len(self.looks)) - 1]

    def cable_pixels(self, image):
        return np.zeros(image.shape, dtype=bool)

    def pieces(self, image):
        piece = np.column_stack([np.linspace(400, 600, 50), np.full(50, 375.0)])
        return (piece,) if self.now.pieces else ()

    def endpoints(self, image):
        self.taken += 1
        places = TRACE.points_px[[0, -1]][: self.now.ends]
        return tuple(Endpoint(place - (200, 0), np.array([-1.0, 0.0]), 0.9) for place in places)

    def start_points(self, image, endpoint):
        return TRACE.points_px[:5] if self.now.start else None

    def trace(self, image, start_px, endpoints):
        return replace(TRACE, end=self.now.end)

    def coverage(self, image, trace):
        return Coverage(self.now.explained, 0)

    def crossings(self, image, traces):
        return CROSSINGS

    def knots(self, image, traces, crossings):
        return (KNOT,) * self.now.knots

    def knotted_probability(self, traces, crossings):
        return self.now.knotted

    def scene(self, image, start_px=None):
        raise NotImplementedError


class Cell:
    """A cell that is nothing but its clock."""

    def __init__(self):
        self.clock, self.devices = ManualClock(), {}

    def drain_streams(self):
        return ()

    def stop(self):
        pass

    emergency_stop = close = stop

    def truth(self):
        return None


class Acts:
    """An observer that notes which skills that act have ended, home left out."""

    def __init__(self, tree):
        self._nodes, self.names = tree.nodes, []

    def on_tick(self, tick):
        for outcome in tick.outcomes:
            node = self._nodes[outcome.node]
            if node.acts and node.name != "go_home" and str(outcome.status) == "SUCCESS":
                self.names.append(node.name)

    def on_streams(self, messages):
        pass


@dataclass(frozen=True)
class Flown:
    """What a mission came to."""

    outcome: MissionOutcome
    claim: CableClaim
    reason: str


def flown(*looks, arms=None, camera=None, vision_of=ScriptedVision, timeout_s=60.0, **inputs):
    """Run the mission over scripted looks; return outcome, claim and what the arms did."""
    mission = load_mission(str(MISSION), skills=skills(), types=port_types())
    script, cell = vision_of(*looks), Cell()
    names = {policy.vision for policy in POLICIES.values() if policy.vision} | {
        *("best", "classic", "learned")
    }
    vision = SelectableVision({name: lambda: script for name in names}, "classic")
    devices = {
        "arms": arms or ArrivingArms(),
        "vision": vision,
        "camera": camera or type("Camera", (), {"capture": staticmethod(frame)})(),
        "worker": InlineWorker(),
        "rng": np.random.default_rng(0),
    }
    tree = build(mission, devices=devices, clock=cell.clock, inputs=inputs)
    acts = Acts(tree)
    result = Runner(tree, cell, tick_hz=10.0, observers=(acts,), timeout_s=timeout_s).run()
    claim = tree.outputs().get("claim")
    return Flown(result.outcome, claim, str(result.reason)), acts.names, vision


@pytest.mark.parametrize("policy", POLICY_NAMES)
def test_every_policy_undoes_a_knot_and_says_so(policy):
    result, acts, vision = flown(KNOTTED, DONE, policy=policy)
    assert result.outcome is MissionOutcome.SUCCESS
    assert acts == ["dilate_knot"]
    assert result.claim.untangled
    assert vision.selected == (POLICIES[policy].vision or "best")


def test_only_a_belief_needs_the_whole_cable_accounted_for():
    looks = (replace(DONE, explained=0.5), DONE)
    assert flown(*looks, policy="default")[1] != []
    assert flown(*looks, policy="tusk")[1] == []


@pytest.mark.parametrize("policy", POLICY_NAMES)
def test_cable_that_leaves_the_view_is_pulled_in_by_who_reveals(policy):
    looks = (replace(DONE, end=TraceEnd.EDGE, knotted=0.5), DONE)
    acts = flown(*looks, policy=policy)[1]
    assert ("pull_in" in acts) == ("expose" in POLICIES[policy].moves)


def test_cable_that_slides_back_each_time_is_worked_on_as_it_is():
    sliding = replace(KNOTTED, end=TraceEnd.EDGE)
    acts = flown(*[sliding] * 5, DONE, policy="default")[1]
    assert acts == [*["pull_in"] * 3, "dilate_knot", "pull_in"]


def test_sgtm2_ends_where_no_knot_is_in_sight_though_the_cable_leaves_the_view():
    result, acts, _ = flown(replace(DONE, end=TraceEnd.EDGE, knotted=0.0), policy="sgtm2")
    assert (result.claim.untangled, acts) == (True, [])


@pytest.mark.parametrize("policy", POLICY_NAMES)
def test_what_cannot_be_traced_is_loosened_by_who_disambiguates(policy):
    looks = (replace(KNOTTED, end=TraceEnd.RETRACE), DONE)
    acts = flown(*looks, policy=policy)[1]
    assert acts[0] == ("partial_dilation" if "loosen" in POLICIES[policy].moves else "dilate_knot")


def test_an_end_that_gives_no_start_is_freed_where_traces_need_one():
    assert flown(Look(start=False), DONE, policy="tusk")[1] == ["perturb_endpoint"]


def test_a_second_look_that_is_less_sure_leads_to_a_move_and_not_to_a_claim():
    doubting = replace(DONE, knotted=0.4)
    result, acts, _ = flown(DONE, doubting, DONE, policy="default")
    assert (result.claim.untangled, acts) == (True, ["uncover_end"])
    assert flown(DONE, doubting, DONE, policy="tusk")[1] == []


def test_a_mission_that_comes_to_no_end_says_what_it_believes():
    unclear = flown(Look(ends=0), policy="no_interactive", timeout_s=900.0)[0]
    assert "cannot tell" in unclear.reason


def test_who_goes_by_belief_traces_from_an_end_among_strands_all_the_same():
    result, acts, _ = flown(replace(DONE, start=False), policy="default")
    assert (result.claim.untangled, acts) == (True, [])


def test_without_interactive_perception_it_only_looks_again():
    result, acts, _ = flown(Look(ends=0), Look(ends=0), DONE, policy="no_interactive")
    assert (result.outcome, acts) == (MissionOutcome.SUCCESS, [])


def test_a_mission_without_cable_in_view_says_so():
    result, acts, _ = flown(Look(ends=0, pieces=False), timeout_s=900.0)
    assert result.outcome is not MissionOutcome.SUCCESS
    assert "cable.gone" in result.reason
    assert acts == []


def test_cable_over_an_arm_is_laid_down_before_anything_else():
    high = frame()
    high.depth_m[:] = 1.0
    flat = replace(high, depth_m=high.depth_m.copy())
    high.depth_m[298:303] = 0.8
    shown = iter([high])

    class SeesRows(ScriptedVision):
        def cable_pixels(self, image):
            cable = np.zeros(image.shape, dtype=bool)
            cable[298:303] = True
            return cable

    camera = type("Camera", (), {"capture": staticmethod(lambda: next(shown, flat))})()
    result, acts, _ = flown(DONE, camera=camera, vision_of=SeesRows)
    assert (result.claim.untangled, acts) == (True, ["shake_off"])


def test_the_vision_that_is_asked_for_is_that_of_policies_without_their_own():
    assert flown(DONE, vision="learned")[2].selected == "learned"
    assert flown(DONE, vision="learned", policy="sgtm2")[2].selected == "sgtm2"


def test_a_vision_that_cannot_be_had_ends_the_round_with_its_reason():
    def refuse():
        raise InputError("vision: networks need PyTorch")

    vision = SelectableVision({"classic": lambda: ScriptedVision(DONE), "tusk": refuse}, "classic")
    with pytest.raises(InputError, match="PyTorch"):
        vision.select("tusk")
    with pytest.raises(InputError, match="unknown vision 'tsk'; did you mean 'tusk'"):
        vision.select("tsk")
    assert vision.selected == "classic"


def test_hands_that_close_on_nothing_cost_rounds_and_not_the_mission():
    class Missing(ArrivingArms):
        """Arms whose first six closings take nothing."""

        def holds(self, arm):
            closings = [entry for entry in self.log if entry[0] == "grip" and entry[2] != "open"]
            return len(closings) > 6

    result, acts, _ = flown(KNOTTED, KNOTTED, KNOTTED, KNOTTED, DONE, arms=Missing())
    assert result.outcome is MissionOutcome.SUCCESS
    assert result.claim.untangled
    assert "dilate_knot" in acts


def test_a_dark_frame_costs_a_round():
    looks = iter([np.zeros((751, 1001), dtype=np.uint8)])

    class Flickering:
        """A camera whose first frame is black."""

        def capture(self):
            image = next(looks, None)
            return frame() if image is None else replace(frame(), image=image)

    result, acts, _ = flown(DONE, camera=Flickering())
    assert (result.outcome, acts) == (MissionOutcome.SUCCESS, [])
