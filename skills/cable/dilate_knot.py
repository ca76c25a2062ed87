"""Loosen or undo a knot: one hand cages the cable, the other pinches it, both pull apart."""

from collections.abc import Generator, Iterable, Mapping, Sequence
from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, SkillRun
from perception.cable.grasp_sites import SIDE_ROOM_PX, GraspSite, cage_sites, pinch_sites
from perception.cable.types import Crossing, Knot, Trace
from perception.camera import CameraFrame
from robots.interfaces import Arm, Floats, MotionFailure, TcpGoal
from skills.cable.grasping import CLEARANCE_M, grasp_goal
from skills.motion.arm_skill import MOTION_REASONS, ArmSkill, MotionSteps
from skills.motion.goals import above

# Hands for a pair of goals, or why that pair cannot be reached.
_Hands = tuple[Arm, Arm] | MotionFailure

# Two grippers that point straight down touch each other when they are nearer than this.
HANDS_APART_M = 0.11
LIFT_M = 0.03
# Where hands can go on the table (measured reach of both arms, straight down).
REACH_X_M = 0.38
REACH_Y_M = (-0.20, 0.17)
MOST_PAIRS = 60
# Where the whole way apart is out of reach, these parts of it are tried in turn.
SHARES_OF_TRAVEL = (1.0, 0.8, 0.6, 0.4, 0.2)
# Only weighs arc lengths against crowding; the real length may differ.
CABLE_LENGTH_M = 3.0


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
    ) -> SkillRun:
        """Take hold with both hands, lift, pull apart, lay down, rise."""
        if not knots:
            return failure("knot.none", "no knot was found to dilate")
        hands = yield from self._reach_down(frame, trace, crossings, knots[0])
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
        self, frame: CameraFrame, trace: Trace, crossings: Sequence[Crossing], knot: Knot
    ) -> Generator[None, None, _Hands]:
        """Put both hands around the cable at the best pair of sites that they can reach.

        Returns:
            The cage hand and the pinch hand, or why the last pair that was tried failed.
        """
        cages, pinches = cage_sites(trace, crossings, knot), pinch_sites(trace, crossings, knot)
        pairs = iter(ranked_pairs(cages, pinches, knot, frame)[:MOST_PAIRS])
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
        pairs: Iterable[tuple[GraspSite, GraspSite]],
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


def ranked_pairs(
    cages: Sequence[GraspSite], pinches: Sequence[GraspSite], knot: Knot, frame: CameraFrame
) -> list[tuple[GraspSite, GraspSite]]:
    """Return pairs of sites that leave room for two hands, best first.

    A pinch beyond the knot would tighten it, so that is the last resort. What is drawn out of
    the knot is the final separation less the cable that already lies between the hands, so
    short pieces come first. A crowded site costs more than a long piece.
    """

    def cost_m(pair: tuple[GraspSite, GraspSite]) -> float:
        beyond_m = max(0.0, pair[1].arc - knot.interval[1]) * CABLE_LENGTH_M
        between_m = abs(pair[1].arc - pair[0].arc) * CABLE_LENGTH_M
        crowding = sum(max(0.0, 1.0 - site.room_px / SIDE_ROOM_PX) for site in pair)
        return 5.0 * beyond_m + 0.3 * between_m + 0.4 * crowding

    spots_m = {id(site): _spot_m(frame, site) for site in (*cages, *pinches)}
    roomy = [
        (cage, pinch)
        for cage in cages
        for pinch in pinches
        if np.linalg.norm(spots_m[id(cage)] - spots_m[id(pinch)]) >= HANDS_APART_M
        and in_reach(spots_m[id(cage)])
        and in_reach(spots_m[id(pinch)])
    ]
    return sorted(roomy, key=cost_m)


def in_reach(position_m: Floats) -> bool:
    """Return whether a point lies in the part of the table that the arms reach."""
    return bool(abs(position_m[0]) <= REACH_X_M and REACH_Y_M[0] <= position_m[1] <= REACH_Y_M[1])


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


def _spot_m(frame: CameraFrame, site: GraspSite) -> Floats:
    spot_m: Floats = frame.camera.on_plane(site.point_px)[0]
    return spot_m


def _goal(frame: CameraFrame, site: GraspSite) -> TcpGoal:
    return grasp_goal(frame, site.point_px, site.direction)
