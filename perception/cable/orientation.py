"""The same cable read from its other end."""

from collections.abc import Sequence
from dataclasses import replace

from perception.cable.types import Crossing, Trace


def reversed_trace(trace: Trace) -> Trace:
    """Return the trace from its end to its start; why it ended stays as it is."""
    return replace(trace, points_px=trace.points_px[::-1].copy())


def reversed_crossings(crossings: Sequence[Crossing], trace: int = 0) -> tuple[Crossing, ...]:
    """Return the crossings for the same traces with one of them reversed.

    Over and under stay as they are: they do not depend on the direction of travel.
    """
    return tuple(
        replace(
            crossing,
            arc_over=1.0 - crossing.arc_over if crossing.trace_over == trace else crossing.arc_over,
            arc_under=(
                1.0 - crossing.arc_under if crossing.trace_under == trace else crossing.arc_under
            ),
        )
        for crossing in crossings
    )
