"""What a recording tells a tree that is ticked again, tick by tick."""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from pydantic import ValidationError

from executive.core.errors import RecordingError
from executive.core.outcome import Outcome
from executive.core.outcome import Status as Answer
from executive.engine.blackboard import Write
from executive.engine.faults.injector import BY as INJECTED_BY
from executive.engine.recording.messages import (
    INTERVENTIONS_TOPIC,
    PAUSES_TOPIC,
    InterventionMessage,
    PauseMessage,
)
from executive.engine.recording.reader import Recording
from executive.engine.ticks import Tick
from executive.inspector.index import FAILURE, RUNNING, SUCCESS, RunIndex
from executive.inspector.retick.values import RecordedValue

ANSWERS: Mapping[int, Answer] = {
    RUNNING: Answer.RUNNING,
    SUCCESS: Answer.SUCCESS,
    FAILURE: Answer.FAILURE,
}

_NOBODY = InterventionMessage(tick=-1, node=-1, what="", by="")


@dataclass(frozen=True, slots=True)
class Pause:
    """A pause that was over at `ended_s` of the cell's clock, and had lasted `lasted_s`."""

    ended_s: float
    lasted_s: float


class RecordedScript:
    """The recorded side of a run that is ticked again.

    Attributes:
        index: What happened when.
        pauses: Pauses that came to an end, in order.
        length: Number of ticks that asked the tree; a record of the runner may follow them.
        tick: The record of the tick that is being repeated.
    """

    def __init__(self, index: RunIndex) -> None:
        """Read what the index does not hold.

        Raises:
            RecordingError: A pause or an intervention cannot be read.
        """
        self.index = index
        recording = index.recording
        self.pauses = tuple(_pauses(recording))
        self._meddled = _meddled(recording)
        self.length = len(recording) - (1 if self._closes(recording) else 0)
        self.tick = recording.tick(0)
        self._row: list[int] = []
        self._writes: dict[str, list[Write]] = {}

    @cached_property
    def meddled_nodes(self) -> frozenset[int]:
        """Nodes in whose place something else has answered, raised or written at some time."""
        return frozenset(node for _, node in self._meddled)

    @cached_property
    def raising(self) -> frozenset[str]:
        """Paths of the nodes that have raised at some time."""
        return frozenset(fault.path for faults in self.index.faults.values() for fault in faults)

    def at(self, number: int) -> Tick:
        """Go to a tick, and return its record."""
        self.tick = self.index.recording.tick(number)
        self._row = self.index.answers[number].tolist()
        self._writes = {}
        for write in self.tick.writes:
            self._writes.setdefault(write.writer, []).append(write)
        return self.tick

    def answer(self, node: int) -> int:
        """Return what a node answered, `INVALID` where it did not."""
        return self._row[node]

    def answered(self, node: int) -> Answer | None:
        """Return what a node answered, None where it did not."""
        return ANSWERS.get(self._row[node])

    def outcome(self, node: int) -> Outcome:
        """Return what a leaf answered that did."""
        reason = self.index.reason(node, self.tick.number)
        return Outcome(ANSWERS[self._row[node]], reason=reason)

    def writes(self, path: str) -> list[Write]:
        """Return what a node wrote, in order."""
        return [*self._writes.get(path, ())]

    def raised(self, path: str) -> str:
        """Return what a node raised, in words; empty where it did not."""
        faults = self.tick.faults
        return next((fault.message for fault in faults if fault.path == path), "")

    def meddled(self, node: int) -> bool:
        """Return whether something else had a hand in what a node did in the tick."""
        return (self.tick.number, node) in self._meddled

    def forced(self, node: int) -> Answer | None:
        """Return what was answered in the place of a node."""
        return self._meddled.get((self.tick.number, node), _NOBODY).answer

    def delayed(self, node: int) -> bool:
        """Return whether a node was kept from starting up to the tick before."""
        before = self._meddled.get((self.tick.number - 1, node), _NOBODY)
        return before.by == INJECTED_BY and before.answer is Answer.RUNNING

    def rewritten(self, write: Write) -> Write | None:
        """Return a write as the run had it where something else had a hand in it."""
        node = self.index.indices.get(write.writer)
        if node is None or not self.meddled(node) or self.forced(node) is not None:
            return write
        left = self._writes.get(write.writer, [])
        place = next((i for i, one in enumerate(left) if one.key == write.key), None)
        if place is None:
            return None
        return Write(write.key, RecordedValue(left.pop(place).value), write.writer)

    def pauses_before(self, time_s: float) -> tuple[Pause, ...]:
        """Return the pauses that were over at a time of the cell's clock [s]."""
        over = bisect_right(self.pauses, time_s, key=lambda pause: pause.ended_s)
        return self.pauses[:over]

    def _closes(self, recording: Recording) -> bool:
        """Return whether the last record is that of the runner, after the last tick."""
        last = len(recording) - 1
        if recording.tick(last).visited:
            return False
        if recording.result is not None:
            return recording.result.report.ticks == last
        return last > 0 and not recording.tick(last).faults


def _pauses(recording: Recording) -> list[Pause]:
    began_s, pauses = 0.0, []
    for data in recording.messages(PAUSES_TOPIC):
        try:
            message = PauseMessage.model_validate_json(data)
        except ValidationError as cause:
            raise _unreadable(recording, "pause", cause) from cause
        if message.state == "paused":
            began_s = message.time_s
        else:
            pauses.append(Pause(message.time_s, message.time_s - began_s))
    return pauses


def _meddled(recording: Recording) -> dict[tuple[int, int], InterventionMessage]:
    """Return interventions by tick and node: what answered, or raised, in the place of a node."""
    found = {}
    for data in recording.messages(INTERVENTIONS_TOPIC):
        try:
            message = InterventionMessage.model_validate_json(data)
        except ValidationError as cause:
            raise _unreadable(recording, "intervention", cause) from cause
        if message.answer is not None or message.by == INJECTED_BY:
            found[message.tick, message.node] = message
    return found


def _unreadable(recording: Recording, what: str, cause: Exception) -> RecordingError:
    return RecordingError(
        f"{recording.path}: a {what} cannot be read; got {cause}; expected what this version writes"
    )
