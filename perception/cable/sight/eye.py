"""The network's look as the other steps of perception need it: a mask, a graph, ends."""

from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.mask import CableMask, radii
from perception.cable.observation import Observation, observation_of
from perception.cable.plugs import Plug, plug_of
from perception.cable.sight.seen import Seen
from perception.cable.sight.sight import Sight
from perception.cable.types import Endpoint
from perception.camera import GreyImage

Bools = NDArray[np.bool_]

# Smaller things, in squared cable widths, are neither cable nor connector.
LEAST_CABLE_WIDTHS2, LEAST_PLUG_WIDTHS2 = 4.0, 1.5


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
        """Return the ends of cables, the surest first."""
        return self._sight.look(image).endpoints

    def _observe(self, pixels: bytes, shape: tuple[int, int]) -> Observation | None:
        image = np.frombuffer(pixels, dtype=np.uint8).reshape(shape)
        seen = self._sight.look(image)
        mask = mask_of(seen, image)
        return observation_of(mask, lambda closed: _plugs(seen, closed)) if mask else None


def mask_of(seen: Seen, image: GreyImage) -> CableMask | None:
    """Return the cable pixels of a look; None where there are none."""
    if seen.width_px is None:
        return None
    cable = _large(seen.cable_pixels, LEAST_CABLE_WIDTHS2 * seen.width_px**2)
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


def _large(pixels: Bools, least_px2: float) -> Bools:
    """Return the connected pieces of some pixels that are large enough."""
    _, *tables = cv2.connectedComponentsWithStats(pixels.astype(np.uint8))
    labels, areas = np.asarray(tables[0]), np.asarray(tables[1])[:, cv2.CC_STAT_AREA]
    large = areas >= least_px2
    large[0] = False
    kept: Bools = large[labels]
    return kept
