"""Shelves full of boxes, and where a target of some size may be hidden among them, exactly.

Boxes stand anywhere and have any size: nothing of what is drawn knows of products or of order.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.camera import CameraModel
from perception.models.spatial_input import window_camera
from perception.shelf.casting import BoxCaster
from perception.shelf.hidden_poses import HiddenPoses
from perception.shelf.planning.room import footprints, overlapping
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.types import NOTHING, Box, Floats, Shelf, ShelfView, Sighting, Size

# Ends of what is drawn: sizes of a shelf, where the camera is, how many boxes are tried.
WIDTH_M, DEPTH_M = (0.7, 0.9), (0.3, 0.4)
AWAY_M, HIGH_M = (0.65, 0.85), (0.15, 0.25)
TRIED = (10, 120)
# Of the sizes of boxes: each shelf has its own largest ones.
SMALLEST_M = 0.03
LARGEST_M = ((0.08, 0.26), (0.06, 0.2), (0.08, 0.3))
TARGETS = 4
# Targets that nothing can hide teach little: most of them are left out.
EMPTY = 0.15


@dataclass(frozen=True, slots=True, eq=False)
class HiddenSample:
    """One target that may be hidden in one look.

    Attributes:
        depth_m: Depth in the window, shape (ROWS, COLUMNS).
        window: From where; see `perception.models.spatial_input`.
        shelf: What is looked into.
        target_m: Size of the target.
        share: Of all poses on the floor those that it may have and that would show in a pixel if
            nothing hid them, shape (ROWS, COLUMNS).
    """

    depth_m: Floats
    window: CameraModel
    shelf: Shelf
    target_m: Size
    share: NDArray[np.float32]


def hidden_samples(rng: np.random.Generator) -> Iterator[HiddenSample]:
    """Draw a shelf, and yield a few targets for it, or none."""
    shelf = Shelf(rng.uniform(*WIDTH_M), rng.uniform(*DEPTH_M))
    window = window_camera(_camera(rng, shelf), shelf)
    largest_m = np.array([rng.uniform(*ends) for ends in LARGEST_M])
    boxes = _boxes(rng, shelf, largest_m)
    caster = BoxCaster(window)
    depth_m, segments = ShelfRenderer(caster, shelf).render(boxes)
    shown = np.unique(segments[segments != NOTHING]).tolist()
    view = ShelfView(depth_m.astype(np.float32), segments, (), window)
    nothing = np.zeros(segments.shape, dtype=bool)
    seen = [Sighting("", nothing, boxes[index], boxes[index]) for index in shown]
    for _ in range(TARGETS):
        target_m = _size(rng, largest_m)
        poses = HiddenPoses(target_m, shelf, caster)
        possible = poses.feasible(view, seen)
        if not possible.any() and rng.random() > EMPTY:
            continue
        heat = poses.heat(possible.astype(np.float64)) / poses.count
        yield HiddenSample(depth_m, window, shelf, target_m, heat.astype(np.float32))


def _camera(rng: np.random.Generator, shelf: Shelf) -> CameraModel:
    T_world_camera = np.eye(4)
    T_world_camera[:3, :3] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]
    T_world_camera[:3, 3] = [0.5 * shelf.width_m, -rng.uniform(*AWAY_M), rng.uniform(*HIGH_M)]
    return CameraModel(1, 1, 1.0, (0.0, 0.0), T_world_camera)


def _size(rng: np.random.Generator, largest_m: Floats) -> Size:
    width_m, depth_m, height_m = rng.uniform(SMALLEST_M, largest_m).tolist()
    return width_m, depth_m, height_m


def _boxes(rng: np.random.Generator, shelf: Shelf, largest_m: Floats) -> list[Box]:
    """Put down as many of some boxes as fit where they are tried."""
    boxes: list[Box] = []
    for _ in range(int(rng.integers(*TRIED))):
        size_m = _size(rng, largest_m)
        room_m = np.array([shelf.width_m, shelf.depth_m]) - size_m[:2]
        x_m, y_m = (0.5 * np.array(size_m[:2]) + rng.random(2) * room_m).tolist()
        box = Box(x_m, y_m, size_m)
        if not overlapping(footprints([box])[0], footprints(boxes)).any():
            boxes.append(box)
    return boxes
