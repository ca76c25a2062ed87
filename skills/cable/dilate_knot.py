"""Loosen or undo a knot: one hand cages the cable, the other pinches it, both pull apart."""

from collections.abc import Generator, Iterable, Mapping, Sequence
from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, SkillRun
from perception.cable.grasp_sites import GraspSite
from perception.cable.types import Crossing, Knot, Trace
from perception.camera import CameraFrame
from robots.interfaces import Arm, Floats, MotionFailure, TcpGoal
from skills.cable.grasping import CLEARANCE_M, grasp_goal
from skills.cable.knot_sites import REACH_X_M, REACH_Y_M, Pair, given_pairs, searched_pairs
from skills.cable.policies import HoldAt
from skills.motion.arm_skill import MOTION_REASONS, ArmSkill, MotionSteps
from skills.motion.goals import above

# Hands for a pair of goals, or why that pair cannot be reached.
_Hands = tuple[Arm, Arm] | MotionFailure

LIFT_M = 0.03
MOST_PAIRS = 60
# Where the whole way apart is out of reach, these parts of it are tried in turn.
SHARES_OF_TRAVEL = (1.0, 0.8, 0.6, 0.4, 0.2)


class DilateKnot(ArmSkill):
    """Pull a knot open with a caging and a pinching gripper (thesis, section 3.5).

    The cable slides through the cage, so that the loop grows and the tail is drawn out of it,
    while the pinch keeps other knots in series from running together.

    SUCCESS: both hands held the cable, moved apart and laid it down.
    FAILURE: `knot.none` when there is no knot to dilate; a motion reason when no pair of
        sites suits both arms; `grasp.missed` when a hand closed on nothing.
    stop(): arms come to rest; a held cable stays held.
    """

    REASONS = MOTION_REASONS | {"knot.none", "grasp.missed"}

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        crossings: Annotated[tuple[Crossing, ...], In("crossings of the trace")],
        knots: Annotated[tuple[Knot, ...], In("knots of the trace")],
        travel_m: Annotated[float, In("how much farther apart the hands move", "m")] = 0.5,
        hold_at: Annotated[HoldAt, In("best places in reach, or the knot's")] = "searched",
    ) -> SkillRun:
        """Take hold with both hands, lift, pull apart, lay down, rise."""
        if not knots:
            return failure("knot.none", "no knot was found to dilate")
        if hold_at == "searched":
            pairs = searched_pairs(trace, crossings, knots[0], frame)
        else:
            pairs = given_pairs(trace, knots[0], frame)
        hands = yield from self._reach_down(frame, pairs[:MOST_PAIRS])
        if isinstance(hands, MotionFailure):
            return failure(hands.code, hands.text, stage=hands.stage)
        yield from self._set_grips({hands[0]: "cage", hands[1]: "pinch"})
        missed = [arm for arm in hands if not self._arms.holds(arm)]
        failed = None if missed else (yield from self._pull_apart(hands, travel_m))
        risen = yield from self._release(hands, CLEARANCE_M)
        if missed:
            return failure("grasp.missed", f"closed on nothing: {', '.join(missed)}")
        failed = failed or risen
        if failed is not None:
            return failure(failed.code, failed.text, stage=failed.stage)
        return success()

    def _reach_down(
        self, frame: CameraFrame, ranked: Sequence[Pair]
    ) -> Generator[None, None, _Hands]:
        """Put both hands around the cable at the best pair of sites that they can reach.

        Returns:
            The cage hand and the pinch hand, or why the last pair that was tried failed.
        """
        pairs = iter(ranked)
        nowhere = "no two sites around the knot are apart and in reach"
        failed = MotionFailure("motion.unreachable", "ik", nowhere)
        while True:
            found = yield from self._worker.run(self._next_in_reach, frame, pairs, failed)
            if isinstance(found, MotionFailure):
                return found
            hands, goals = found
            blocked = yield from self._descend(dict(zip(hands, goals, strict=True)), CLEARANCE_M)
            if blocked is None:
                return hands
            failed = blocked

    def _next_in_reach(
        self,
        frame: CameraFrame,
        pairs: Iterable[Pair],
        failed: MotionFailure,
    ) -> tuple[tuple[Arm, Arm], tuple[TcpGoal, TcpGoal]] | MotionFailure:
        """Return hands and goals of the next pair that both can be above; else the last failure."""
        for cage, pinch in pairs:
            goals = (_goal(frame, cage), _goal(frame, pinch))
            hands = self._arms.assign((above(goals[0], CLEARANCE_M), above(goals[1], CLEARANCE_M)))
            if not isinstance(hands, MotionFailure):
                return hands, goals
            failed = hands
        return failed

    def _pull_apart(self, hands: tuple[Arm, Arm], travel_m: float) -> MotionSteps:
        """Lift, move apart as far as asked or as far as the arms reach, lay down."""
        up_m = np.array([0.0, 0.0, LIFT_M])
        failed = yield from self._move_by(dict.fromkeys(hands, up_m))
        if failed is not None:
            return failed
        tips_m = {arm: self._arms.tcp_position(arm) for arm in hands}
        present_m = float(np.linalg.norm(tips_m["left"] - tips_m["right"]))
        for share in SHARES_OF_TRAVEL:
            span_m = min(present_m + share * travel_m, 2.0 * REACH_X_M)
            failed = yield from self._move_by(apart(tips_m, span_m))
            if failed is None:
                break
        laid = yield from self._move_by(dict.fromkeys(hands, -up_m))
        return failed or laid


def apart(tips_m: Mapping[Arm, Floats], span_m: float) -> dict[Arm, Floats]:
    """Return displacements that put the hands `span_m` apart along the table's long side.

    The long side has the reach for it; the middle between the hands moves only as far as the
    reach demands.
    """
    middle_m = (tips_m["left"] + tips_m["right"]) / 2.0
    most_m = max(0.0, REACH_X_M - span_m / 2.0)
    middle_x_m = float(np.clip(middle_m[0], -most_m, most_m))
    middle_y_m = float(np.clip(middle_m[1], REACH_Y_M[0] + 0.03, REACH_Y_M[1] - 0.03))
    ends_m = {"left": middle_x_m - span_m / 2.0, "right": middle_x_m + span_m / 2.0}
    return {
        arm: np.array([ends_m[arm], middle_y_m, tips_m[arm][2]]) - tips_m[arm] for arm in tips_m
    }


def _goal(frame: CameraFrame, site: GraspSite) -> TcpGoal:
    return grasp_goal(frame, site.point_px, site.direction)
