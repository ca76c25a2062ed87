"""What a tick does otherwise than it did in the run."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from executive.engine.ticks import RUNNER, Halt, Tick
from executive.inspector.brief import brief
from executive.inspector.index import STATUSES, RunIndex
from executive.inspector.retick.replay import WHAT_IF, Repeated, Replay

_CODES = {status: code for code, status in enumerate(STATUSES)}

NOT_ASKED = "not asked"


@dataclass(frozen=True, slots=True)
class NodeDifference:
    """A node that does something else in a tick.

    Attributes:
        path: The node.
        recorded: What it did in the run: `SUCCESS`, `not asked`, `RUNNING, then halted`.
        now: What it does now.
    """

    path: str
    recorded: str
    now: str


@dataclass(frozen=True, slots=True)
class WriteDifference:
    """A value that is another one.

    Attributes:
        key: The key.
        writer: The node that writes it, now or in the run.
        recorded: What was written in the run, in one line; empty for nothing.
        now: What is written now.
    """

    key: str
    writer: str
    recorded: str
    now: str


@dataclass(frozen=True, slots=True)
class TickDifference:
    """One tick that is not as it was.

    Attributes:
        tick: Its number.
        time_s: When it began, on the cell's clock [s].
        nodes: Nodes that do something else, in the order in which they answer now; those that
            are no longer asked come last.
        writes: Values that are other ones.
        in_order: Whether nodes answer in the order in which they did.
    """

    tick: int
    time_s: float
    nodes: tuple[NodeDifference, ...]
    writes: tuple[WriteDifference, ...]
    in_order: bool = True


class Comparison:
    """Holds the ticks of a run against those that were recorded, one after the other."""

    def __init__(self, replay: Replay, index: RunIndex) -> None:
        """Begin before the first tick."""
        self._replay, self._index = replay, index
        pairs = [(new, old) for new, old in enumerate(replay.recorded) if old is not None]
        self._new = np.array([new for new, _ in pairs], np.intp)
        self._old = np.array([old for _, old in pairs], np.intp)
        self._statuses = np.zeros(len(replay.recorded), np.int8)
        nodes = replay.tree.nodes
        self._writers = {nodes[new].path: index.nodes[old].path for new, old in pairs}
        # A tick that is taken up in its middle resets nodes that a whole one resets in the next.
        self._resumed = index.recording.header.resumed_from is not None
        self._exact = replay.recorded == tuple(range(len(index.nodes)))

    def of(self, repeated: Repeated) -> TickDifference | None:
        """Return what is otherwise in the next tick, None where nothing is."""
        tick, recorded = repeated.tick, repeated.recorded
        for node, status in tick.changes:
            self._statuses[node] = _CODES[status]
        # What a tick that broke off would have written is not known.
        writes = () if repeated.outside else tuple(self._writes(tick, recorded))
        if self._exact and not writes and _decides_as(tick, recorded):
            return None
        nodes = tuple(self._nodes(repeated))
        in_order = bool(nodes) or repeated.outside or self._in_order(tick, recorded)
        if not nodes and not writes and in_order:
            return None
        self._exact = False  # what changes in a tick is no longer comparable
        return TickDifference(recorded.number, recorded.time_s, nodes, writes, in_order)

    def _nodes(self, repeated: Repeated) -> Iterator[NodeDifference]:
        number = repeated.recorded.number
        answers = np.zeros(len(self._statuses), np.int8)
        for node, status in repeated.answers.items():
            answers[node] = _CODES[status]
        was, now = self._index.answers[number, self._old], answers[self._new]
        status_was = self._index.statuses[number, self._old]
        differ = was != now
        if not self._resumed:
            # What a node was left with in an earlier tick is no difference of this one.
            differ |= (now != 0) & (status_was != self._statuses[self._new])
        if repeated.outside:  # the tick broke off: only what was done counts
            differ = (was != now) & (now != 0)
        halted_now = self._halts(repeated.tick.halts, current=True)
        halted_then = self._halts(repeated.recorded.halts, current=False)
        if not repeated.outside:
            odd = {node for node, _ in halted_now ^ halted_then}
            differ |= np.isin(self._old, list(odd))
        places = np.flatnonzero(differ).tolist()
        ranks = {node: rank for rank, node in enumerate(repeated.answers)}
        places.sort(key=lambda place: ranks.get(int(self._new[place]), len(ranks)))
        for place in places:
            old, new = int(self._old[place]), int(self._new[place])
            yield NodeDifference(
                self._index.nodes[old].path,
                _told(int(was[place]), int(status_was[place]), old in dict(halted_then)),
                _told(int(now[place]), int(self._statuses[new]), old in dict(halted_now)),
            )

    def _halts(self, halts: Sequence[Halt], *, current: bool) -> set[tuple[int, int | None]]:
        """Return halted nodes and who halted them, by index in the recording."""
        if not current:
            return {(halt.node, halt.by) for halt in halts}
        recorded = self._replay.recorded
        found = set()
        for halt in halts:
            node = recorded[halt.node]
            if node is not None:
                found.add((node, RUNNER if halt.by == RUNNER else recorded[halt.by]))
        return found

    def _writes(self, tick: Tick, recorded: Tick) -> Iterator[WriteDifference]:
        if not tick.writes and not recorded.writes:
            return
        form = self._replay.board.form
        now = [
            (write.key, self._writers.get(write.writer, write.writer), form(write.value))
            for write in tick.writes
            if write.writer != WHAT_IF
        ]
        then = [(write.key, write.writer, write.value) for write in recorded.writes]
        if now == then:
            return
        last_now = {key: (writer, value) for key, writer, value in now}
        last_then = {key: (writer, value) for key, writer, value in then}
        for key in dict.fromkeys([*last_then, *last_now]):
            if last_then.get(key) != last_now.get(key):
                writer = (last_now.get(key) or last_then[key])[0]
                yield WriteDifference(key, writer, _shown(last_then, key), _shown(last_now, key))

    def _in_order(self, tick: Tick, recorded: Tick) -> bool:
        current = self._replay.current
        known = set(current.values())
        now = [node for node in tick.visited if node in known]
        return now == [current[node] for node in recorded.visited if node in current]


def _shown(values: Mapping[str, tuple[str, object]], key: str) -> str:
    return brief(values[key][1]) if key in values else ""


def _decides_as(tick: Tick, recorded: Tick) -> bool:
    return (
        tick.visited == recorded.visited
        and tick.changes == recorded.changes
        and tick.halts == recorded.halts
    )


def _told(answer: int, status: int, halted: bool) -> str:
    said = STATUSES[answer].value if answer else NOT_ASKED
    if halted:
        return f"{said}, then halted"
    return f"{said}, then reset" if answer and not status else said
