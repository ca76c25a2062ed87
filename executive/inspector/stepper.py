"""Steps through the ticks of a recording, one key at a time."""

from collections.abc import Callable

from executive.engine.recording.reader import Recording
from executive.engine.ticks import NodeStatus
from executive.inspector.changes import next_change, previous_change

KEYS = "n next  p previous  c next change  b change before  f next failure  g go to  q quit"


class Stepper:
    """A place in a recording, and the keys that move it.

    Attributes:
        number: The tick that is shown.
        note: What there is to say about the last key; empty otherwise.
    """

    def __init__(self, recording: Recording, number: int, nodes: frozenset[int]) -> None:
        """Begin at a tick; changes and failures are those of the given nodes."""
        self._recording, self._nodes = recording, nodes
        self.number = number
        self.note = ""

    def press(self, key: str) -> None:
        """Move as a key says; an unknown key and one that leads nowhere leave a note."""
        self.note = ""
        moves: dict[str, Callable[[], int | None]] = {
            "n": lambda: self.number + 1,
            "p": lambda: self.number - 1,
            "c": lambda: next_change(self._recording, self.number, self._nodes),
            "b": lambda: previous_change(self._recording, self.number, self._nodes),
            "f": self._next_failure,
        }
        if key in moves:
            self.go_to(moves[key]())
        else:
            self.note = f"unknown key {key!r}"

    def go_to(self, number: int | None) -> None:
        """Show a tick, if there is one of that number."""
        if number is None or not 0 <= number < len(self._recording):
            self.note = "nothing further that way"
        else:
            self.number = number

    def _next_failure(self) -> int | None:
        for number in range(self.number + 1, len(self._recording)):
            changes = self._recording.tick(number).changes
            if any(s is NodeStatus.FAILURE for node, s in changes if node in self._nodes):
                return number
        return None
