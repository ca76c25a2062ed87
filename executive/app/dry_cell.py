"""A cell without devices, on a clock that jumps: trees of stubs run on it in no time."""

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from executive.core.clock import ManualClock
from executive.core.errors import InputError
from executive.core.world import StreamMessage


class DryCell:
    """Nothing that moves, and nothing to wait for."""

    def __init__(self, config: Mapping[str, object], scenario: Mapping[str, object]) -> None:
        """Open it.

        Raises:
            InputError: It is configured, or something is to be set up in it.
        """
        for what, given in (("config", config), ("scenario", scenario)):
            if given:
                raise InputError(f"the world 'dry' takes no {what}; got {next(iter(given))!r}")
        self.clock = ManualClock()
        self.devices: Mapping[str, object] = MappingProxyType({})

    def drain_streams(self) -> Iterable[StreamMessage]:
        """Return nothing: no stream comes from here."""
        return ()

    def stop(self) -> None:
        """Do nothing: nothing moves."""

    def emergency_stop(self) -> None:
        """Do nothing: nothing moves."""

    def close(self) -> None:
        """Do nothing: nothing is held."""

    def truth(self) -> object | None:
        """Return None: there is nothing to score."""
        return None
