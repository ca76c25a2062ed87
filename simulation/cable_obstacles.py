"""What of the robot pushes the cable: capsules on the hands and the links above them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from robots.descriptions.model import Capsule, RobotDescription
from robots.interfaces import ARMS, Arm
from simulation.cable.rod import Rod
from simulation.poses import pose_matrices

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
    """Moves hands and capsules of a rod along with the links of the robot.

    Attributes:
        links: Index of the link of each capsule, shape (M,).
        ends_m: Ends of each capsule in its link's frame, homogeneous, shape (M, 2, 4).
        radii_m: Shape (M,).
        tcp: Index of each arm's tool frame.
    """

    links: NDArray[np.int64]
    ends_m: Floats
    radii_m: Floats
    tcp: dict[Arm, int]

    @classmethod
    def of(cls, robot: RobotDescription, link_names: Sequence[str]) -> "CableObstacles":
        """Pick the parts of a robot that come near the table."""
        shapes = {link.name: link.shapes for link in robot.links}
        parts = [
            (link_names.index(name), shape)
            for arm in ARMS
            for name, own in chain(
                ((f"{arm}_{link}", shapes[f"{arm}_{link}"]) for link in _LINKS),
                ((f"{arm}_{finger}", _FINGER) for finger in _FINGERS),
            )
            for shape in own
            if isinstance(shape, Capsule)
        ]
        ends = np.array([[(*s.start_m, 1.0), (*s.end_m, 1.0)] for _, s in parts])
        return cls(
            links=np.array([index for index, _ in parts]),
            ends_m=ends,
            radii_m=np.array([shape.radius_m for _, shape in parts]),
            tcp={arm: link_names.index(f"{arm}_tcp") for arm in ARMS},
        )

    def follow(self, rod: Rod, positions_m: Floats, quats_xyzw: Floats) -> None:
        """Say where everything is at the end of the rod's next advance."""
        T_world_links = pose_matrices(positions_m, quats_xyzw)
        ends_m = np.einsum("mij,mej->mei", T_world_links[self.links], self.ends_m)
        rod.set_capsules(ends_m[:, 0, :3], ends_m[:, 1, :3], self.radii_m)
        for arm, index in self.tcp.items():
            rod.move_hand(arm, T_world_links[index])
