"""The scene as the ray caster sees it: capsules and boxes, each with a material.

Every body of the table cell is made of these two shapes (links of the robot, connectors, and
the cable as a chain of short capsules), so that one exact intersection a shape is all that
rendering needs.
"""

from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

CAPSULE, BOX = 0, 1
SHAPE_COLUMNS = 15  # capsule: two ends and a radius; box: axes, centre, half sizes


class Material(IntEnum):
    """What a surface is made of; `simulation.render.shading` knows how each one looks."""

    PAINT = 0
    BRAID = 1
    PLASTIC = 2
    METAL = 3


class Primitives(NamedTuple):
    """Shapes in the world frame; a named tuple, because compiled functions take those.

    Attributes:
        kind: `CAPSULE` or `BOX`, shape (N,).
        shape: Numbers of each shape [m], shape (N, 15). A capsule has its two ends and its
            radius in the first seven columns; a box its axes as the rows of a rotation from
            world to box (9), its centre (3) and its half sizes (3).
        albedo: Share of light that is reflected, shape (N,).
        material: `Material`, shape (N,).
        arc_m: Arc length along the cable at a capsule's two ends [m], shape (N, 2).
    """

    kind: Ints
    shape: Floats
    albedo: Floats
    material: Ints
    arc_m: Floats


def capsules(
    starts_m: Floats, ends_m: Floats, radii_m: Floats, albedo: float, material: Material
) -> Primitives:
    """Return capsules between starts and ends, shape (N, 3) each, with radii, shape (N,)."""
    count = len(starts_m)
    shape = np.zeros((count, SHAPE_COLUMNS))
    shape[:, :3], shape[:, 3:6], shape[:, 6] = starts_m, ends_m, radii_m
    return _uniform(CAPSULE, shape, albedo, material)


def boxes(
    T_world_box: Floats, half_sizes_m: Floats, albedo: float, material: Material
) -> Primitives:
    """Return boxes with poses, shape (N, 4, 4), and half sizes [m], shape (N, 3)."""
    count = len(T_world_box)
    shape = np.zeros((count, SHAPE_COLUMNS))
    shape[:, :9] = T_world_box[:, :3, :3].transpose(0, 2, 1).reshape(count, 9)
    shape[:, 9:12], shape[:, 12:15] = T_world_box[:, :3, 3], half_sizes_m
    return _uniform(BOX, shape, albedo, material)


def join(parts: Sequence[Primitives]) -> Primitives:
    """Return all shapes in one set, in order."""
    return Primitives(
        kind=np.concatenate([part.kind for part in parts]),
        shape=np.concatenate([part.shape for part in parts]),
        albedo=np.concatenate([part.albedo for part in parts]),
        material=np.concatenate([part.material for part in parts]),
        arc_m=np.concatenate([part.arc_m for part in parts]),
    )


def _uniform(kind: int, shape: Floats, albedo: float, material: Material) -> Primitives:
    count = len(shape)
    return Primitives(
        kind=np.full(count, kind, np.int32),
        shape=shape,
        albedo=np.full(count, albedo),
        material=np.full(count, material, np.int32),
        arc_m=np.zeros((count, 2)),
    )
