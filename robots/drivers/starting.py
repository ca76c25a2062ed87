"""What every driver checks before it starts a trajectory, in the same words."""

import numpy as np

from executive.core.errors import DeviceError
from robots.interfaces import ARMS, Floats, Trajectory

START_TOLERANCE_RAD = 2e-3


def refuse_while_moving(mode: str) -> None:
    """Refuse a trajectory unless nothing moves.

    Args:
        mode: What the arms do: `rest`, `motion`, `stop` or `brake`.

    Raises:
        DeviceError: It is not `rest`.
    """
    if mode != "rest":
        raise DeviceError(
            f"arms: a {mode} is under way; got another trajectory; expected one at a "
            "time; try: wait until the state says that nothing moves"
        )


def refuse_elsewhere(
    trajectory: Trajectory, positions_rad: Floats, tolerance_rad: float = START_TOLERANCE_RAD
) -> None:
    """Refuse a trajectory that does not begin where the arms are.

    Args:
        trajectory: The trajectory.
        positions_rad: Where they are, shape (14,).
        tolerance_rad: How far a joint may be off.

    Raises:
        DeviceError: A joint is further off.
    """
    away_rad = np.abs(trajectory.at(0.0)[0] - positions_rad)
    if away_rad.max() > tolerance_rad:
        joint = int(away_rad.argmax())
        raise DeviceError(
            f"arms: trajectory begins elsewhere; got {ARMS[joint // 7]} joint "
            f"{joint % 7 + 1} off by {away_rad[joint]:.4f} rad; expected at most "
            f"{tolerance_rad} rad; try: plan from the present state"
        )


def refuse_after_emergency(latched: bool) -> None:
    """Refuse a command once an emergency stop was made.

    Raises:
        DeviceError: It was.
    """
    if latched:
        raise DeviceError(
            "arms: an emergency stop was made; got another command; expected none until the "
            "cell is opened anew"
        )
