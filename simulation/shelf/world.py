"""A shelf without physics: it is looked into, objects are pushed and moved, nothing falls.

The assumptions are the thesis's (section 5.2): an action moves one object, pushes stop at
contact, and nothing topples. A push that meets the hidden target stops there like any other.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from perception.camera import CameraModel, DepthImage
from perception.shelf.casting import BoxCaster
from perception.shelf.planning.moves import Move, Place, Push
from perception.shelf.planning.room import (
    Reach,
    blade_fits,
    fits_at,
    footprints,
    push_room_m,
    way_out,
)
from perception.shelf.types import NOTHING, Box, Floats, Segments, ShelfView
from simulation.shelf.cameras import front_camera
from simulation.shelf.rendering import ShelfRenderer
from simulation.shelf.scenes import Scene

# A push that moves an object by less has moved nothing.
LEAST_SHIFT_M = 0.001


class MoveFailure(StrEnum):
    """Why an action did nothing."""

    NOT_SEEN = "shelf.not_seen"
    NO_SUCTION = "suction.no_cup"
    OBSTRUCTED = "suction.obstructed"
    NO_PLACE = "suction.no_place"
    NO_BLADE = "push.no_room_for_blade"
    NO_ROOM = "push.blocked"


@dataclass(frozen=True, slots=True)
class MoveResult:
    """What came of an action.

    Attributes:
        failure: Why nothing moved; None when something did.
        moved_m: How far the object went in a straight line.
        short_m: By how much a push stopped before it had gone as far as was asked.
    """

    failure: MoveFailure | None
    moved_m: float = 0.0
    short_m: float = 0.0


@dataclass(frozen=True, slots=True)
class DepthNoise:
    """What a depth camera adds.

    Attributes:
        spread_m: Standard deviation of depth.
        lost_share: Share of pixels without a value.
    """

    spread_m: float = 0.0
    lost_share: float = 0.0


class ShelfWorld:
    """One scene that can be looked at and changed."""

    def __init__(
        self,
        scene: Scene,
        rng: np.random.Generator,
        camera: CameraModel | None = None,
        reach: Reach | None = None,
        noise: DepthNoise | None = None,
    ) -> None:
        """Set up the scene.

        Args:
            scene: What stands there.
            rng: Chance of the camera.
            camera: What looks into the shelf; None for `front_camera`.
            reach: What the tool needs; None for the defaults.
            noise: What the camera adds to depth; None for nothing.
        """
        self.camera = camera or front_camera(scene.shelf)
        self._scene, self._rng = scene, rng
        self._reach, self._noise = reach or Reach(), noise or DepthNoise()
        self._renderer = ShelfRenderer(BoxCaster(self.camera), scene.shelf)
        self._boxes = dict(zip(scene.names, scene.boxes, strict=True))

    @property
    def boxes(self) -> Mapping[str, Box]:
        """Where everything stands now; truth, for scoring alone."""
        return self._boxes

    def look(self) -> ShelfView:
        """Take a view; detection is perfect, as in the thesis's simulations (section 7.4)."""
        depth_m, segments, labels = self._shown()
        return ShelfView(self._noisy(depth_m), segments, labels, self.camera)

    def visible_share(self, name: str) -> float:
        """Return how much of an object's silhouette is seen, in [0, 1]; truth, for scoring."""
        shares = self._renderer.visible_shares(list(self._boxes.values()))
        return float(shares[list(self._boxes).index(name)])

    def act(self, move: Move) -> MoveResult:
        """Do one action; where it fails, nothing moves."""
        if move.label not in self._shown()[2]:
            return MoveResult(MoveFailure.NOT_SEEN)
        others = footprints([box for name, box in self._boxes.items() if name != move.label])
        if isinstance(move, Push):
            return self._push(move, others)
        return self._place(move, others)

    def _shown(self) -> tuple[Floats, Segments, tuple[str, ...]]:
        """Return depth, segments and labels of what is in view."""
        names = list(self._boxes)
        depth_m, segments = self._renderer.render(list(self._boxes.values()))
        seen = np.unique(segments[segments != NOTHING])
        # Numbers of hidden objects must not show through; NOTHING, -1, finds the last entry.
        numbers = np.full(len(names) + 1, NOTHING, dtype=np.int16)
        numbers[seen] = np.arange(len(seen))
        return depth_m, numbers[segments], tuple(names[index] for index in seen)

    def _push(self, move: Push, others: Floats) -> MoveResult:
        box, shelf = self._boxes[move.label], self._scene.shelf
        moved, sign = footprints([box])[0], 1 if move.shift_m > 0.0 else -1
        if not blade_fits(moved, others, sign, shelf, self._reach):
            return MoveResult(MoveFailure.NO_BLADE)
        shift_m = min(abs(move.shift_m), push_room_m(moved, others, sign, shelf, self._reach))
        if shift_m < LEAST_SHIFT_M:
            return MoveResult(MoveFailure.NO_ROOM)
        self._boxes[move.label] = box.at(box.x_m + sign * shift_m, box.y_m)
        return MoveResult(None, shift_m, abs(move.shift_m) - shift_m)

    def _place(self, move: Place, others: Floats) -> MoveResult:
        box, shelf = self._boxes[move.label], self._scene.shelf
        if not self._reach.suction:
            return MoveResult(MoveFailure.NO_SUCTION)
        if not way_out(footprints([box])[0], others):
            return MoveResult(MoveFailure.OBSTRUCTED)
        put = box.at(move.x_m, move.y_m)
        if not fits_at(footprints([put]), others, shelf)[0]:
            return MoveResult(MoveFailure.NO_PLACE)
        self._boxes[move.label] = put
        return MoveResult(None, float(np.hypot(put.x_m - box.x_m, put.y_m - box.y_m)))

    def _noisy(self, depth_m: Floats) -> DepthImage:
        if self._noise.spread_m > 0.0:
            depth_m = depth_m + self._rng.normal(0.0, self._noise.spread_m, depth_m.shape)
        if self._noise.lost_share > 0.0:
            lost = self._rng.random(depth_m.shape) < self._noise.lost_share
            depth_m = np.where(lost, np.nan, depth_m)
        return depth_m.astype(np.float32)
