"""The network's look as the other steps of perception need it: a mask, a graph, ends."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.mask import CableMask, radii
from perception.cable.observation import Observation, observation_of
from perception.cable.plug_ends import find_ends
from perception.cable.plugs import Plug, plug_of
from perception.cable.polyline import pixels_of
from perception.cable.sight.seen import Seen
from perception.cable.sight.sight import Sight
from perception.cable.types import Endpoint, Points
from perception.camera import GreyImage

Bools = NDArray[np.bool_]

# Smaller things, in squared cable widths, are neither cable nor connector.
LEAST_CABLE_WIDTHS2, LEAST_PLUG_WIDTHS2 = 4.0, 1.5
# Pieces smaller than this share of the largest are edges of robots and cloths.
LEAST_OF_LARGEST = 0.08
# Pieces thinner than this share of the cable's width are edges of something else.
LEAST_WIDTH = 0.5
# So often a dead end of the mask that the network does not see is an end (99 in drawn scenes).
DEAD_END = 0.05
# Ends nearer than this to each other are one [cable widths].
SAME_END_WIDTHS = 4.0


class SightEye:
    """Implements `Eye` with a trained network.

    Args:
        folder: A trained version of the network `sight`.
    """

    def __init__(self, folder: Path) -> None:
        self._sight = Sight(folder)
        self._observed = lru_cache(maxsize=2)(self._observe)

    def observe(self, image: GreyImage) -> Observation | None:
        """Return cable pixels and centre lines; None where no cable is seen."""
        return self._observed(image.tobytes(), image.shape)

    def endpoints(self, image: GreyImage) -> tuple[Endpoint, ...]:
        """Return the ends of cables, the surest first.

        Where the network is not sure of an end, a dead end of its mask tells of one.
        """
        seen, observation = self._sight.look(image), self.observe(image)
        if observation is None:
            return seen.endpoints
        width_px = observation.mask.width_px
        near = radii(~observation.mask.cable)
        sure = [end for end in seen.endpoints if _at(near, end.position_px) <= width_px]
        dead = find_ends(observation.mask, observation.graph)
        known = np.array([end.position_px for end in sure]).reshape(-1, 2)
        apart_px = SAME_END_WIDTHS * width_px
        more = [
            replace(end, probability=DEAD_END * end.probability)
            for end in dead
            if (np.linalg.norm(known - end.position_px, axis=1) > apart_px).all()
        ]
        return tuple(sorted([*sure, *more], key=lambda end: -end.probability))

    def _observe(self, pixels: bytes, shape: tuple[int, int]) -> Observation | None:
        image = np.frombuffer(pixels, dtype=np.uint8).reshape(shape)
        seen = self._sight.look(image)
        mask = mask_of(seen, image)
        return observation_of(mask, lambda closed: _plugs(seen, closed)) if mask else None


def _at(distances_px: NDArray[np.float32], point_px: Points) -> float:
    return float(distances_px[pixels_of(point_px[None], distances_px.shape)][0])


def mask_of(seen: Seen, image: GreyImage) -> CableMask | None:
    """Return the cable pixels of a look; None where there are none."""
    if seen.width_px is None:
        return None
    cable = _large(seen.cable_pixels, LEAST_CABLE_WIDTHS2 * seen.width_px**2)
    cable = _wide(cable, LEAST_WIDTH * seen.width_px)
    areas_px2 = cv2.connectedComponentsWithStats(cable.astype(np.uint8))[2][1:, cv2.CC_STAT_AREA]
    cable = _large(cable, LEAST_OF_LARGEST * float(areas_px2.max(initial=0)))
    if not cable.any() or cable.all():
        return None
    table = image[~cable].astype(float)
    contrast = abs(float(np.median(image[cable])) - float(np.median(table)))
    nothing = np.zeros_like(cable)
    return CableMask(cable, nothing, radii(cable), seen.width_px, contrast, float(table.std()))


def _plugs(seen: Seen, mask: CableMask) -> list[Plug]:
    bodies = _large((seen.connector > 0.5) & mask.cable, LEAST_PLUG_WIDTHS2 * mask.width_px**2)
    count, labels = cv2.connectedComponents(bodies.astype(np.uint8))
    return [plug_of(np.asarray(labels) == label) for label in range(1, count)]


def _wide(pixels: Bools, least_px: float) -> Bools:
    """Return the connected pieces of some pixels that are wide enough."""
    labels = np.asarray(cv2.connectedComponents(pixels.astype(np.uint8))[1])
    count, radius_px = int(labels.max()) + 1, radii(pixels)
    # In a strip of width w the distance to the border is w / 4 on average.
    areas_px2 = np.maximum(np.bincount(labels.ravel(), minlength=count), 1)
    mean_px = np.bincount(labels.ravel(), radius_px.ravel(), count) / areas_px2
    kept: Bools = ((4.0 * (mean_px - 0.5) >= least_px) & (np.arange(count) > 0))[labels]
    return kept


def _large(pixels: Bools, least_px2: float) -> Bools:
    """Return the connected pieces of some pixels that are large enough."""
    _, *tables = cv2.connectedComponentsWithStats(pixels.astype(np.uint8))
    labels, areas = np.asarray(tables[0]), np.asarray(tables[1])[:, cv2.CC_STAT_AREA]
    large = areas >= least_px2
    large[0] = False
    kept: Bools = large[labels]
    return kept
