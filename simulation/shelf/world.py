"""A shelf without physics: it is looked into, objects are pushed and moved, nothing falls."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from perception.camera import CameraModel, DepthImage
from perception.shelf.casting import BoxCaster
from perception.shelf.planning.moves import Move, Push
from perception.shelf.planning.room import Reach
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.types import NOTHING, Box, Floats, Segments, ShelfView
from simulation.shelf.cameras import front_camera
from simulation.shelf.contents import MoveFailure, MoveResult, ShelfContents
from simulation.shelf.scenes import Scene


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
        self._rng, self._noise = rng, noise or DepthNoise()
        self._renderer = ShelfRenderer(BoxCaster(self.camera), scene.shelf)
        self._contents = ShelfContents(scene, reach or Reach())

    @property
    def boxes(self) -> Mapping[str, Box]:
        """Where everything stands now; truth, for scoring alone."""
        return self._contents.boxes

    def look(self) -> ShelfView:
        """Take a view; detection is perfect, as in the thesis's simulations (section 7.4)."""
        depth_m, segments, labels = self._shown()
        return ShelfView(self._noisy(depth_m), segments, labels, self.camera)

    def visible_share(self, name: str) -> float:
        """Return how much of an object's silhouette is seen, in [0, 1]; truth, for scoring."""
        shares = self._renderer.visible_shares(list(self.boxes.values()))
        return float(shares[list(self.boxes).index(name)])

    def act(self, move: Move) -> MoveResult:
        """Do one action; where it fails, nothing moves."""
        if move.label not in self._shown()[2]:
            return MoveResult(MoveFailure.NOT_SEEN)
        if isinstance(move, Push):
            return self._contents.push(move.label, move.shift_m)
        return self._contents.place(move.label, move.x_m, move.y_m)

    def _shown(self) -> tuple[Floats, Segments, tuple[str, ...]]:
        """Return depth, segments and labels of what is in view."""
        names = list(self.boxes)
        depth_m, segments = self._renderer.render(list(self.boxes.values()))
        seen = np.unique(segments[segments != NOTHING])
        # Numbers of hidden objects must not show through; NOTHING, -1, finds the last entry.
        numbers = np.full(len(names) + 1, NOTHING, dtype=np.int16)
        numbers[seen] = np.arange(len(seen))
        return depth_m, numbers[segments], tuple(names[index] for index in seen)

    def _noisy(self, depth_m: Floats) -> DepthImage:
        if self._noise.spread_m > 0.0:
            depth_m = depth_m + self._rng.normal(0.0, self._noise.spread_m, depth_m.shape)
        if self._noise.lost_share > 0.0:
            lost = self._rng.random(depth_m.shape) < self._noise.lost_share
            depth_m = np.where(lost, np.nan, depth_m)
        return depth_m.astype(np.float32)
