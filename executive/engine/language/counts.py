"""What `observe` counts."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class NodeCounts:
    """How often a node did what.

    Attributes:
        ticks: Ticks in all.
        running: Ticks after which it ran.
        successes: Ticks after which it had succeeded.
        failures: Ticks after which it had failed.
        halts: How often it was halted while it ran.
    """

    ticks: int = 0
    running: int = 0
    successes: int = 0
    failures: int = 0
    halts: int = 0
