"""Move a held piece of cable a little, to where there is room (the thesis's perturbation)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.outcome import Outcome, failure, success
from executive.core.skill import SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Points
from perception.camera import CameraFrame
from robots.interfaces import DualArm, Floats, MotionFailure
from skills.cable.grasping import CLEARANCE_M, first_reachable, grasp_goal
from skills.motion.arm_skill import MOTION_REASONS, ArmSkill

# Thesis section 3.5: uniform displacement in a square of 10 cm x 10 cm.
HALF_SQUARE_M = 0.05
# Of so many random displacements the ones with the most room come first.
DRAWS = 16
LIFT_M = 0.03
# How many of them are tried when the arm cannot make the first.
MOST_STEPS = 6
# Cable nearer than this to the held point moves along with it; on the side that leads, only
# what is no wider than a connector does, and the rest is a strand across it.
OWN_PX = 60.0
OWN_HALF_WIDTH_PX = 12.0


@dataclass(frozen=True, slots=True, eq=False)
class Hold:
    """A place to take hold of the cable.

    Attributes:
        point_px: On the centre line, shape (2,).
        direction: Unit tangent, shape (2,).
        leading_px: What should come to lie free, e.g. along the connector, shape (N, 2).
    """

    point_px: Points
    direction: Points
    leading_px: Points


class ShiftSkill(ArmSkill):
    """Base of skills that grasp one place of the cable and shift it into free space."""

    REASONS = MOTION_REASONS | {"grasp.unreachable", "grasp.missed"}

    def __init__(
        self, arms: DualArm, worker: Worker, vision: CableVision, rng: np.random.Generator
    ) -> None:
        """Bind the arms, who plans for them, perception and the mission's random numbers."""
        super().__init__(arms, worker)
        self._vision, self._rng = vision, rng

    def shift(self, frame: CameraFrame, holds: Sequence[Hold]) -> SkillRun:
        """Grasp at the first hold that an arm reaches, lift, shift, lay down, rise."""
        goals = [grasp_goal(frame, hold.point_px, hold.direction) for hold in holds]
        found = yield from self._worker.run(first_reachable, self._arms, goals)
        if found is None:
            return failure("grasp.unreachable", "no arm reaches the cable", holds=len(holds))
        arm, goal = found
        failed = yield from self._descend({arm: goal}, CLEARANCE_M)
        if failed is not None:
            return _outcome(failed)
        yield from self._set_grips({arm: "pinch"})
        if not self._arms.holds(arm):
            yield from self._release((arm,), CLEARANCE_M)
            return failure("grasp.missed", f"the {arm} gripper closed on nothing")
        hold = holds[goals.index(goal)]
        cable = yield from self._worker.run(self._vision.cable_pixels, frame.image)
        room = room_map(cable, hold)
        lift_m = np.array([0.0, 0.0, LIFT_M])
        failed = yield from self._move_by({arm: lift_m})
        for step_m in roomiest_steps(frame, hold.leading_px, room, self._rng):
            failed = yield from self._move_by({arm: step_m})
            if failed is None:
                break
        laid = yield from self._move_by({arm: -lift_m})
        failed = failed or laid
        risen = yield from self._release((arm,), CLEARANCE_M)
        return _outcome(failed or risen)


Room = Callable[[Points], float]


def room_map(cable: NDArray[np.bool_], hold: Hold) -> Room:
    """Return the distance [px] of an image point to cable that does not move along."""
    rows, columns = np.nonzero(cable[::2, ::2])
    pixels: Points = 2.0 * np.column_stack([columns, rows]).astype(np.float64)
    resting = pixels[~_moves_along(pixels, hold)]

    def room_px(point_px: Points) -> float:
        return float(np.linalg.norm(resting - point_px, axis=1).min(initial=1e3))

    return room_px


def _moves_along(pixels: Points, hold: Hold) -> NDArray[np.bool_]:
    offsets = pixels - hold.point_px
    near: NDArray[np.bool_] = np.linalg.norm(offsets, axis=1) <= OWN_PX
    ahead = hold.leading_px[-1] - hold.point_px
    if not ahead.any():
        return near
    ahead = ahead / np.linalg.norm(ahead)
    beside = np.abs(offsets @ np.array([-ahead[1], ahead[0]])) > OWN_HALF_WIDTH_PX
    across: NDArray[np.bool_] = (offsets @ ahead > 0.0) & beside
    return near & ~across


def roomiest_steps(
    frame: CameraFrame, leading_px: Points, room_px: Room, rng: np.random.Generator
) -> list[Floats]:
    """Return random level displacements [m], those first that leave all of `leading_px` room."""
    steps_m = np.zeros((DRAWS, 3))
    steps_m[:, :2] = rng.uniform(-HALF_SQUARE_M, HALF_SQUARE_M, (DRAWS, 2))
    here_m = frame.camera.on_plane(leading_px)
    rooms_px = [
        min(room_px(place) for place in frame.camera.project(here_m + step_m)) for step_m in steps_m
    ]
    order = np.argsort([-room for room in rooms_px], kind="stable")
    return [steps_m[number] for number in order[:MOST_STEPS]]


def _outcome(failed: MotionFailure | None) -> Outcome:
    if failed is not None:
        return failure(failed.code, failed.text, stage=failed.stage)
    return success()
