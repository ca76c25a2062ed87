"""Cable pixels and the cable's width, whichever of cable and table is the brighter."""

import numpy as np

from perception.cable.mask import CableMask, find_mask
from perception.cable.types import Points
from perception.camera import GreyImage


def mask_under(image: GreyImage, on_cable_px: Points) -> CableMask | None:
    """Return the mask that holds most of the given points; None where no cable is seen.

    Args:
        image: Grey image.
        on_cable_px: Points on the cable, shape (N, 2); they tell bright cables on dark tables
            from dark ones on bright tables.
    """
    limits = np.array([image.shape[1], image.shape[0]]) - 1
    columns, rows = np.round(on_cable_px).astype(int).clip(0, limits).T
    masks = [mask for mask in (find_mask(image), find_mask(255 - image)) if mask is not None]
    return max(
        masks,
        key=lambda mask: (float(mask.cable[rows, columns].mean()), mask.contrast),
        default=None,
    )
