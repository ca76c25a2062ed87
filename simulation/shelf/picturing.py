"""Colour and depth of a shelf from any camera: boxes in plain colours, with a sensor's noise."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from perception.camera import CameraModel
from perception.rgbd import RgbdFrame
from perception.shelf.casting import BoxCaster
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.types import NOTHING, Box, Floats, Segments, Shelf

# Light on the fronts, tops and sides of boxes.
FRONT, TOP, SIDE = 1.0, 0.92, 0.78
WALLS = np.array([70.0, 72.0, 75.0])
FACE_M = 1e-4


@dataclass(frozen=True, slots=True)
class SensorNoise:
    """What a camera adds.

    Attributes:
        depth_m: Standard deviation of depth.
        lost_share: Share of pixels without depth.
        colour: Standard deviation of each colour, in grey values.
    """

    depth_m: float = 0.0015
    lost_share: float = 0.01
    colour: float = 5.0


class ShelfPicturer:
    """Takes pictures of one shelf; products have their colours all round."""

    def __init__(
        self,
        shelf: Shelf,
        colours: Mapping[str, tuple[int, int, int]],
        noise: SensorNoise,
        rng: np.random.Generator,
    ) -> None:
        """Prepare.

        Args:
            shelf: The shelf.
            colours: Colours by name.
            noise: What the camera adds.
            rng: Chance of the camera.
        """
        self._shelf, self._colours, self._noise, self._rng = shelf, colours, noise, rng
        self._renderers: dict[bytes, ShelfRenderer] = {}

    @property
    def noise_state(self) -> Mapping[str, object]:
        """State of the camera's chance."""
        return self._rng.bit_generator.state

    def take_noise_state(self, state: Mapping[str, object]) -> None:
        """Go on with a state of the camera's chance."""
        self._rng.bit_generator.state = state

    def picture(
        self, boxes: Mapping[str, Box], camera: CameraModel, stamp_s: float, viewpoint: str
    ) -> RgbdFrame:
        """Take a picture of boxes."""
        depth_m, segments = self.truth(boxes, camera)
        colour = self._painted(list(boxes), list(boxes.values()), camera, depth_m, segments)
        colour = colour + self._rng.normal(0.0, self._noise.colour, colour.shape)
        depth_m = depth_m + self._rng.normal(0.0, self._noise.depth_m, depth_m.shape)
        lost = self._rng.random(depth_m.shape) < self._noise.lost_share
        measured = np.where(lost, np.nan, depth_m).astype(np.float32)
        painted = np.clip(np.round(colour), 0, 255).astype(np.uint8)
        return RgbdFrame(painted, measured, stamp_s, camera, viewpoint)

    def truth(self, boxes: Mapping[str, Box], camera: CameraModel) -> tuple[Floats, Segments]:
        """Return depth [m] without noise and which box each pixel shows."""
        return self._renderer(camera).render(list(boxes.values()))

    def visible_share(self, boxes: Mapping[str, Box], name: str, camera: CameraModel) -> float:
        """Return how much of a box's silhouette is seen, in [0, 1]; truth, for scoring alone."""
        shares = self._renderer(camera).visible_shares(list(boxes.values()))
        return float(shares[list(boxes).index(name)])

    def _painted(
        self,
        names: list[str],
        boxes: list[Box],
        camera: CameraModel,
        depth_m: Floats,
        segments: Segments,
    ) -> Floats:
        """Return colours without noise, shape (height, width, 3)."""
        caster = self._renderer(camera).caster
        points_m = caster.origin_m + np.nan_to_num(depth_m)[..., None] * caster.rays
        paint = np.array([*(self._colours[name] for name in names), WALLS], dtype=np.float64)
        fronts = np.array([*(box.low_m[1] for box in boxes), np.inf])
        tops = np.array([*(box.high_m[2] for box in boxes), np.inf])
        light = np.full(segments.shape, SIDE)
        light[points_m[..., 2] > tops[segments] - FACE_M] = TOP
        light[np.abs(points_m[..., 1] - fronts[segments]) < FACE_M] = FRONT
        # Walls get darker towards the back.
        inside = np.clip(1.0 - points_m[..., 1] / (2.0 * self._shelf.depth_m), 0.2, 1.0)
        light = np.where(segments == NOTHING, inside, light)
        painted: Floats = paint[segments] * light[..., None]
        return painted

    def _renderer(self, camera: CameraModel) -> ShelfRenderer:
        key = camera.T_world_camera.tobytes()
        if key not in self._renderers:
            self._renderers[key] = ShelfRenderer(BoxCaster(camera), self._shelf)
        return self._renderers[key]
