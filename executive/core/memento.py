"""What a device remembers, so that a mission can go on after the process behind it has died."""

from typing import Protocol, runtime_checkable

from pydantic import JsonValue


@runtime_checkable
class Remembering(Protocol):
    """A device whose answers depend on what it was asked before."""

    def memento(self) -> JsonValue:
        """Return what it remembers."""
        ...

    def recall(self, memento: JsonValue) -> None:
        """Go on as the device went on from which the memento is."""
        ...
