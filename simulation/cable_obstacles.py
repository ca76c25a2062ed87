"""What of the robot pushes the cable: capsules on the hands and the links above them."""

from dataclasses import dataclass
from itertools import chain

import numba
import numpy as np
from numpy.typing import NDArray

from robots.descriptions.model import Capsule, RobotDescription
from robots.interfaces import ARMS
from simulation.cable.rod import Rod
from simulation.poses import pose_matrices
from simulation.yumi_body import YumiBody

Floats = NDArray[np.float64]

_LINKS = ("link_5", "link_6", "link_7", "gripper_base")
_FINGERS = ("finger_a", "finger_b")
# A finger's inner face is its plane x = 0: a slim tip below a thicker root.
_FINGER = (
    Capsule((-0.003, 0.0065, 0.024), (-0.003, 0.0065, 0.0492), 0.003),
    Capsule((-0.006, 0.0065, 0.004), (-0.006, 0.0065, 0.022), 0.006),
)


@dataclass(frozen=True, slots=True, eq=False)
class CableObstacles:
    """Moves hands and capsules of a rod along with the links of a robot.

    Attributes:
        links: Names of the links whose poses matter.
        owners: Index of the link of each capsule, shape (M,).
        ends_m: Ends of each capsule in its link's frame, shape (M, 2, 3).
        radii_m: Shape (M,).
    """

    links: tuple[str, ...]
    owners: NDArray[np.int64]
    ends_m: Floats
    radii_m: Floats

    @classmethod
    def of(cls, robot: RobotDescription) -> "CableObstacles":
        """Pick the parts of a robot that come near the table."""
        shapes = {link.name: link.shapes for link in robot.links}
        tools = [f"{arm}_tcp" for arm in ARMS]
        bodies = {f"{arm}_{link}": shapes[f"{arm}_{link}"] for arm in ARMS for link in _LINKS}
        fingers = {f"{arm}_{finger}": _FINGER for arm in ARMS for finger in _FINGERS}
        links = (*tools, *bodies, *fingers)
        parts = [
            (links.index(name), shape)
            for name, own in chain(bodies.items(), fingers.items())
            for shape in own
            if isinstance(shape, Capsule)
        ]
        return cls(
            links=links,
            owners=np.array([index for index, _ in parts]),
            ends_m=np.array([[s.start_m, s.end_m] for _, s in parts]),
            radii_m=np.array([shape.radius_m for _, shape in parts]),
        )

    def follow(self, body: YumiBody, rod: Rod) -> None:
        """Say where everything is at the end of the rod's next advance."""
        positions_m, quats_xyzw = body.link_poses(self.links)
        axes_m = _placed(positions_m, quats_xyzw, self.owners, self.ends_m)
        rod.set_capsules(axes_m[:, 0], axes_m[:, 1], self.radii_m)
        hands = len(ARMS)
        tools = pose_matrices(positions_m[:hands], quats_xyzw[:hands])
        for arm, T_world_tcp in zip(ARMS, tools, strict=True):
            rod.move_hand(arm, T_world_tcp)


@numba.njit(cache=True)
def _placed(
    positions_m: Floats, quats_xyzw: Floats, owners: NDArray[np.int64], ends_m: Floats
) -> Floats:
    """Return the ends of capsules in the world, shape (M, 2, 3).

    This is asked for at every step of the world; arrays would take ten times as long.
    """
    placed = np.empty_like(ends_m)
    for m in range(len(owners)):
        link = owners[m]
        u, w = quats_xyzw[link, :3], quats_xyzw[link, 3]
        for end in range(2):
            p = ends_m[m, end]
            # Twice u x p, from which a unit quaternion turns p by w t + u x t.
            tx = 2.0 * (u[1] * p[2] - u[2] * p[1])
            ty = 2.0 * (u[2] * p[0] - u[0] * p[2])
            tz = 2.0 * (u[0] * p[1] - u[1] * p[0])
            placed[m, end, 0] = p[0] + w * tx + u[1] * tz - u[2] * ty + positions_m[link, 0]
            placed[m, end, 1] = p[1] + w * ty + u[2] * tx - u[0] * tz + positions_m[link, 1]
            placed[m, end, 2] = p[2] + w * tz + u[0] * ty - u[1] * tx + positions_m[link, 2]
    return placed
