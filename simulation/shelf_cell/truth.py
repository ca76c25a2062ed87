"""What has really become of a shelf; for the report of a run alone."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from perception.shelf.types import Floats
from simulation.poses import pose_matrices
from simulation.shelf.scenes import Scene

# A box that leans by more lies on another face, or against something.
TOPPLED_RAD = 0.5
# A middle below the floor is that of a box that fell out of the shelf.
_FALLEN_M = -0.05


@dataclass(frozen=True, slots=True)
class ShelfTruth:
    """How a search has ended, and how the shelf stands.

    Attributes:
        target: What the cell's order is, which a mission may be told to do without.
        found: Whether it was taken out, or can be seen from the middle viewpoint.
        visible_share: How much of it shows from there, in [0, 1].
        retrieved: Whether it stands on the counter.
        taken: All that stands there.
        wrong: What of that is not the cell's order.
        toppled: How many boxes no longer stand as they stood.
        disorder_m: How far boxes in the shelf are from where they were at first, on average.
        toppled_names: Which boxes those are.
        fallen: Which boxes have fallen out of the shelf.
        poses: Where everything is: position [m] and quaternion xyzw of each centre.
    """

    target: str
    found: bool
    visible_share: float
    retrieved: bool
    taken: tuple[str, ...]
    wrong: tuple[str, ...]
    toppled: int
    disorder_m: float
    toppled_names: tuple[str, ...]
    fallen: tuple[str, ...]
    poses: Mapping[str, tuple[float, ...]]


def lean_rad(quats_xyzw: Floats) -> Floats:
    """Return by how much upright boxes lean, shape (N,)."""
    upright = pose_matrices(np.zeros((len(quats_xyzw), 3)), quats_xyzw)[:, 2, 2]
    angles: Floats = np.arccos(np.clip(upright, -1.0, 1.0))
    return angles


def shelf_truth(scene: Scene, poses: Floats, shares: Floats) -> ShelfTruth:
    """Score a shelf.

    Args:
        scene: What stood there at first.
        poses: Position [m] and quaternion xyzw of each box, in the scene's order, shape (N, 7).
        shares: How much of each shows from the middle viewpoint, shape (N,).
    """
    names = np.array(scene.names)
    which = scene.names.index(scene.target)
    low = poses[:, 2] < _FALLEN_M
    outside = (poses[:, 0] < 0.0) & (poses[:, 1] > 0.0) & ~low
    leaning = lean_rad(poses[:, 3:]) > TOPPLED_RAD
    first = np.array([(box.x_m, box.y_m) for box in scene.boxes])
    away_m = np.hypot(*(poses[:, :2] - first).T)[~outside & ~low]
    taken = names[outside].tolist()
    return ShelfTruth(
        target=scene.target,
        found=bool(outside[which] or shares[which] > 0.0),
        visible_share=round(float(shares[which]), 4),
        retrieved=bool(outside[which]),
        taken=tuple(taken),
        wrong=tuple(name for name in taken if name != scene.target),
        toppled=int(leaning.sum()),
        disorder_m=round(float(away_m.mean()), 4) if len(away_m) else 0.0,
        toppled_names=tuple(names[leaning].tolist()),
        fallen=tuple(names[low].tolist()),
        poses={
            name: tuple(np.round(pose, 5).tolist())
            for name, pose in zip(scene.names, poses, strict=True)
        },
    )
