"""Move a held piece of cable a little, to where there is room (the thesis's perturbation)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.skill import SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Points
from perception.camera import CameraFrame
from robots.interfaces import DualArm, Floats, TcpGoal
from robots.placement import TABLE_SIZE_M
from skills.cable.carrying import CarrySkill
from skills.cable.grasping import grasp_goal

# Thesis section 3.5: uniform displacement in a square of 10 cm x 10 cm.
HALF_SQUARE_M = 0.05
# Of so many random displacements the ones with the most room come first.
DRAWS = 16
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


class ShiftSkill(CarrySkill):
    """Base of skills that grasp one place of the cable and shift it into free space."""

    def __init__(
        self, arms: DualArm, worker: Worker, vision: CableVision, rng: np.random.Generator
    ) -> None:
        """Bind the arms, who plans for them, perception and the mission's random numbers."""
        super().__init__(arms, worker)
        self._vision, self._rng = vision, rng

    def shift(
        self, frame: CameraFrame, holds: Sequence[Hold], half_m: float = HALF_SQUARE_M
    ) -> SkillRun:
        """Grasp at the first hold that an arm can carry, lift, shift, lay down, rise.

        Args:
            frame: Overhead frame.
            holds: Where the cable may be taken, the best first.
            half_m: It is shifted by at most so much along either side of the table.
        """
        cable = yield from self._worker.run(self._vision.cable_pixels, frame.image)
        goals = [grasp_goal(frame, hold.point_px, hold.direction) for hold in holds]

        def ways_m(goal: TcpGoal) -> list[Floats]:
            hold = holds[goals.index(goal)]
            room = room_map(cable, hold)
            return roomiest_steps(frame, hold.leading_px, room, self._rng, half_m)

        return (yield from self.carry(goals, ways_m))


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
    frame: CameraFrame,
    leading_px: Points,
    room_px: Room,
    rng: np.random.Generator,
    half_m: float = HALF_SQUARE_M,
) -> list[Floats]:
    """Return random level displacements [m], those first that leave all of `leading_px` room."""
    steps_m = np.zeros((DRAWS, 3))
    steps_m[:, :2] = rng.uniform(-half_m, half_m, (DRAWS, 2))
    here_m = frame.camera.on_plane(leading_px)

    def least_px(places_m: Floats) -> float:
        rim_px = rim_room_px(frame, places_m)
        return min(rim_px, *(room_px(place) for place in frame.camera.project(places_m)))

    rooms_px = [least_px(here_m + step_m) for step_m in steps_m]
    order = np.argsort([-room for room in rooms_px], kind="stable")
    return [steps_m[number] for number in order[:MOST_STEPS]]


def rim_room_px(frame: CameraFrame, places_m: Floats) -> float:
    """Return how far places are from the rim of the table, in pixels; negative beyond it.

    What is laid down near the rim slides over it.
    """
    rim_m = float((0.5 * np.array(TABLE_SIZE_M) - np.abs(places_m[:, :2])).min())
    ends_px = frame.camera.project(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    return rim_m * float(np.linalg.norm(ends_px[1] - ends_px[0]))
