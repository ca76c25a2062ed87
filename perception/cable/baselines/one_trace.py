"""How baselines start: one trace, from the first end whose cable can be followed for a while."""

from collections.abc import Sequence

from perception.cable.interfaces import CableVision, Tracer
from perception.cable.types import Endpoint, Trace
from perception.camera import GreyImage


def first_trace(
    parts: CableVision, tracer: Tracer, image: GreyImage, endpoints: Sequence[Endpoint]
) -> tuple[Trace, ...]:
    """Return one trace, or none where no end gives a start.

    Args:
        parts: Gives start points; a robot would move the cable where there are none.
        tracer: Follows the cable from there.
        image: Grey image.
        endpoints: Ends, in the order in which they are tried.
    """
    for endpoint in endpoints:
        start_px = parts.start_points(image, endpoint)
        trace = None if start_px is None else tracer.trace(image, start_px, endpoints)
        if trace is not None:
            return (trace,)
    return ()
