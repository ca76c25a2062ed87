"""How much of the cable in view a trace accounts for."""

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.types import Coverage, Points

# Cable pixels nearer than this to the trace belong to it: half a thick cable plus its shadow.
BAND_PX = 9


def coverage_of(cable: NDArray[np.bool_], path_px: Points) -> Coverage:
    """Return what of a cable lies along a trace, and what does not.

    Args:
        cable: Which pixels show cable or connector, shape (height, width).
        path_px: Centre line of the trace, shape (N, 2), at most `BAND_PX` between points.
    """
    near = np.zeros_like(cable)
    height, width = cable.shape
    offsets = np.arange(-BAND_PX, BAND_PX + 1)
    columns = np.rint(path_px[:, 0]).astype(int)[:, None, None] + offsets[None, :, None]
    rows = np.rint(path_px[:, 1]).astype(int)[:, None, None] + offsets[None, None, :]
    columns, rows = np.broadcast_arrays(columns, rows)
    near[rows.clip(0, height - 1), columns.clip(0, width - 1)] = True
    total, left = int(cable.sum()), (cable & ~near).astype(np.uint8)
    sizes = cv2.connectedComponentsWithStats(left, connectivity=8)[2][1:, cv2.CC_STAT_AREA]
    share = 1.0 - float(left.sum()) / total if total else 1.0
    return Coverage(share, int(sizes.max(initial=0)))
