"""How bright what a ray meets is: one lamp with shadows, ambient light, materials; Numba.

The lamp is the projector of a structured-light camera: it stands beside the lens, so that
strands that lie high throw a shadow to the far side, on the cloth and on strands below them.
Brightness is linear, 1.0 is the white of the image.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from simulation.render.primitives import Material, Primitives
from simulation.render.raycast import (
    Floats,
    Vector,
    View,
    along,
    capsule_share,
    dot,
    eye,
    image_point,
    minus,
    pixel_ray,
    surface_normal,
    triple,
    unit,
)

Image = NDArray[np.float32]

AMBIENT = 0.42  # share of the light that comes from all around
# How much nearer to the lamp something must be to throw a shadow on bodies, and on the cloth,
# whose pile hides the shadow of what lies flat on it.
_BIAS_M, _PILE_BIAS_M = 0.0015, 0.0038

_BRAID_PITCH_M = 0.0052  # along the cable, between threads of one winding direction
_BRAID_STARTS = 4  # threads of one winding direction around the cable
_BRAID_DEPTH = 0.34
_THREAD_SPREAD = 0.22  # threads differ in brightness by up to this share

# The sleeve's flanks send less light back to a lens beside the lamp than its ridge does.
_FLANK, _LIMB_EXPONENT = 0.55, 2.0

_BRAID, _METAL, _PAINT = int(Material.BRAID), int(Material.METAL), int(Material.PAINT)

_NEIGHBOURS = np.array([(7, 0), (5, 5), (0, 7), (-5, 5), (-7, 0), (-5, -5), (0, -7), (5, -5)])
_CREVICE_M = (0.0015, 0.02)  # a neighbour this much nearer to the camera takes ambient light
_CREVICE_SHARE = 0.75


class Lamp(NamedTuple):
    """A lamp that shines over the table.

    Attributes:
        seen_from: The view of its shadow map.
        shadow: Depth of what its light meets first [m], shape (height, width).
    """

    seen_from: View
    shadow: Image


class Rays(NamedTuple):
    """What the rays of a view have met.

    Attributes:
        depth: Depth [m], shape (height, width).
        owner: Index of the shape, -1 for none, same shape.
        brightness: Of what they met, same shape.
    """

    depth: Image
    owner: NDArray[np.int32]
    brightness: Image


@njit(cache=True)
def _free_share(shadow: Image, row: int, column: int, depth: float) -> float:
    """Return the share of 3 x 3 texels in which nothing is nearer to the lamp than `depth`."""
    free = 0
    for v in range(row - 1, row + 2):
        for u in range(column - 1, column + 2):
            free += shadow[v, u] > depth
    return free / 9.0


@njit(cache=True)
def _lit(point: Vector, lamp: Lamp) -> float:
    """Return the share of the lamp that reaches a point."""
    x, y, z = image_point(lamp.seen_from, point)
    height, width = lamp.shadow.shape
    column, row = math.floor(x + 0.5), math.floor(y + 0.5)
    if 1 <= column < width - 1 and 1 <= row < height - 1:
        return _free_share(lamp.shadow, row, column, z - _BIAS_M)
    return 1.0


@njit(cache=True)
def _thread(number: int) -> float:
    """Return a fixed pseudo-random number in [-1, 1] for a cell of the braid."""
    mixed = (number * 2654435761) & 0xFFFFFFFF
    mixed = ((mixed ^ (mixed >> 15)) * 2246822519) & 0xFFFFFFFF
    return ((mixed ^ (mixed >> 13)) & 0xFFFF) / 32767.5 - 1.0


@njit(cache=True)
def _braid(arc_m: float, across_rad: float) -> float:
    """Return the relative brightness of a braided sleeve at an angle from its top."""
    along_turns = arc_m / _BRAID_PITCH_M
    around_turns = _BRAID_STARTS * across_rad / (2.0 * math.pi)
    right, left = along_turns + around_turns, along_turns - around_turns
    weave = math.cos(2.0 * math.pi * right) * math.cos(2.0 * math.pi * left)
    cell = math.floor(2.0 * right) * 7919 + math.floor(2.0 * left)
    return 1.0 + _BRAID_DEPTH * weave + _THREAD_SPREAD * _thread(cell)


@njit(cache=True)
def _sleeve(shape: Floats, arc_m: Floats, point: Vector, outward: Vector) -> float:
    axis = unit(minus(triple(shape, 3), triple(shape, 0)))
    sideways = outward[0] * axis[1] - outward[1] * axis[0]
    arc = arc_m[0] + capsule_share(shape, point) * (arc_m[1] - arc_m[0])
    return _braid(arc, math.atan2(sideways, outward[2]))


@njit(cache=True)
def _openness(depth: Image, v: int, u: int) -> float:
    """Return how much ambient light reaches a ray's end past what stands right beside it."""
    height, width = depth.shape
    hidden = 0
    for index in range(len(_NEIGHBOURS)):
        row, column = v + _NEIGHBOURS[index, 1], u + _NEIGHBOURS[index, 0]
        if 0 <= row < height and 0 <= column < width:
            step = depth[v, u] - depth[row, column]
            hidden += _CREVICE_M[0] < step < _CREVICE_M[1]
    return 1.0 - _CREVICE_SHARE * hidden / len(_NEIGHBOURS)


