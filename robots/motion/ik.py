"""Inverse kinematics of one arm: damped least squares from many starts.

For a pose, the error e is the twist from tool to target in the tool's frame, and each step is
dq = J^T (J J^T + mu I)^-1 e with mu proportional to |e| (Levenberg-Marquardt as in Sugihara,
IEEE T-RO 2011), capped in length and clipped to the limits; joints that stand at a limit and would
leave it are taken out of the step. Starts that converge need 5-10
steps, so each gets a few dozen at most and then the next start is taken.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from robots.interfaces import Floats
from robots.motion.chain_kernels import Descent, descend
from robots.motion.model import ArmKinematics

MAX_STEPS = 30
TOLERANCE = 1e-5  # of the twist's norm [m, rad]
DESCENT = Descent(MAX_STEPS, TOLERANCE, step_cap=0.5, damping=1e-3)


def solve_pose(
    arm: ArmKinematics,
    T_world_tcp: pin.SE3,
    start_rad: Floats,
    max_steps: int = MAX_STEPS,
    *,
    limited: bool = True,
) -> Floats | None:
    """Return joint positions within limits that reach a pose, or None from this start.

    Args:
        arm: Kinematics of the arm.
        T_world_tcp: Target of the tool.
        start_rad: Joint positions to descend from, shape (n,).
        max_steps: Steps before giving up.
        limited: Whether to stay within limits; without, one sees which limit hinders.
    """
    q, reached = descend(
        arm.chain,
        np.ascontiguousarray(T_world_tcp.rotation),
        T_world_tcp.translation,
        start_rad,
        DESCENT._replace(most_steps=max_steps),
        limited,
    )
    return q if reached else None


def nearest_turns(arm: ArmKinematics, positions_rad: Floats, present_rad: Floats) -> Floats:
    """Return the same pose of all links with whole turns added so that joints move least.

    Args:
        arm: Kinematics of the arm; turns stay within its limits.
        positions_rad: Shape (n,).
        present_rad: Where the joints are, shape (n,).
    """
    turns = np.round((present_rad - positions_rad) / (2.0 * np.pi))
    least = np.ceil((arm.lower - positions_rad) / (2.0 * np.pi))
    most = np.floor((arm.upper - positions_rad) / (2.0 * np.pi))
    nearest: Floats = positions_rad + 2.0 * np.pi * np.clip(turns, least, most)
    return nearest


# A tool that points a radian elsewhere is as far away as one that is so many metres off.
_AXIS_M = 0.4


@dataclass(frozen=True, slots=True, eq=False)
class StartBank:
    """Joint positions from which arms start their descent, and where the tool is at each.

    A start whose tool is already near the target, and points its way, converges more often and
    keeps the elbow in an ordinary place.

    Attributes:
        positions_rad: Shape (b, n).
        tools: Position [m] and scaled axis of each tool in the world, shape (b, 6).
    """

    positions_rad: Floats
    tools: Floats

    def near(self, T_world_tcp: pin.SE3, count: int) -> Iterator[Floats]:
        """Yield the starts whose tools are nearest to a pose, nearest first."""
        distances = np.sum((self.tools - _place(T_world_tcp)) ** 2, axis=1)
        for index in np.argsort(distances, kind="stable")[:count]:
            yield self.positions_rad[index]


def random_bank(arm: ArmKinematics, rng: np.random.Generator, count: int) -> StartBank:
    """Return random configurations of an arm; joints that turn freely stay within one turn."""
    lower, upper = np.maximum(arm.lower, -np.pi), np.minimum(arm.upper, np.pi)
    narrow = arm.upper - arm.lower < 2.0 * np.pi
    lower, upper = np.where(narrow, arm.lower, lower), np.where(narrow, arm.upper, upper)
    positions = rng.uniform(lower, upper, (count, len(lower)))
    return StartBank(positions, np.array([_place(arm.tcp_pose(q)) for q in positions]))


def _place(T_world_tcp: pin.SE3) -> Floats:
    return np.concatenate([T_world_tcp.translation, _AXIS_M * T_world_tcp.rotation[:, 2]])
