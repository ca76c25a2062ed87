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
from perception.shelf.planning.kernels import kernel
from perception.shelf.planning.room import footprints
from perception.shelf.types import Box, Floats, Shelf, corners

TOUCH_M = 1e-6


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
        _any_shows(
            np.hstack([footprints(boxes), heights]), target, np.ascontiguousarray(rays),
            silhouette.depth_m, caster.origin_m.copy(), shelf.width_m, gap_m,
        )
    )  # fmt: skip


@kernel
def _any_shows(
    boxes: Floats,
    target: int,
    rays: Floats,
    depths: Floats,
    eye: Floats,
    width_m: float,
    gap_m: float,
) -> bool:
    count = len(boxes)
    half, middle = 0.5 * (boxes[:, 2] - boxes[:, 0]), 0.5 * (boxes[:, 0] + boxes[:, 2])
    low, high = np.minimum(half, middle), np.maximum(width_m - half, middle)
    low[target] = high[target] = middle[target]
    apart = np.full((count, count), -np.inf)
    for one in range(count):
        for other in range(count):
            deep = min(boxes[one, 3], boxes[other, 3]) - max(boxes[one, 1], boxes[other, 1])
            if deep > TOUCH_M and middle[one] < middle[other]:
                # What stands closer than the gap already may stay so.
                wide = half[one] + half[other] + gap_m
                apart[one, other] = min(wide, middle[other] - middle[one])
    begin, end = np.empty(count), np.empty(count)
    for pixel in range(len(rays)):
        for index in range(count):
            begin[index], end[index] = np.inf, -np.inf
            if index != target:
                _hidden_between(boxes[index], half[index], rays[pixel], depths[pixel], eye,
                                begin, end, index)  # fmt: skip
        if _leftmost(apart, low, high, begin, end):
            return True
    return False


@kernel
def _hidden_between(
    box: Floats,
    half: float,
    ray: Floats,
    depth: float,
    eye: Floats,
    begin: Floats,
    end: Floats,
    index: int,
) -> None:
    """Write between which places of its middle a box cuts a ray before some depth."""
    rise, across = ray[2] / ray[1], ray[0] / ray[1]
    near, far = box[1] - eye[1], min(box[3] - eye[1], depth * ray[1])
    above = box[4] - eye[2]
    if rise > 0.0:
        far = min(far, above / rise)
    elif rise < 0.0:
        near = max(near, above / rise)
    elif above < 0.0:
        return
    if near < far - TOUCH_M:
        one, other = eye[0] + across * near, eye[0] + across * far
        begin[index], end[index] = min(one, other) - half, max(one, other) + half


@kernel
def _leftmost(apart: Floats, low: Floats, high: Floats, begin: Floats, end: Floats) -> bool:
    """Say whether all find a place that is out of their interval, each as far left as it can."""
    x, changed = low.copy(), True
    while changed:
        changed = False
        for index in range(len(x)):
            least = x[index]
            for other in range(len(x)):
                least = max(least, x[other] + apart[other, index])
            if begin[index] + TOUCH_M < least < end[index] - TOUCH_M:
                least = end[index]
            if least > high[index] + TOUCH_M:
                return False
            if least > x[index] + TOUCH_M:
                x[index], changed = least, True
    return True
