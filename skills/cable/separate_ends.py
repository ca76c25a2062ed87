"""Draw both ends of the cable apart and up (the thesis's endpoint separation)."""

from collections.abc import Mapping
from typing import Annotated

import numpy as np

from executive.core.outcome import failure
from executive.core.skill import In, SkillRun
from perception.cable.types import Endpoint
from perception.camera import CameraFrame
from robots.interfaces import Arm, MotionFailure, TcpGoal
from skills.cable.carrying import motion_outcome
from skills.cable.dilate_knot import apart
from skills.cable.grasping import CLEARANCE_M, grasp_goal
from skills.cable.knot_sites import HANDS_APART_M, REACH_X_M
from skills.motion.arm_skill import MOTION_REASONS, ArmSkill, MotionSteps
from skills.motion.goals import above

# Where to hold: behind the connector, measured from the detected end into the cable.
HOLD_BEHIND_PX = 40.0
# Lifted so high, loops slide off the cable; and it is laid down from there.
LIFT_M = 0.10
# Where the whole table cannot be spanned, these parts of it are tried in turn.
SHARES_OF_TABLE = (1.0, 0.85, 0.7, 0.5)


class SeparateEnds(ArmSkill):
    """Grasp the cable behind both ends, draw them up and apart, and lay it down again.

    Gravity helps loops off, and slack comes to lie along the table.

    SUCCESS: both hands held the cable, drew it apart and laid it down.
    FAILURE: `ends.few` when not both ends are seen; `ends.close` when two hands have no room
        at them; `grasp.missed` when a hand closed on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    REASONS = MOTION_REASONS | {"ends.few", "ends.close", "grasp.missed"}

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        endpoints: Annotated[tuple[Endpoint, ...], In("ends of the cable, surest first")],
    ) -> SkillRun:
        """Take hold of both ends, lift, draw apart, lay down, rise."""
        if len(endpoints) < 2:
            return failure("ends.few", f"{len(endpoints)} of two ends are seen")
        goals = (_goal(frame, endpoints[0]), _goal(frame, endpoints[1]))
        if np.linalg.norm(goals[0].position_m - goals[1].position_m) < HANDS_APART_M:
            return failure("ends.close", "both ends lie too close for two hands")
        hovers = (above(goals[0], CLEARANCE_M), above(goals[1], CLEARANCE_M))
        hands = yield from self._worker.run(self._arms.assign, hovers)
        if isinstance(hands, MotionFailure):
            return motion_outcome(hands)
        failed = yield from self._descend(dict(zip(hands, goals, strict=True)), CLEARANCE_M)
        if failed is not None:
            return motion_outcome(failed)
        yield from self._set_grips(dict.fromkeys(hands, "pinch"))
        missed = [arm for arm in hands if not self._arms.holds(arm)]
        failed = None if missed else (yield from self._draw_apart(hands))
        risen = yield from self._release(hands, CLEARANCE_M)
        if missed:
            return failure("grasp.missed", f"closed on nothing: {', '.join(missed)}")
        return motion_outcome(failed or risen)

    def _draw_apart(self, hands: tuple[Arm, Arm]) -> MotionSteps:
        """Lift, move apart along the table as far as the arms reach, lay down."""
        up_m = np.array([0.0, 0.0, LIFT_M])
        failed = yield from self._move_by(dict.fromkeys(hands, up_m))
        if failed is not None:
            return failed
        tips_m: Mapping[Arm, np.ndarray] = {arm: self._arms.tcp_position(arm) for arm in hands}
        for share in SHARES_OF_TABLE:
            failed = yield from self._move_by(apart(tips_m, share * 2.0 * REACH_X_M))
            if failed is None:
                break
        laid = yield from self._move_by(dict.fromkeys(hands, -up_m))
        return failed or laid


def _goal(frame: CameraFrame, end: Endpoint) -> TcpGoal:
    return grasp_goal(frame, end.position_px + HOLD_BEHIND_PX * end.direction, end.direction)