@njit(cache=True)
def _highlight(material: int, outward: Vector, to_lamp: Vector, to_eye: Vector) -> float:
    """Return the Blinn-Phong highlight of a glossy material."""
    facing = max(dot(outward, unit(along(to_lamp, to_eye, 1.0))), 0.0)
    if material == _METAL:
        return 0.12 * facing**25.0
    return 0.35 * facing**40.0 if material == _PAINT else 0.0


@njit(cache=True)
def _brightness(
    primitives: Primitives, index: int, point: Vector, viewer: Vector, lamp: Lamp, openness: float
) -> float:
    shape, material = primitives.shape[index], primitives.material[index]
    outward = surface_normal(primitives.kind[index], shape, point)
    to_lamp, to_eye = unit(minus(eye(lamp.seen_from), point)), unit(minus(viewer, point))
    albedo = primitives.albedo[index]
    if material == _BRAID:
        albedo *= _sleeve(shape, primitives.arc_m[index], point, outward)
        facing = max(dot(outward, to_eye), 0.0)
        albedo *= _FLANK + (1.0 - _FLANK) * facing**_LIMB_EXPONENT
    share = _lit(along(point, outward, 0.0005), lamp)
    sky = 0.5 + 0.5 * max(outward[2], 0.0)
    diffuse = (1.0 - AMBIENT) * max(dot(outward, to_lamp), 0.0) * share
    value = albedo * (AMBIENT * sky * openness + diffuse)
    return value + share * _highlight(material, outward, to_lamp, to_eye)


@njit(cache=True)
def _ray_brightness(
    primitives: Primitives, view: View, lamp: Lamp, rays: Rays, v: int, u: int
) -> float:
    viewer = eye(view)
    point = along(viewer, pixel_ray(view, u, v), rays.depth[v, u])
    openness = _openness(rays.depth, v, u)
    return _brightness(primitives, rays.owner[v, u], point, viewer, lamp, openness)


@njit(cache=True)
def shade(primitives: Primitives, view: View, lamp: Lamp, grain: int, rays: Rays) -> None:
    """Write the brightness of every ray that met a shape.

    Args:
        primitives: What is there.
        view: From where it is seen.
        lamp: What lights it.
        grain: As in `raycast.cast`; a block of rays that met the same painted body shares one
            brightness.
        rays: From `raycast.cast`; brightness is written.
    """
    owner, brightness = rays.owner, rays.brightness
    height, width = owner.shape
    for v in range(0, height, grain):
        for u in range(0, width, grain):
            first, shared = owner[v, u], np.float32(math.nan)
            if first >= 0 and primitives.material[first] == _PAINT:
                shared = _ray_brightness(primitives, view, lamp, rays, v, u)
            for row in range(v, v + grain):
                for column in range(u, u + grain):
                    index = owner[row, column]
                    if index >= 0 and index == first and not math.isnan(shared):
                        brightness[row, column] = shared
                    elif index >= 0:
                        brightness[row, column] = _ray_brightness(
                            primitives, view, lamp, rays, row, column
                        )


class PlaneShadow(NamedTuple):
    """Where the shadow map of a lamp tells about the plane z = 0, for each pixel of a view.

    Attributes:
        row: Row in the shadow map, shape (height, width); -1 where the plane is not seen.
        column: Column in the shadow map, same shape.
        depth: Depth of the plane from the lamp [m], same shape.
    """

    row: NDArray[np.int32]
    column: NDArray[np.int32]
    depth: Image


@njit(cache=True)
def plane_shadow(on_plane: NDArray[np.bool_], view: View, lamp: Lamp) -> PlaneShadow:
    """Return where to look for shadows; camera and lamp stand still, so once is enough."""
    viewer = eye(view)
    height, width = on_plane.shape
    rows, columns = np.full((height, width), -1, np.int32), np.zeros((height, width), np.int32)
    depth = np.zeros((height, width), np.float32)
    shadow_height, shadow_width = lamp.shadow.shape
    for v in range(height):
        for u in range(width):
            ray = pixel_ray(view, u, v)
            point = along(viewer, ray, -viewer[2] / ray[2])
            x, y, z = image_point(lamp.seen_from, point)
            row, column = math.floor(y + 0.5), math.floor(x + 0.5)
            inside = 1 <= column < shadow_width - 1 and 1 <= row < shadow_height - 1
            if on_plane[v, u] and inside:
                rows[v, u], columns[v, u], depth[v, u] = row, column, z
    return PlaneShadow(rows, columns, depth)


@njit(cache=True)
def plane_light(where: PlaneShadow, shadow: Image) -> Image:
    """Return the share of the lamp that reaches the plane z = 0, 1 where it is not seen.

    Args:
        where: From `plane_shadow`.
        shadow: Depth of what the lamp's light meets first [m].
    """
    height, width = where.row.shape
    light = np.ones((height, width), np.float32)
    for v in range(height):
        for u in range(width):
            row = where.row[v, u]
            if row >= 0:
                depth = where.depth[v, u] - _PILE_BIAS_M
                light[v, u] = _free_share(shadow, row, where.column[v, u], depth)
    return light
