"""Which pixels show cable: bright, thin things on a darker cloth.

Nothing here is an absolute grey value. The cloth is estimated by an opening that no cable
survives; what rises above it is measured against the image's own noise and the cable's own
contrast. Wide bright things (arms, hands, furniture) survive the opening and are clutter.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.camera import GreyImage

Bools = NDArray[np.bool_]
Floats32 = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class MaskConfig:
    """Settings of the cable mask.

    Attributes:
        smoothing_px: Standard deviation of the noise filter.
        widest_px: Things wider than this are clutter.
        noise_factor: How many standard deviations of noise the cable must rise above.
        low_contrast: Share of the cable's contrast at which its border lies.
        high_contrast: Share that each piece must reach somewhere.
        clutter_contrast: Share of the cable's contrast at which wide things are clutter.
        clutter_margin_px: Clutter is widened by this.
        shortest_widths: Pieces shorter than this many cable widths are dropped.
        shortest_uneven_widths: The same for pieces that are not equally wide everywhere.
        uneven_ratio: Such pieces reach this radius somewhere, as a share of their width.
        widest_ratio: Pieces wider than this multiple of the cable are dropped.
        hole_widths2: Holes smaller than this many squared cable widths are filled.
    """

    smoothing_px: float = 0.8
    widest_px: int = 44
    noise_factor: float = 6.0
    low_contrast: float = 0.32
    high_contrast: float = 0.55
    clutter_contrast: float = 0.4
    clutter_margin_px: int = 14
    shortest_widths: float = 12.0
    shortest_uneven_widths: float = 22.0
    uneven_ratio: float = 0.8
    widest_ratio: float = 1.7
    hole_widths2: float = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class CableMask:
    """Cable pixels of one image.

    Attributes:
        cable: Whether a pixel shows cable or connector, shape (height, width).
        clutter: Whether it shows something else that may hide cable, same shape.
        radius_px: Distance of each cable pixel to the nearest other pixel, same shape.
        width_px: Width of the cable.
        contrast: How much brighter than the cloth the cable is.
        noise: Standard deviation of the smoothed cloth.
    """

    cable: Bools
    clutter: Bools
    radius_px: Floats32
    width_px: float
    contrast: float
    noise: float


def find_mask(image: GreyImage, config: MaskConfig | None = None) -> CableMask | None:
    """Return the cable mask of a grey image; None where nothing rises above the noise."""
    config = config or MaskConfig()
    smooth = _floats(cv2.GaussianBlur(image.astype(np.float32), (0, 0), config.smoothing_px))
    background = _background(smooth, config.widest_px)
    rise = smooth - background
    noise = _noise(rise)
    contrast = _contrast(rise, config.noise_factor * noise)
    if contrast is None:
        return None
    clutter = _clutter(background, contrast, config)
    low = max(config.noise_factor * noise, config.low_contrast * contrast)
    high = max(config.noise_factor * noise, config.high_contrast * contrast)
    cable = _hysteresis(rise, low, high) & ~clutter
    radius_px = radii(cable)
    return _keep_cable(CableMask(cable, clutter, radius_px, 0.0, contrast, noise), config)


def _background(smooth: Floats32, widest_px: int) -> Floats32:
    """Open at a quarter of the size, where a large disc is cheap."""
    small = cv2.resize(smooth, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    diameter = widest_px // 4
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (diameter, diameter))
    opened = cv2.morphologyEx(small, cv2.MORPH_OPEN, disc, borderType=cv2.BORDER_REPLICATE)
    height, width = smooth.shape
    return _floats(cv2.resize(opened, (width, height), interpolation=cv2.INTER_LINEAR))


def _floats(array: cv2.typing.MatLike) -> Floats32:
    return np.asarray(array, dtype=np.float32)


def _noise(rise: Floats32) -> float:
    """Return the standard deviation of the cloth from the spread of the middle half."""
    low, high = np.percentile(rise[::4, ::4], [25, 75])
    return max(float(high - low) / 1.349, 0.5)


def _contrast(rise: Floats32, floor: float) -> float | None:
    """Return a typical rise of the cable's own pixels; None where nothing rises."""
    risen = rise[rise > floor]
    if len(risen) < 0.0002 * rise.size:
        return None
    # Half of what rises above the noise is blurred border; the upper half is cable.
    return float(np.median(risen[risen > np.median(risen)]))


