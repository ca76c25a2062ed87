"""Shelves where no pushes can show a target: a proof, by the order that pushes along a shelf keep.

An object that is pushed along the shelf cannot pass one that stands in its way. So where objects
can ever stand are solutions of x_j - x_i >= d_ij. A pixel of the hidden target shows only where
each object that would hide it stands left or right of the ray: out of an open interval. Constraints
of both kinds hold for the componentwise minimum of two solutions, too; so if there is a solution
there is a leftmost one, and raising each object no farther than it must finds it. Where no pixel of
the target has one, nothing helps. All objects but the target are taken to be movable, seen or not:
what is not proved here may still not be solvable.
"""

from collections.abc import Sequence

import numpy as np

from perception.camera import CameraModel
from perception.shelf.casting import BoxCaster
from perception.shelf.planning.order_kernels import any_shows
from perception.shelf.planning.room import footprints
from perception.shelf.types import Box, Shelf, corners


def pushes_may_show(
    boxes: Sequence[Box], target: int, shelf: Shelf, camera: CameraModel, gap_m: float
) -> bool:
    """Say whether a pixel of a target could be brought to show; False is a proof.

    Args:
        boxes: All that stands on the shelf.
        target: Which of them is not pushed.
        shelf: The shelf.
        camera: A level one that looks into it along y.
        gap_m: What stays between objects; the room of a blade is not asked for.
    """
    caster = BoxCaster(camera)
    silhouette = caster.cast(*corners([boxes[target]]))
    rays = caster.rays.reshape(-1, 3)[silhouette.pixel]
    heights = np.array([[box.size_m[2]] for box in boxes])
    return bool(
        any_shows(
            np.hstack([footprints(boxes), heights]), target, np.ascontiguousarray(rays),
            silhouette.depth_m, caster.origin_m.copy(), shelf.width_m, gap_m,
        )
    )  # fmt: skip
