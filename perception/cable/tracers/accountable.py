"""Hold a tracer to account: what a trace claims must agree with all else that is seen.

A trace that claims to run from end to end and yet leaves cable out, lies upon itself so long
that crossings hide, or crosses a connector, is not believed, however sure the tracer was of
each step.
"""

from collections.abc import Sequence
from dataclasses import replace

from perception.cable.bundles import separateness
from perception.cable.covered_ends import ends_are_clear
from perception.cable.interfaces import Tracer
from perception.cable.observation import Observe
from perception.cable.types import Endpoint, Points, Trace, TraceEnd
from perception.cable.wholeness import wholeness
from perception.camera import GreyImage


class AccountableTracer:
    """Implements `Tracer` by another tracer, whose claims are checked.

    Args:
        tracer: Follows cables.
        observe: Looks at an image.
    """

    def __init__(self, tracer: Tracer, observe: Observe) -> None:
        self._tracer, self._observe = tracer, observe

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow the cable that starts at `start_px`; see `Tracer.trace`."""
        trace = self._tracer.trace(image, start_px, endpoints)
        observation = self._observe(image)
        if trace is None or observation is None:
            return None
        if trace.end is not TraceEnd.ENDPOINT:
            return trace
        belief = wholeness(observation, trace.points_px) * separateness(trace.points_px)
        belief *= ends_are_clear(trace.points_px)
        return replace(trace, probability=trace.probability * belief)
