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
from robots.motion.model import ArmKinematics

MAX_STEPS = 30
TOLERANCE = 1e-5  # of the twist's norm [m, rad]
_STEP_CAP_RAD = 0.5
_DAMPING = 1e-3
_IDENTITY: Floats = np.eye(6)


def solve_pose(
    arm: ArmKinematics, T_world_tcp: pin.SE3, start_rad: Floats, max_steps: int = MAX_STEPS
) -> Floats | None:
    """Return joint positions within limits that reach a pose, or None from this start.

    Args:
        arm: Kinematics of the arm.
        T_world_tcp: Target of the tool.
        start_rad: Joint positions to descend from, shape (7,).
        max_steps: Steps before giving up.
    """
    q = start_rad.copy()
    for _ in range(max_steps):
        T_now, jacobian = arm.tcp_jacobian(q)
        error = pin.log6(T_now.actInv(T_world_tcp)).vector
        size = float(np.sqrt(error @ error))
        if size < TOLERANCE:
            return q
        step = _damped_step(jacobian, error, size)
        stuck = ((q <= arm.lower) & (step < 0.0)) | ((q >= arm.upper) & (step > 0.0))
        if stuck.any():
            step = _damped_step(jacobian * ~stuck, error, size)
        q = np.clip(q + step, arm.lower, arm.upper)
    return None


def _damped_step(jacobian: Floats, error: Floats, size: float) -> Floats:
    damped = jacobian @ jacobian.T + (_DAMPING * max(size, 1e-3)) * _IDENTITY
    step: Floats = jacobian.T @ np.linalg.solve(damped, error)
    largest = float(np.abs(step).max())
    return step * (_STEP_CAP_RAD / largest) if largest > _STEP_CAP_RAD else step


@dataclass(frozen=True, slots=True, eq=False)
class StartBank:
    """Joint positions from which arms start their descent, and where the tool is at each.

    A start whose tool is already near the target converges more often and keeps the elbow
    in an ordinary place.

    Attributes:
        positions_rad: Shape (n, 7).
        tools_m: Tool positions in the world [m], shape (n, 3).
    """

    positions_rad: Floats
    tools_m: Floats

    def near(self, position_m: Floats, count: int) -> Iterator[Floats]:
        """Yield the starts whose tools are nearest to a position, nearest first."""
        distances = np.sum((self.tools_m - position_m) ** 2, axis=1)
        for index in np.argsort(distances, kind="stable")[:count]:
            yield self.positions_rad[index]


def random_bank(arm: ArmKinematics, rng: np.random.Generator, count: int) -> StartBank:
    """Return random configurations of an arm whose tool points down at least roughly."""
    positions: list[Floats] = []
    tools: list[Floats] = []
    while len(positions) < count:
        q = rng.uniform(arm.lower, arm.upper)
        T_world_tcp = arm.tcp_pose(q)
        if T_world_tcp.rotation[2, 2] < -0.5:
            positions.append(q)
            tools.append(T_world_tcp.translation.copy())
    return StartBank(np.array(positions), np.array(tools))
