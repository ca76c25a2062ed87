"""Other sizes of an image, for cables that the network finds too wide or too thin."""

from dataclasses import replace

import cv2
import numpy as np

from perception.cable.sight.seen import Seen, Shares, Tangle
from perception.cable.types import Endpoint

# Widths [px] that the network was trained on, with some room, and the one that it sees best.
THINNEST_PX, WIDEST_PX, BEST_PX = 4.0, 11.0, 8.0
# Images are not made larger than this [pixels], nor more than so many times.
LARGEST, MOST = 1_600_000, 2.0
# Where nothing is seen in an image with sides longer than this, cables may be too wide.
LONG_PX = 1400


def better_scale(scale: float, width_px: float | None, shape: tuple[int, int]) -> float | None:
    """Return how many times as large the image should be seen; None where it is seen well.

    Args:
        scale: How large it was seen.
        width_px: Width of its cables, as that look saw it, in pixels of the image.
        shape: Its height and width.
    """
    if width_px is None:
        return 0.5 * scale if scale * max(shape) > LONG_PX else None
    if THINNEST_PX <= scale * width_px <= WIDEST_PX:
        return None
    largest = min(float(np.sqrt(LARGEST / (shape[0] * shape[1]))), MOST)
    wanted = min(BEST_PX / width_px, max(largest, 1.0))
    return wanted if not 0.8 < wanted / scale < 1.25 else None


def apparent_width(seen: Seen) -> float | None:
    """Return the width of cables [px], from the mask where it looks wider than is believed.

    Far wider cables than those of the training are believed to be less wide than they are. In a
    strip the distance to the border is a quarter of the width on average.
    """
    if seen.width_px is None:
        return None
    cable = (seen.cable > 0.5).astype(np.uint8)
    inside = cv2.distanceTransform(cable, cv2.DIST_L2, 3)[cable > 0]
    return max(seen.width_px, 4.0 * (float(inside.mean()) - 0.5))


def resized(seen: Seen, shape: tuple[int, int]) -> Seen:
    """Return what was seen of an image in pixels of another size of it."""
    rows, columns = seen.cable.shape
    ratio = np.array([shape[1] / columns, shape[0] / rows])
    mean = float(np.sqrt(ratio[0] * ratio[1]))
    # Pixels have their middles at whole numbers.
    moved = (seen.crossings_px + 0.5) * ratio - 0.5
    return replace(
        seen,
        cable=_stretched(seen.cable, shape),
        connector=_stretched(seen.connector, shape),
        width_px=None if seen.width_px is None else seen.width_px * mean,
        endpoints=tuple(
            Endpoint((end.position_px + 0.5) * ratio - 0.5, end.direction, end.probability)
            for end in seen.endpoints
        ),
        crossings_px=moved,
        tangles=tuple(
            Tangle((each.centre_px + 0.5) * ratio - 0.5, each.radius_px * mean, each.probability)
            for each in seen.tangles
        ),
    )


def _stretched(shares: Shares, shape: tuple[int, int]) -> Shares:
    size = (shape[1], shape[0])
    return np.asarray(cv2.resize(shares, size, interpolation=cv2.INTER_LINEAR), np.float32)
