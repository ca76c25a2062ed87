"""Which shape each ray of a pinhole camera meets first, compiled with Numba.

A ray has unit depth along the camera's view, so that ray lengths are depths. Formulas are the
textbook ones: a capsule is a quadratic for its cylinder and one for the nearer cap, a box is
three slabs.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from simulation.render.primitives import CAPSULE, Material, Primitives

Floats = NDArray[np.float64]
Vector = tuple[float, float, float]

MISS = math.inf
NEAREST_M = 0.05  # shapes closer to the camera than this are not drawn
_PAINT = int(Material.PAINT)


class View(NamedTuple):
    """A pinhole view.

    Attributes:
        pose: T_world_camera, shape (4, 4).
        focal: Focal length [px].
        cx: Principal point, x [px].
        cy: Principal point, y [px].
    """

    pose: Floats
    focal: float
    cx: float
    cy: float


@njit(cache=True)
def dot(a: Vector, b: Vector) -> float:
    """Return the inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def minus(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(cache=True)
def along(origin: Vector, direction: Vector, length: float) -> Vector:
    """Return origin + length * direction."""
    return (
        origin[0] + length * direction[0],
        origin[1] + length * direction[1],
        origin[2] + length * direction[2],
    )


@njit(cache=True)
def unit(a: Vector) -> Vector:
    """Return the vector at length one."""
    scale = 1.0 / max(math.sqrt(dot(a, a)), 1e-12)
    return a[0] * scale, a[1] * scale, a[2] * scale


@njit(cache=True)
def triple(values: Floats, first: int) -> Vector:
    """Return three consecutive numbers of an array as a vector."""
    return values[first], values[first + 1], values[first + 2]


@njit(cache=True)
def eye(view: View) -> Vector:
    """Return where a view is taken from."""
    return view.pose[0, 3], view.pose[1, 3], view.pose[2, 3]


@njit(cache=True)
def pixel_ray(view: View, u: float, v: float) -> Vector:
    """Return the world direction, of unit depth, through the image point (u, v)."""
    pose, a, b = view.pose, (u - view.cx) / view.focal, (v - view.cy) / view.focal
    return (
        pose[0, 0] * a + pose[0, 1] * b + pose[0, 2],
        pose[1, 0] * a + pose[1, 1] * b + pose[1, 2],
        pose[2, 0] * a + pose[2, 1] * b + pose[2, 2],
    )


@njit(cache=True)
def image_point(view: View, point: Vector) -> Vector:
    """Return image point and depth (u, v, z) of a world point that lies before the camera."""
    pose = view.pose
    x, y, z = minus(point, eye(view))
    depth = pose[0, 2] * x + pose[1, 2] * y + pose[2, 2] * z
    across = pose[0, 0] * x + pose[1, 0] * y + pose[2, 0] * z
    down = pose[0, 1] * x + pose[1, 1] * y + pose[2, 1] * z
    scale = view.focal / max(depth, NEAREST_M)
    return view.cx + scale * across, view.cy + scale * down, depth


@njit(cache=True)
def _sphere_hit(centre: Vector, radius: float, origin: Vector, ray: Vector) -> float:
    offset = minus(origin, centre)
    a, b = dot(ray, ray), dot(offset, ray)
    root = b * b - a * (dot(offset, offset) - radius * radius)
    return (-b - math.sqrt(root)) / a if root >= 0.0 else MISS


@njit(cache=True)
def _capsule_hit(shape: Floats, origin: Vector, ray: Vector) -> float:
    start, end, radius = triple(shape, 0), triple(shape, 3), shape[6]
    axis, offset = minus(end, start), minus(origin, start)
    squared, slant, height = dot(axis, axis), dot(axis, ray), dot(axis, offset)
    a = squared * dot(ray, ray) - slant * slant
    b = squared * dot(offset, ray) - height * slant
    c = squared * (dot(offset, offset) - radius * radius) - height * height
    root = b * b - a * c
    if root < 0.0:
        return MISS
    if a > 0.0:
        length = (-b - math.sqrt(root)) / a
        height += length * slant
        if 0.0 < height < squared:
            return length
    return _sphere_hit(end if height > 0.0 else start, radius, origin, ray)


@njit(cache=True)
def _box_hit(shape: Floats, origin: Vector, ray: Vector) -> float:
    offset = minus(origin, triple(shape, 9))
    near, far = -MISS, MISS
    for axis in range(3):
        row = triple(shape, 3 * axis)
        start, slope, half = dot(row, offset), dot(row, ray), shape[12 + axis]
        if abs(slope) < 1e-12:
            if abs(start) > half:
                return MISS
            continue
        first, last = (-half - start) / slope, (half - start) / slope
        near, far = max(near, min(first, last)), min(far, max(first, last))
    return near if near <= far else MISS


@njit(cache=True)
def _hit(kind: int, shape: Floats, origin: Vector, ray: Vector) -> float:
    """Return the ray length to the first point of a shape, or MISS."""
    if kind == CAPSULE:
        return _capsule_hit(shape, origin, ray)
    return _box_hit(shape, origin, ray)


@njit(cache=True)
def capsule_share(shape: Floats, point: Vector) -> float:
    """Return where along a capsule's axis a point lies: 0 at its start, 1 at its end."""
    start = triple(shape, 0)
    axis = minus(triple(shape, 3), start)
    share = dot(axis, minus(point, start)) / max(dot(axis, axis), 1e-18)
    return min(max(share, 0.0), 1.0)


@njit(cache=True)
def surface_normal(kind: int, shape: Floats, point: Vector) -> Vector:
    """Return the outward unit normal of a shape at a point on its surface."""
    if kind == CAPSULE:
        start = triple(shape, 0)
        axis = minus(triple(shape, 3), start)
        return unit(minus(point, along(start, axis, capsule_share(shape, point))))
    offset = minus(point, triple(shape, 9))
    face, most, sign = 0, -MISS, 1.0
    for axis_index in range(3):
        across = dot(triple(shape, 3 * axis_index), offset)
        beyond = abs(across) - shape[12 + axis_index]
        if beyond > most:
            face, most, sign = axis_index, beyond, math.copysign(1.0, across)
    row = triple(shape, 3 * face)
    return sign * row[0], sign * row[1], sign * row[2]


@njit(cache=True)
def _box_corner(shape: Floats, corner: int) -> Vector:
    point = triple(shape, 9)
    for axis in range(3):
        step = shape[12 + axis] if (corner >> axis) & 1 else -shape[12 + axis]
        point = along(point, triple(shape, 3 * axis), step)
    return point


@njit(cache=True)
def _window(
    kind: int, shape: Floats, view: View, width: int, height: int
) -> tuple[int, int, int, int]:
    """Return first and last (excluded) column, first and last row that a shape may cover."""
    low_u, high_u, low_v, high_v = MISS, -MISS, MISS, -MISS
    for corner in range(2 if kind == CAPSULE else 8):
        world = triple(shape, 3 * corner) if kind == CAPSULE else _box_corner(shape, corner)
        reach = shape[6] if kind == CAPSULE else 0.0
        u, v, z = image_point(view, world)
        if z - reach < NEAREST_M:
            return 0, 0, 0, 0
        # The outline of a sphere is an ellipse; it lies within this circle.
        slant = math.hypot(u - view.cx, v - view.cy) / view.focal
        spread = view.focal * reach / (z - reach) * (1.0 + slant) + 1.0
        low_u, high_u = min(low_u, u - spread), max(high_u, u + spread)
        low_v, high_v = min(low_v, v - spread), max(high_v, v + spread)
    return (
        max(0, min(width, math.floor(low_u))),
        max(0, min(width, math.ceil(high_u) + 1)),
        max(0, min(height, math.floor(low_v))),
        max(0, min(height, math.ceil(high_v) + 1)),
    )


@njit(cache=True)
def cast(
    primitives: Primitives,
    view: View,
    grain: int,
    depth: NDArray[np.float32],
    owner: NDArray[np.int32],
) -> None:
    """Write the depth [m] and the index of the nearest shape of every ray.

    Args:
        primitives: What is there.
        view: From where, and how large.
        grain: Painted bodies, large and plain, are met by one ray in a block of this many
            rays in x and y.
        depth: Written, (height, width), multiples of the grain; `MISS` where nothing is.
        owner: Written, same shape; -1 where nothing is.
    """
    height, width = depth.shape
    depth[:] = MISS
    owner[:] = -1
    origin = eye(view)
    for index in range(len(primitives.kind)):
        kind, shape = primitives.kind[index], primitives.shape[index]
        block = grain if primitives.material[index] == _PAINT else 1
        middle = 0.5 * (block - 1)
        u0, u1, v0, v1 = _window(kind, shape, view, width, height)
        for v in range(v0 - v0 % block, v1, block):
            for u in range(u0 - u0 % block, u1, block):
                length = _hit(kind, shape, origin, pixel_ray(view, u + middle, v + middle))
                if length < MISS:
                    for row in range(v, v + block):
                        for column in range(u, u + block):
                            if length < depth[row, column]:
                                depth[row, column] = length
                                owner[row, column] = index
