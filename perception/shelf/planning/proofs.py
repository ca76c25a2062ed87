"""Shelves where no pushes can show a target: a proof, by the order that pushes along a shelf keep.

An object that is pushed along the shelf cannot pass one that stands in its way. So where objects
can ever stand are solutions of x_j - x_i >= d_ij. A pixel of the hidden target shows only where
each object that would hide it stands left or right of the ray: out of an open interval. Constraints
of both kinds hold for the componentwise minimum of two solutions, too; so if there is a solution
there is a leftmost one, and raising each object no farther than it must finds it.

Everything stands on the floor and the camera is level: where a pixel shows, all above it in its
column do. So where enough of a target shows, either one column shows it down to some row, or two
columns show it at least at their tops. Where neither has a solution, nothing helps. What is not
proved here may still not be solvable.
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from perception.camera import CameraModel
from perception.shelf.casting import BoxCaster
from perception.shelf.planning.kernels import Ints
from perception.shelf.planning.looking_ahead import FIXED, Situation, kernel_inputs
from perception.shelf.planning.order_kernels import any_shows
from perception.shelf.planning.outlook import FINE, outlook
from perception.shelf.planning.room import footprints
from perception.shelf.types import Bools, Box, Shelf, corners

# By how much the sides of what is seen may lie elsewhere [m]: x low, y low, x high, y high, height.
SMALLER = np.array([0.004, 0.004, -0.004, -0.004, -0.006])
# Places that are less likely by this than the likeliest are ruled out.
LEAST_WEIGHT = 1e-4


def pushes_may_show(
    boxes: Sequence[Box],
    target: int,
    shelf: Shelf,
    camera: CameraModel,
    gap_m: float,
    *,
    share: float = 0.0,
    by_sight: bool = False,
) -> bool:
    """Say whether a target could be brought to show; False is a proof.

    Args:
        boxes: All that stands on the shelf.
        target: Which of them is not pushed.
        shelf: The shelf.
        camera: A level one that looks into it along y.
        gap_m: What stays between objects; the room of a blade is not asked for.
        share: The share of the target's pixels that has to show, one of them at least.
        by_sight: Whether an object can be pushed only once a pixel of it shows; else all can be.
    """
    proof = _Proof(boxes, target, shelf, camera, gap_m)
    movable = proof.ever_seen() if by_sight else np.ones(len(boxes), dtype=bool)
    return proof.may_show(target, movable, share)


def hopeless(situation: Situation) -> bool:
    """Say whether no pushes bring any place of a target to show; what is unseen only adds to that.

    Of shelves with stacks nothing is proved.

    Args:
        situation: What is known; objects are taken to be smaller by what they are known to.
    """
    inputs, target = kernel_inputs(situation), 0.5 * np.array(situation.target_m[:2])
    if inputs.boxes[:, 5].any():
        return False
    things = np.vstack([inputs.boxes[:, :5] + SMALLER, np.zeros((1, 5))])
    stays = np.append(situation.movable == FIXED, True)
    likely = np.argsort(-situation.weights, kind="stable")
    likely = likely[situation.weights[likely] > LEAST_WEIGHT * situation.weights.max()]
    view = outlook(situation.camera, situation.places_m[likely], situation.target_m, FINE)
    for pose, place_m in enumerate(situation.places_m[likely]):
        entries = slice(view.start[pose], view.start[pose + 1])
        rises, depths = view.top[entries], view.depth[entries]
        things[-1] = [*(place_m - target), *(place_m + target), situation.target_m[2]]
        rays = np.column_stack([view.slopes[view.column[entries]], np.ones_like(rises), rises])
        alone = np.repeat(np.arange(len(rises)), 2).reshape(-1, 2)
        if any_shows(
            things, len(things) - 1, stays, alone, rays, depths, view.eye, inputs.shelf_m[0], 0.0
        ):
            return False
    return True


class _Proof:
    """One shelf."""

    def __init__(
        self, boxes: Sequence[Box], target: int, shelf: Shelf, camera: CameraModel, gap_m: float
    ) -> None:
        self._target, self._width_m, self._gap_m = target, shelf.width_m, gap_m
        heights = np.array([[box.size_m[2]] for box in boxes])
        self._rows = np.hstack([footprints(boxes), heights])
        self._caster = BoxCaster(camera)
        self._shown = self._caster.cast(*corners(list(boxes)))
        self._rays = self._caster.rays.reshape(-1, 3)

    def ever_seen(self) -> Bools:
        """Say which objects may be seen some time; what is not cannot be pushed either."""
        seen = np.zeros(len(self._rows), dtype=bool)
        grows = True
        while grows:
            found = [
                bool(seen[index]) or (index != self._target and self.may_show(index, seen))
                for index in range(len(seen))
            ]
            grows, seen = sum(found) > seen.sum(), np.array(found)
        return seen

    def may_show(self, index: int, movable: Bools, share: float = 0.0) -> bool:
        """Say whether so much of an object may show, and one pixel at least."""
        mine = self._shown.box == index
        pixel, depth_m = self._shown.pixel[mine], self._shown.depth_m[mine]
        stays = ~movable
        stays[[index, self._target]] = True
        return bool(
            any_shows(
                self._rows, index, stays, self._pairs(pixel, max(1.0, share * len(pixel))),
                np.ascontiguousarray(self._rays[pixel]), depth_m, self._caster.origin_m.copy(),
                self._width_m, self._gap_m,
            )
        )  # fmt: skip

    def _pairs(self, pixel: Ints, least: float) -> Ints:
        """Return pairs of pixels of which one has to show for so many to, shape (Q, 2)."""
        column, row = pixel % self._caster.camera.width_px, pixel // self._caster.camera.width_px
        order = np.lexsort((row, column))
        starts = np.flatnonzero(np.diff(column[order], prepend=-1))
        deep = int(np.ceil(least)) - 1
        ends = np.append(starts[1:], len(order))
        enough = order[(starts + deep)[starts + deep < ends]]
        alone = np.column_stack([enough, enough])
        both = list(combinations(order[starts].tolist(), 2)) if deep > 0 else []
        return np.vstack([alone, np.array(both, dtype=np.int64).reshape(-1, 2)])
