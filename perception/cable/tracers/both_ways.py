"""Trace a cable from both ends: two looks at every doubtful place, from opposite sides.

A trace that comes to an end is followed back from there. Both agree, and the belief in either
supports the other; or they do not, and the likelier one of them is doubted.
"""

from collections.abc import Sequence

import numpy as np
from scipy.special import expit, logit

from perception.cable.following import followed_share
from perception.cable.interfaces import Tracer
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import Endpoint, Points, Trace, TraceEnd
from perception.camera import GreyImage

# A trace that is surer than this is not followed back.
SURE = 0.97
# The second look sees the same image: it tells this share of what a new one would.
SHARE = 0.5
# Two lines nearer than this are one [px]; the start of the way back, from the end on [px].
SAME_PX = 6.0
BACK_PX = 24.0


class BothWaysTracer:
    """Implements `Tracer` by another tracer, asked from both ends of the cable.

    Args:
        tracer: Follows cables one way.
    """

    def __init__(self, tracer: Tracer) -> None:
        self._tracer = tracer

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow the cable that starts at `start_px`; see `Tracer.trace`."""
        there = self._tracer.trace(image, start_px, endpoints)
        if there is None or there.end is not TraceEnd.ENDPOINT or there.probability > SURE:
            return there
        back = self._back(image, there, np.atleast_2d(start_px), endpoints)
        return there if back is None else combined(there, back)

    def _back(
        self, image: GreyImage, there: Trace, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Return the trace from the other end, turned to run from the start; None for none."""
        arcs = arc_lengths(there.points_px)
        if arcs[-1] < 4.0 * BACK_PX:
            return None
        first = point_at(there.points_px, arcs, arcs[-1] - np.linspace(0.0, BACK_PX, 4))
        ahead = there.points_px[min(4, len(arcs) - 1)] - start_px[0]
        direction = ahead / max(float(np.linalg.norm(ahead)), 1e-9)
        begin = Endpoint(start_px[0], direction, 1.0)
        back = self._tracer.trace(image, first, [*endpoints, begin])
        if back is None or np.linalg.norm(back.points_px[-1] - start_px[0]) > BACK_PX:
            return None
        return Trace(back.points_px[::-1], back.end, back.probability)


def combined(there: Trace, back: Trace) -> Trace:
    """Return the likelier of two traces between the same ends, with the belief of both."""
    one, other = (float(logit(np.clip(t.probability, 1e-4, 1.0 - 1e-4))) for t in (there, back))
    if alike(there, back):
        return Trace(
            there.points_px, there.end, float(expit(max(one, other) + SHARE * _least(one, other)))
        )
    best, rival = (there, back) if one >= other else (back, there)
    total = best.probability + rival.probability
    return Trace(best.points_px, TraceEnd.ENDPOINT, best.probability * best.probability / total)


def _least(one: float, other: float) -> float:
    """Return the support that the less sure look gives; a doubtful one takes nothing away."""
    return max(min(one, other), 0.0)


def alike(a: Trace, b: Trace) -> bool:
    """Say whether two traces follow the same line the same way round."""
    first, second = a.points_px, b.points_px
    return (
        followed_share(first[2:-2], second, SAME_PX, 6.0 * SAME_PX) >= 1.0
        and followed_share(second[2:-2], first, SAME_PX, 6.0 * SAME_PX) >= 1.0
    )
