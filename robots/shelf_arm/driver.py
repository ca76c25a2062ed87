"""What the arm's controllers and the tool's sensors must offer; numpy only."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from robots.interfaces import Floats, JointsDriver


@dataclass(frozen=True, slots=True, eq=False)
class Guard:
    """Ends a motion that meets more than it should.

    Attributes:
        direction: Unit vector of the motion, world axes, shape (3,).
        most_n: Greatest force against it [N].
    """

    direction: Floats
    most_n: float


@runtime_checkable
class ShelfArmDriver(JointsDriver, Protocol):
    """Controllers of one arm with a bluction tool, a force sensor and a vacuum switch."""

    def guard(self, guard: Guard | None) -> None:
        """Watch the force from now on, or stop watching.

        When it is too great, the brakes stop the joints, and they press no further.
        """
        ...

    def tripped(self) -> bool:
        """Return whether the guard has ended the last motion."""
        ...

    def force_n(self) -> Floats:
        """Return the force on the tool from outside [N], world axes, shape (3,).

        The weight of a box that was taken up at rest is left out.
        """
        ...

    def suck(self, on: bool) -> None:
        """Open or shut the valve of the cups."""
        ...

    def holds(self) -> bool:
        """Return whether the cups are sealed, which their pressure tells."""
        ...
