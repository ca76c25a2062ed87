"""Look at a whole image before anything is followed: what is cable, and where it ends."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from perception.cable.endpoints import EndpointConfig
from perception.cable.observation import Observation, observe
from perception.cable.plug_ends import find_ends
from perception.cable.types import Endpoint
from perception.camera import GreyImage

# Where it is less likely than this that a cable ends, none does.
LEAST_END = 0.2


class Eye(Protocol):
    """What the steps of perception see an image with; each has more than one implementation."""

    def observe(self, image: GreyImage) -> Observation | None:
        """Return cable pixels and centre lines; None where no cable is seen."""
        ...

    def endpoints(self, image: GreyImage) -> tuple[Endpoint, ...]:
        """Return the ends of cables, the surest first."""
        ...


@runtime_checkable
class EndJudge(Protocol):
    """Who follows cables, and can tell whether one ends where it seems to."""

    def judged(self, image: GreyImage, endpoints: Sequence[Endpoint]) -> tuple[Endpoint, ...]:
        """Return ends, the surest first, with what it believes of them, too."""
        ...


class ThresholdEye:
    """Implements `Eye` for cables that are brighter than all else, by thresholds.

    Args:
        config: The search for ends.
    """

    def __init__(self, config: EndpointConfig | None = None) -> None:
        self._config = config or EndpointConfig()

    def observe(self, image: GreyImage) -> Observation | None:
        """Return cable pixels and centre lines; None where no cable is seen."""
        return observe(image)

    def endpoints(self, image: GreyImage) -> tuple[Endpoint, ...]:
        """Return the ends of cables, the surest first."""
        observation = observe(image)
        if observation is None:
            return ()
        return find_ends(observation.mask, observation.graph, self._config)