def _clutter(background: Floats32, contrast: float, config: MaskConfig) -> Bools:
    table = float(np.median(background))
    wide = (background > table + config.clutter_contrast * contrast).astype(np.uint8)
    size = 2 * config.clutter_margin_px + 1
    grown = cv2.dilate(wide, np.ones((size, size), np.uint8))
    clutter: Bools = grown.astype(bool)
    return clutter


def _hysteresis(rise: Floats32, low: float, high: float) -> Bools:
    """Return pieces above `low` that reach `high` somewhere."""
    count, labels = cv2.connectedComponents((rise > low).astype(np.uint8))
    reached = np.zeros(count, dtype=bool)
    reached[labels[rise > high]] = True
    reached[0] = False
    pieces: Bools = reached[labels]
    return pieces


def radii(cable: Bools) -> Floats32:
    """Return the distance of each cable pixel to the nearest pixel that is none."""
    return _floats(cv2.distanceTransform(cable.astype(np.uint8), cv2.DIST_L2, 3))


def _keep_cable(found: CableMask, config: MaskConfig) -> CableMask | None:
    """Drop pieces that are too short or not as wide as the cable."""
    count, *tables = cv2.connectedComponentsWithStats(found.cable.astype(np.uint8))
    if count < 2:
        return None
    labels, stats = (np.asarray(table, dtype=np.int32) for table in tables[:2])
    pieces = [_radii_of(found.radius_px, labels, stats[k], k) for k in range(1, count)]
    widths = np.array([_piece_width(radii_px) for radii_px in pieces])
    lengths = np.array([len(radii_px) for radii_px in pieces]) / widths
    width_px = float(widths[np.argmax(lengths)])
    uneven = np.array([radii_px.max() for radii_px in pieces]) > config.uneven_ratio * widths
    shortest = np.where(uneven, config.shortest_uneven_widths, config.shortest_widths) * width_px
    keep = (lengths > shortest) & (widths < config.widest_ratio * width_px)
    cable = np.concatenate([[False], keep])[labels]
    if not cable.any():
        return None
    cable = _fill_holes(cable, config.hole_widths2 * width_px**2)
    return replace(found, cable=cable, radius_px=radii(cable), width_px=width_px)


def _fill_holes(cable: Bools, largest_px2: float) -> Bools:
    """Fill dark spots within connectors, which are no loops of cable."""
    _, *tables = cv2.connectedComponentsWithStats((~cable).astype(np.uint8), connectivity=4)
    labels, stats = (np.asarray(table, dtype=np.int32) for table in tables[:2])
    small = stats[:, cv2.CC_STAT_AREA] < largest_px2
    small[0] = False
    filled: Bools = cable | small[labels]
    return filled


def _radii_of(
    radius_px: Floats32, labels: NDArray[np.int32], stats: NDArray[np.int32], label: int
) -> Floats32:
    """Return the distances to the border of one piece's pixels."""
    x, y, width, height = stats[:4]
    window = (slice(y, y + height), slice(x, x + width))
    return radius_px[window][labels[window] == label]


def _piece_width(radii_px: Floats32) -> float:
    """Return the width of one piece.

    In a strip of width w the distance to the border is w / 4 on average, and half a pixel
    more between centres of pixels. Connectors and crossings, the widest few, are left out.
    """
    usual = radii_px[radii_px <= np.percentile(radii_px, 97)]
    return max(4.0 * (float(usual.mean()) - 0.5), 1.0)
