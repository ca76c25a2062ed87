"""Connectors by what they are: compact, bright, and wider than a cable.

Two strands side by side are as wide, but a dark line runs between them: an opening with a disc
that is wider than one cable leaves connectors bright and everything else dark.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from perception.cable.mask import Bools, CableMask
from perception.cable.types import Points
from perception.camera import GreyImage

# Beyond a free end less than this share of pixels shows cable.
FREE_SHARE = 0.3


@dataclass(frozen=True, slots=True)
class PlugConfig:
    """Settings of the search for connectors; lengths in cable widths.

    Attributes:
        disc_widths: Diameter of the disc that must fit in.
        longest_widths: Bright things longer than this both ways are no connectors.
        contrast: Share of the cable's contrast at which a connector's body begins.
        peak: Share that it must reach.
        sure_widths2: From this area times peak on, in squared widths, it is no place where
            strands merge, even if cable goes on at both of its ends.
        areas_widths2: Least and greatest area of a body, in squared widths.
    """

    disc_widths: float = 1.5
    longest_widths: float = 9.0
    contrast: float = 0.6
    peak: float = 0.9
    sure_widths2: float = 12.0
    areas_widths2: tuple[float, float] = (5.0, 30.0)


@dataclass(frozen=True, slots=True, eq=False)
class Plug:
    """The body of one connector.

    Attributes:
        centre_px: Its middle, shape (2,).
        axis: Unit vector along its longer side, either way, shape (2,).
        half_length_px: From the middle to the ends of its longer side.
        body: Its pixels, shape (height, width).
    """

    centre_px: Points
    axis: Points
    half_length_px: float
    body: Bools


def find_plugs(
    image: GreyImage, mask: CableMask, config: PlugConfig | None = None
) -> tuple[Plug, ...]:
    """Return the connectors in an image, the largest first."""
    config = config or PlugConfig()
    disc = _odd(config.disc_widths * mask.width_px)
    opened = cv2.morphologyEx(
        cv2.GaussianBlur(image, (0, 0), 0.8),
        cv2.MORPH_OPEN,
        cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (disc, disc)),
    )
    square = _odd(config.longest_widths * mask.width_px)
    rise = cv2.morphologyEx(opened, cv2.MORPH_TOPHAT, np.ones((square, square), np.uint8))
    bodies = (rise > config.contrast * mask.contrast) & mask.cable
    count, *tables = cv2.connectedComponentsWithStats(bodies.astype(np.uint8))
    labels, areas = np.asarray(tables[0]), np.asarray(tables[1])[:, cv2.CC_STAT_AREA]
    smallest, greatest = (area * mask.width_px**2 for area in config.areas_widths2)
    found = [
        plug_of(labels == label)
        for label in sorted(range(1, count), key=lambda label: -areas[label])
        if smallest <= areas[label] <= greatest
    ]
    return tuple(
        plug
        for plug in found
        if _is_plug(plug, mask, float(rise[plug.body].max()) / mask.contrast, config)
    )


def _is_plug(plug: Plug, mask: CableMask, peak: float, config: PlugConfig) -> bool:
    """Say whether a body is bright enough, and large and bright or free at one end."""
    area_widths2 = int(plug.body.sum()) / mask.width_px**2
    sure: bool = peak * area_widths2 > config.sure_widths2
    return peak > config.peak and (sure or _has_free_end(plug, mask))


def _odd(size_px: float) -> int:
    return 2 * round(0.5 * (size_px - 1.0)) + 1


def plug_of(body: Bools) -> Plug:
    """Return the connector whose body shows at some pixels, shape (height, width)."""
    places = np.argwhere(body)[:, ::-1].astype(float)
    centre_px = places.mean(axis=0)
    _, axes = np.linalg.eigh(np.cov((places - centre_px).T))
    along = (places - centre_px) @ axes[:, 1]
    return Plug(centre_px, axes[:, 1], float(np.abs(along).max()), body)


def _has_free_end(plug: Plug, mask: CableMask) -> bool:
    """Say whether no cable goes on at one end of a body: where strands merge, it does at both."""
    beyond_px = plug.half_length_px + np.linspace(0.7, 1.7, 5) * mask.width_px
    aside_px = np.linspace(-0.6, 0.6, 5) * mask.width_px
    across = np.array([-plug.axis[1], plug.axis[0]])
    height, width = mask.cable.shape
    for way in (-1.0, 1.0):
        places = plug.centre_px + way * beyond_px[:, None, None] * plug.axis
        x, y = np.rint(places + aside_px[:, None] * across).astype(int).reshape(-1, 2).T
        if mask.cable[y.clip(0, height - 1), x.clip(0, width - 1)].mean() < FREE_SHARE:
            return True
    return False
