"""How much of the cable in view a trace accounts for."""

import numpy as np
from numpy.typing import NDArray

from perception.cable.types import Points

# Cable pixels nearer than this to the trace belong to it: half a thick cable plus its shadow.
BAND_PX = 9


def explained_share(cable: NDArray[np.bool_], path_px: Points) -> float:
    """Return the share of cable pixels that lie along a trace.

    Args:
        cable: Which pixels show cable or connector, shape (height, width).
        path_px: Centre line of the trace, shape (N, 2), at most `BAND_PX` between points.

    Returns:
        A share in [0, 1]; 1 when there is no cable at all.
    """
    near = np.zeros_like(cable)
    height, width = cable.shape
    offsets = np.arange(-BAND_PX, BAND_PX + 1)
    columns = np.rint(path_px[:, 0]).astype(int)[:, None, None] + offsets[None, :, None]
    rows = np.rint(path_px[:, 1]).astype(int)[:, None, None] + offsets[None, None, :]
    columns, rows = np.broadcast_arrays(columns, rows)
    near[rows.clip(0, height - 1), columns.clip(0, width - 1)] = True
    total = int(cable.sum())
    return float((cable & near).sum() / total) if total else 1.0
