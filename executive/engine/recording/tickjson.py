"""Turns ticks into the JSON of `TickMessage`: only what is not as it was before.

The model is the schema and what readers parse with; here its JSON is written straight from
the tick, since checking again what the engine made would cost more than the tick itself.
"""

from pydantic import JsonValue
from pydantic_core import to_json

from executive.core.outcome import Reason
from executive.engine.blackboard import Write
from executive.engine.recording.large import LargeValues
from executive.engine.recording.messages import KEYFRAME_EVERY, TickMessage
from executive.engine.recording.values import ValueEncoder
from executive.engine.ticks import NodeOutcome, NodeStatus, Tick

_PLAIN = (int, str, bool, type(None))

Json = dict[str, object]


class TickEncoder:
    """Encodes the ticks of one run in order."""

    def __init__(self, nodes: int, values: ValueEncoder, large: LargeValues) -> None:
        """Begin with a tree of so many nodes, none of which has run.

        Args:
            nodes: Number of nodes.
            values: Encodes values.
            large: Told which key the next values belong to.
        """
        self._values, self._large = values, large
        self._statuses = [NodeStatus.INVALID] * nodes
        self._written: dict[str, int] = {}
        self._ended: dict[int, int] = {}
        self._visited: tuple[int, ...] | None = None
        self.keyframe_due = False

    def encode(self, tick: Tick) -> bytes:
        """Return the JSON of a tick; its images and large arrays are stored on the way."""
        for node, status in tick.changes:
            self._statuses[node] = status
        message: Json = {
            "tick": tick.number,
            "time_s": tick.time_s,
            "duration_s": tick.duration_s,
        }
        if tick.visited != self._visited or self._is_keyframe(tick.number):
            message["visited"] = self._visited = tick.visited
        self._add_lists(message, tick)
        if self._is_keyframe(tick.number):
            self.keyframe_due = False
            message["keyframe"] = {
                "statuses": [_word(status) for status in self._statuses],
                "written": self._written,
                "ended": self._ended,
            }
        return to_json(message)

    def follow(self, tick: TickMessage) -> None:
        """Take note of a tick that was written by an earlier writer."""
        for node, status in tick.changes:
            self._statuses[node] = status
        self._written.update((write.key, tick.tick) for write in tick.writes)
        self._ended.update((outcome.node, tick.tick) for outcome in tick.outcomes)
        self._visited = self._visited if tick.visited is None else tick.visited

    def _is_keyframe(self, number: int) -> bool:
        return self.keyframe_due or number % KEYFRAME_EVERY == 0

    def _add_lists(self, message: Json, tick: Tick) -> None:
        """Add what is not empty."""
        if tick.changes:
            message["changes"] = [(node, _word(status)) for node, status in tick.changes]
        if tick.halts:
            message["halts"] = tick.halts
        if tick.outcomes:
            message["outcomes"] = [self._outcome(end, tick) for end in tick.outcomes]
        if tick.writes:
            message["writes"] = [self._write(write, tick) for write in tick.writes]
        if tick.faults:
            message["faults"] = tick.faults
        if tick.slow:
            message["slow"] = tick.slow

    def _outcome(self, outcome: NodeOutcome, tick: Tick) -> Json:
        self._ended[outcome.node] = tick.number
        reason = outcome.reason
        return {
            "node": outcome.node,
            "status": _word(outcome.status),
            "reason": None if reason is None else self._reason(reason, tick),
        }

    def _reason(self, reason: Reason, tick: Tick) -> Json:
        if reason.data:
            self._large.begin(reason.code, tick.time_s)
        data = {name: self._values.encode(value) for name, value in reason.data.items()}
        return {"code": reason.code, "text": reason.text, "data": data}

    def _write(self, write: Write, tick: Tick) -> Json:
        self._written[write.key] = tick.number
        value: JsonValue | object = write.value
        if type(value) not in _PLAIN:
            self._large.begin(write.key, tick.time_s)
            value = self._values.encode(value)
        return {"key": write.key, "value": value, "writer": write.writer}


def _word(status: NodeStatus) -> str:
    """Return a status as a plain word: `to_json` needs several times longer for an enumeration."""
    word: str = status._value_
    return word
