"""Depth and segmentation of cuboids on a shelf."""

from collections.abc import Sequence

import numpy as np

from perception.shelf.casting import BoxCaster
from perception.shelf.types import NOTHING, Box, Floats, Segments, Shelf, corners


class ShelfRenderer:
    """Renders one shelf through one camera."""

    def __init__(self, caster: BoxCaster, shelf: Shelf) -> None:
        """Render the empty shelf, which stays the same."""
        self.caster = caster
        enter, leave = caster.inside(
            np.zeros(3), np.array([shelf.width_m, shelf.depth_m, shelf.height_m])
        )
        front = -caster.origin_m[1] / caster.rays[..., 1]
        # Only what comes in through the front sees the inside.
        through = (leave > enter) & (np.abs(enter - front) < 1e-9)
        self._empty = np.where(through, leave, np.nan).ravel()

    def render(self, boxes: Sequence[Box]) -> tuple[Floats, Segments]:
        """Return depth [m] and the index of the box that each pixel shows, (height, width) each.

        Depth is NaN beside the shelf.
        """
        shape = self.caster.rays.shape[:2]
        depth_m = self._empty.copy()
        segments = np.full(depth_m.size, NOTHING, dtype=np.int16)
        seen = self.caster.cast(*corners(list(boxes)))
        # Far pixels are written first, so that near ones stay.
        order = np.argsort(-seen.depth_m, kind="stable")
        depth_m[seen.pixel[order]] = seen.depth_m[order]
        segments[seen.pixel[order]] = seen.box[order]
        return depth_m.reshape(shape), segments.reshape(shape)

    def visible_shares(self, boxes: Sequence[Box]) -> Floats:
        """Return how much of each box's silhouette is seen, in [0, 1], shape (N,)."""
        seen = self.caster.cast(*corners(list(boxes)))
        _, segments = self.render(boxes)
        whole = np.bincount(seen.box, minlength=len(boxes))
        shown = np.bincount(segments[segments != NOTHING], minlength=len(boxes))
        return shown / np.maximum(whole, 1)
