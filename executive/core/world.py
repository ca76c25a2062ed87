"""What a runner needs of a cell, simulated or real: devices, time, streams, a way to stop."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from executive.core.clock import Clock


@dataclass(frozen=True, slots=True)
class StreamMessage:
    """One message of a recorded stream.

    Attributes:
        topic: Channel name such as `/joint_states`.
        schema: Name of the message's schema; docs/recording.md lists them.
        time_s: Time on the cell's clock [s].
        data: UTF-8 JSON.
    """

    topic: str
    schema: str
    time_s: float
    data: bytes


@runtime_checkable
class Cell(Protocol):
    """A cell that missions run on."""

    @property
    def clock(self) -> Clock:
        """The clock that ticks and motions share."""
        ...

    @property
    def devices(self) -> Mapping[str, object]:
        """Devices and services that skills bind to, by name."""
        ...

    def drain_streams(self) -> Iterable[StreamMessage]:
        """Return what has happened since the last call: joint states, scene."""
        ...

    def stop(self) -> None:
        """Bring every moving thing to rest, in order; safe to call at any time."""
        ...

    def emergency_stop(self) -> None:
        """Stop every moving thing as fast as its brakes allow, for good.

        Safe to call at any time and from any thread, also while another one is inside the cell
        or one of its devices: an emergency waits for no tick. Nothing moves after it returns,
        whatever skills still ask for.
        """
        ...

    def close(self) -> None:
        """Release devices; called once, last."""
        ...

    def truth(self) -> object | None:
        """Return a dataclass that scores the end state, or None on a real cell.

        Only the report of a run asks for it, once, after the mission has ended.
        """
        ...


@runtime_checkable
class RestorableCell(Protocol):
    """A cell, simulated, that can be put back into a state that it was in.

    What a snapshot holds is the world's business; it may hold what no skill is to know.
    """

    def snapshot(self) -> bytes:
        """Return the state of everything in the cell, its clock and its chance included.

        Raises:
            DeviceError: The cell is in no state to go on from, because something moves or is
                held.
        """
        ...

    def restore(self, snapshot: bytes) -> None:
        """Take up the state of a cell that was opened with the same settings.

        Raises:
            InputError: These are no such bytes, or those of another cell.
        """
        ...
