"""What has really become of a shelf; for the report of a run alone."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from perception.shelf.types import Floats, Shelf
from simulation.poses import pose_matrices

# A box that leans by more lies on another face, or against something.
TOPPLED_RAD = 0.5
# A middle below the floor is that of a box that fell out of the shelf.
_FALLEN_M = -0.05


@dataclass(frozen=True, slots=True)
class ShelfTruth:
    """The shelf as it stands.

    Attributes:
        target: Name of what was to be found.
        visible_share: How much of it shows from the middle viewpoint, in [0, 1].
        handed_over: Whether it stands on the counter.
        toppled: Names of boxes that no longer stand as they stood.
        fallen: Names of boxes that have fallen out of the shelf.
        poses: Where everything is: position [m] and quaternion xyzw of each centre.
    """

    target: str
    visible_share: float
    handed_over: bool
    toppled: tuple[str, ...]
    fallen: tuple[str, ...]
    poses: Mapping[str, tuple[float, ...]]


def lean_rad(quats_xyzw: Floats) -> Floats:
    """Return by how much upright boxes lean, shape (N,)."""
    upright = pose_matrices(np.zeros((len(quats_xyzw), 3)), quats_xyzw)[:, 2, 2]
    angles: Floats = np.arccos(np.clip(upright, -1.0, 1.0))
    return angles


def shelf_truth(
    target: str,
    names: tuple[str, ...],
    poses: Floats,
    shares: Floats,
    shelf: Shelf,
) -> ShelfTruth:
    """Score a shelf.

    Args:
        target: Name of what was to be found.
        names: Of all boxes.
        poses: Position [m] and quaternion xyzw of each, shape (N, 7).
        shares: How much of each shows from the middle viewpoint, shape (N,).
        shelf: The shelf.
    """
    leans = lean_rad(poses[:, 3:])
    which = names.index(target)
    on_counter = poses[which, 0] < 0.0 and 0.0 < poses[which, 1] < shelf.depth_m
    return ShelfTruth(
        target,
        float(shares[which]),
        bool(on_counter and poses[which, 2] > 0.0),
        tuple(name for name, lean in zip(names, leans, strict=True) if lean > TOPPLED_RAD),
        tuple(name for name, z in zip(names, poses[:, 2], strict=True) if z < _FALLEN_M),
        {name: tuple(map(float, pose)) for name, pose in zip(names, poses, strict=True)},
    )
