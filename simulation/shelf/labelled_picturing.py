"""Pictures of a shelf whose boxes carry labels, for the cell."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from perception.camera import CameraModel
from perception.rgbd import RgbdFrame
from perception.shelf.types import Box
from simulation.shelf.labelled import LabelledShelf, Looks, draw_glare
from simulation.shelf.packages import draw_package
from simulation.shelf.picturing import SensorNoise, ShelfPicturer
from simulation.shelf.scenes import Scene
from simulation.shelf.taxonomy import Domain


class LabelledPicturer(ShelfPicturer):
    """Takes pictures of labelled packages; glare stays on its front wherever that goes."""

    def __init__(
        self, domain: Domain, scene: Scene, noise: SensorNoise, rng: np.random.Generator
    ) -> None:
        """Draw an edition of each package.

        Args:
            domain: What the products are.
            scene: What stands there at first.
            noise: What the camera adds.
            rng: Chance of editions, glare and camera.
        """
        things = {thing.name: thing for thing in domain.objects}
        self._looks = Looks(noise=noise)
        self._packages = {
            name: draw_package(things[name], box.size_m, rng)
            for name, box in zip(scene.names, scene.boxes, strict=True)
        }
        self._glares = {name: draw_glare(self._looks, rng) for name in scene.names}
        bases = {name: package.base for name, package in self._packages.items()}
        super().__init__(scene.shelf, bases, noise, rng)

    def picture(
        self, boxes: Mapping[str, Box], camera: CameraModel, stamp_s: float, viewpoint: str
    ) -> RgbdFrame:
        """Take a picture of boxes."""
        shelf = LabelledShelf(
            self._shelf,
            list(boxes.values()),
            [self._packages[name] for name in boxes],
            self._looks,
            self._rng,
            [self._glares[name] for name in boxes],
        )
        return replace(shelf.photograph(camera, viewpoint).frame, stamp_s=stamp_s)
