"""What of the robot pushes the cable: capsules on the hands and the links above them."""

from dataclasses import dataclass
from itertools import chain

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
        ends_m: Ends of each capsule in its link's frame, homogeneous, shape (M, 2, 4).
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
            ends_m=np.array([[(*s.start_m, 1.0), (*s.end_m, 1.0)] for _, s in parts]),
            radii_m=np.array([shape.radius_m for _, shape in parts]),
        )

    def follow(self, body: YumiBody, rod: Rod) -> None:
        """Say where everything is at the end of the rod's next advance."""
        T_world_links = pose_matrices(*body.link_poses(self.links))
        ends_m = np.einsum("mij,mej->mei", T_world_links[self.owners], self.ends_m)
        rod.set_capsules(ends_m[:, 0, :3], ends_m[:, 1, :3], self.radii_m)
        for arm, T_world_tcp in zip(ARMS, T_world_links, strict=False):
            rod.move_hand(arm, T_world_tcp)
