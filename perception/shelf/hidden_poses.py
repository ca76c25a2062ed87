"""Spatial occupancy, exactly: all poses of a target of known size that nothing seen speaks against.

LAX-RAY (Huang et al. 2020, arXiv 2011.11696) teaches a network this distribution, made by
Minkowski sums; here it is computed from the depth image. Poses are cells of a grid on the floor.
A cell is given up only when every pose in it is ruled out: what is tested is the core, the part of
the target that all poses of the cell have in common.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.shelf.casting import BoxCaster, Silhouettes
from perception.shelf.planning.room import overlapping
from perception.shelf.types import Bools, Box, Floats, Shelf, ShelfView, Sighting, Size


@dataclass(frozen=True, slots=True)
class PoseRules:
    """How finely and how boldly poses are ruled out.

    Attributes:
        cell_m: Size of a cell (x, y).
        margin_m: A pose would be seen where depth is larger than its own by more.
        visible_share: A target counts as seen when this share of its pixels is.
        touch_m: Seen boxes are taken to be smaller by this on each side.
    """

    cell_m: tuple[float, float] = (0.01, 0.0125)
    margin_m: float = 0.006
    visible_share: float = 0.01
    touch_m: float = 0.004


class HiddenPoses:
    """The poses of one target in one shelf, before one camera."""

    def __init__(
        self, target_m: Size, shelf: Shelf, caster: BoxCaster, rules: PoseRules | None = None
    ) -> None:
        """Cast the core of every cell once.

        Args:
            target_m: Size of the target.
            shelf: Where it stands.
            caster: Rays of the camera, which stays where it is.
            rules: How poses are ruled out; None for the defaults.
        """
        self.rules = rules or PoseRules()
        self.caster, self._shape = caster, caster.rays.shape[:2]
        self.x_m = _centres(shelf.width_m, target_m[0], self.rules.cell_m[0])
        self.y_m = _centres(shelf.depth_m, target_m[1], self.rules.cell_m[1])
        x_m, y_m = np.meshgrid(self.x_m, self.y_m, indexing="ij")
        self.places_m = np.column_stack([x_m.ravel(), y_m.ravel()])
        half = 0.5 * np.array(target_m[:2])
        core = np.maximum(half - 0.5 * np.array(self.rules.cell_m), 0.2 * half)
        low = np.column_stack([self.places_m - core, np.zeros(len(self.places_m))])
        high = np.column_stack([self.places_m + core, np.full(len(low), target_m[2])])
        self._cores = np.column_stack([low[:, :2], high[:, :2]])
        self.silhouettes: Silhouettes = caster.cast(low, high)
        ones = np.ones(len(self.silhouettes.pixel))
        self._pixels = self.silhouettes.sums(ones)

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.places_m)

    def feasible(self, view: ShelfView, seen: Sequence[Sighting]) -> Bools:
        """Say in which cells the target may be, as far as one view tells, shape (count,)."""
        return self._unseen(view) & ~self._taken(seen)

    def overlaps(self, box: Box) -> Bools:
        """Say in which cells no target can stand where a box stands, shape (count,)."""
        shrink = self.rules.touch_m * np.array([1.0, 1.0, -1.0, -1.0])
        return overlapping(np.array([*box.low_m[:2], *box.high_m[:2]]) + shrink, self._cores)

    def heat(self, weights: Floats) -> Floats:
        """Return for each pixel how much weight would show there if nothing hid it.

        This is the occupancy distribution of LAX-RAY, not normalised.

        Args:
            weights: One for each cell, shape (count,).

        Returns:
            Shape (height, width).
        """
        shown = self.silhouettes
        heat: Floats = np.bincount(
            shown.pixel,
            weights=np.asarray(weights, dtype=np.float64)[shown.box],
            minlength=self._shape[0] * self._shape[1],
        ).astype(float)
        return heat.reshape(self._shape)

    def _unseen(self, view: ShelfView) -> Bools:
        depth_m = view.depth_m.ravel()[self.silhouettes.pixel]
        # Where depth is unknown nothing is ruled out: a comparison with NaN is false.
        would_show = depth_m > self.silhouettes.depth_m + self.rules.margin_m
        shown = self.silhouettes.sums(would_show.astype(np.float64))
        limit = np.maximum(1.0, self.rules.visible_share * self._pixels)
        return np.asarray(shown <= limit)

    def _taken(self, seen: Sequence[Sighting]) -> Bools:
        taken = np.zeros(self.count, dtype=bool)
        for sighting in seen:
            taken |= self.overlaps(sighting.sure)
        return taken


class PoseBelief:
    """Which poses are left after all views so far.

    The target stands still while it is not seen, so what one view rules out stays ruled out: the
    permanent form of the running minimum, on poses and not on pixels.
    """

    def __init__(self, poses: HiddenPoses) -> None:
        """Begin with every pose."""
        self.poses = poses
        self.left: Bools = np.ones(poses.count, dtype=bool)

    def update(self, view: ShelfView, seen: Sequence[Sighting]) -> None:
        """Rule out what a view speaks against; a view that leaves nothing is not believed."""
        left = self.left & self.poses.feasible(view, seen)
        if left.any():
            self.left = left

    def heat(self, weights: Floats | None = None) -> Floats:
        """Return the occupancy of the poses left, shape (height, width); see `HiddenPoses.heat`."""
        left = self.left.astype(np.float64)
        return self.poses.heat(left if weights is None else left * weights)


def _centres(room_m: float, size_m: float, cell_m: float) -> Floats:
    """Return centres of cells that cover all a target's centre can be, shape (n,)."""
    span_m = max(room_m - size_m, 0.0)
    count = max(1, int(np.ceil(span_m / cell_m)))
    return 0.5 * size_m + span_m * (np.arange(count) + 0.5) / count
