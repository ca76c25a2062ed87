"""What a camera before the shelf sees: boards, boxes in any pose, and its own tool."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.camera import CameraModel
from perception.shelf.types import NOTHING, Floats, Segments
from robots.descriptions.kinova import (
    BLADE_HEIGHT_M,
    BLADE_LENGTH_M,
    BLADE_THICKNESS_M,
    CUP_AHEAD_M,
    CUP_RADIUS_M,
    CUPS_M,
    SUCTION_FRAME,
)
from simulation.poses import pose_matrices
from simulation.render.primitives import Material, Primitives, boxes, capsules, join
from simulation.render.raycast import MISS, View, cast
from simulation.shelf_cell.physics import ShelfPhysics

# Nearer to the hand the blade is below every image.
_BLADE_SEEN_FROM_M = 0.08


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What the rays of an image meet first.

    Attributes:
        depth_m: Distance along the view, shape (height, width); NaN where nothing is met.
        box: Which box, or `NOTHING`, same shape.
        tool: Where the tool is in the way, same shape.
        facing: Cosine between the met face and the way back along the ray, same shape; 0 where
            nothing is met.
    """

    depth_m: Floats
    box: Segments
    tool: NDArray[np.bool_]
    facing: Floats


def see(physics: ShelfPhysics, camera: CameraModel) -> Seen:
    """Return what a camera meets."""
    still = _boards(physics)
    things = _boxes(physics)
    scene = join([still, things, _tool(physics)])
    depth_m, owner = _cast(scene, camera)
    first, count = len(still.kind), len(things.kind)
    is_box = (owner >= first) & (owner < first + count)
    return Seen(
        depth_m=np.where(owner >= 0, depth_m, np.nan),
        box=np.where(is_box, owner - first, NOTHING).astype(np.int16),
        tool=owner >= first + count,
        facing=_facing(scene, camera, depth_m, owner),
    )


def visible_shares(physics: ShelfPhysics, camera: CameraModel) -> Floats:
    """Return how much of each box's silhouette a camera sees past the others, shape (N,)."""
    count = len(physics.box_names)
    shown = see(physics, camera).box
    counts = np.bincount(shown[shown != NOTHING], minlength=count)
    alone = [_boxes(physics, slice(index, index + 1)) for index in range(count)]
    whole = [int((_cast(box, camera)[1] >= 0).sum()) for box in alone]
    shares: Floats = counts / np.maximum(whole, 1)
    return shares


def _boards(physics: ShelfPhysics) -> Primitives:
    T_world = np.tile(np.eye(4), (len(physics.boards), 1, 1))
    T_world[:, :3, 3] = [board.centre_m for board in physics.boards]
    sizes_m = np.array([board.size_m for board in physics.boards])
    return boxes(T_world, 0.5 * sizes_m, 0.6, Material.PLASTIC)


def _boxes(physics: ShelfPhysics, which: slice = slice(None)) -> Primitives:
    poses = physics.box_poses()[which]
    T_world = pose_matrices(poses[:, :3], poses[:, 3:])
    return boxes(T_world, 0.5 * physics.box_sizes_m[which], 0.6, Material.PLASTIC)


def _tool(physics: ShelfPhysics) -> Primitives:
    tip = physics.link_pose(SUCTION_FRAME)
    T_world_tip = pose_matrices(tip[None, :3], tip[None, 3:])[0]
    length_m = BLADE_LENGTH_M - _BLADE_SEEN_FROM_M
    T_tip_blade = np.eye(4)
    T_tip_blade[2, 3] = -CUP_AHEAD_M - 0.5 * length_m
    half_m = 0.5 * np.array([[BLADE_THICKNESS_M, BLADE_HEIGHT_M, length_m]])
    blade = boxes((T_world_tip @ T_tip_blade)[None], half_m, 0.5, Material.PLASTIC)
    lips = np.zeros((len(CUPS_M), 3))
    lips[:, 1] = CUPS_M
    ends = (lips - np.array([0.0, 0.0, back_m]) for back_m in (0.03, CUP_RADIUS_M))
    starts_m, ends_m = (end @ T_world_tip[:3, :3].T + T_world_tip[:3, 3] for end in ends)
    cups = capsules(starts_m, ends_m, np.full(len(lips), CUP_RADIUS_M), 0.3, Material.PLASTIC)
    return join([blade, cups])


def _cast(scene: Primitives, camera: CameraModel) -> tuple[Floats, NDArray[np.int32]]:
    shape = (camera.height_px, camera.width_px)
    depth_m, owner = np.empty(shape, np.float32), np.empty(shape, np.int32)
    view = View(np.ascontiguousarray(camera.T_world_camera), camera.focal_px, *camera.centre_px)
    cast(scene, view, 1, depth_m, owner)
    return np.where(depth_m < MISS, depth_m, np.nan).astype(np.float64), owner


def _facing(
    scene: Primitives, camera: CameraModel, depth_m: Floats, owner: NDArray[np.int32]
) -> Floats:
    """Return how squarely rays meet the faces of cuboids, shape (height, width)."""
    rows, columns = np.nonzero(owner >= 0)
    offsets = (np.column_stack([columns, rows]) - camera.centre_px) / camera.focal_px
    rays = np.column_stack([offsets, np.ones(len(rows))]) @ camera.T_world_camera[:3, :3].T
    shapes = scene.shape[owner[rows, columns]]
    points_m = camera.T_world_camera[:3, 3] + depth_m[rows, columns, None] * rays
    axes = shapes[:, :9].reshape(-1, 3, 3)
    local_m = np.einsum("kij,kj->ki", axes, points_m - shapes[:, 9:12])
    face = np.argmax(np.abs(local_m) - shapes[:, 12:15], axis=1)
    along = np.einsum("kj,kj->k", axes[np.arange(len(face)), face], rays)
    facing = np.zeros(owner.shape)
    facing[rows, columns] = np.abs(along) / np.linalg.norm(rays, axis=1)
    return facing
