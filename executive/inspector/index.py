"""A whole recording in memory, small and quick to ask: one pass over its ticks.

What every node answered in every tick is a table of bytes, 6 MB for an hour of 177 nodes at
10 Hz. Values of the blackboard stay in the recording; the index knows where they are.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from executive.core.outcome import Reason
from executive.engine.recording.messages import RecordedNode
from executive.engine.recording.reader import Recording
from executive.engine.ticks import Halt, NodeFault, NodeStatus, Tick

STATUSES = (NodeStatus.INVALID, NodeStatus.RUNNING, NodeStatus.SUCCESS, NodeStatus.FAILURE)
INVALID, RUNNING, SUCCESS, FAILURE = range(4)
_CODES = {status: code for code, status in enumerate(STATUSES)}

StatusTable = NDArray[np.int8]


@dataclass(frozen=True, slots=True)
class Activation:
    """One life of a node, from its start to its end.

    Attributes:
        node: Index of the node.
        start: Tick in which it started.
        end: Tick in which it ended; the last one where it still ran.
        status: How it ended: SUCCESS, FAILURE, INVALID when it was halted, RUNNING when the
            recording ends before it did.
    """

    node: int
    start: int
    end: int
    status: NodeStatus


@dataclass(frozen=True, slots=True)
class WritePlace:
    """Where a recording holds a write.

    Attributes:
        key: The full key.
        tick: When.
        position: Place among the writes of that tick.
        writer: Path of the node that wrote; empty for an input of the mission.
    """

    key: str
    tick: int
    position: int
    writer: str


class RunIndex:
    """What happened when, node by node and key by key.

    Attributes:
        recording: The recording itself.
        nodes: Node table.
        children: Indices of the children of every node, in order.
        times_s: When each tick began, on the cell's clock [s], shape (ticks,).
        durations_s: How long each took, on the machine's clock [s], shape (ticks,).
        statuses: Status of each node after each tick, shape (ticks, nodes); see `STATUSES`.
        answers: What each node answered in each tick, 0 where it was not asked; unlike a
            status, an answer outlives a halt in the same tick.
        halts: Halts by tick, where there are any.
        faults: Exceptions by tick, where there are any.
        writes: Writes by key, in order.
        writes_in: Writes by tick, in order, where there are any.
        outcome_codes: Per tick, what leaves said that was news: node, status, reason code.
    """

    def __init__(self, recording: Recording) -> None:
        """Read a recording through once."""
        self.recording = recording
        self.nodes: tuple[RecordedNode, ...] = recording.header.nodes
        self.children = _children(self.nodes)
        count = len(recording)
        self.times_s = np.zeros(count)
        self.durations_s = np.zeros(count)
        self.statuses: StatusTable = np.zeros((count, len(self.nodes)), np.int8)
        self.answers: StatusTable = np.zeros((count, len(self.nodes)), np.int8)
        self.halts: dict[int, tuple[Halt, ...]] = {}
        self.faults: dict[int, tuple[NodeFault, ...]] = {}
        self.writes: dict[str, list[WritePlace]] = {}
        self.writes_in: dict[int, list[WritePlace]] = {}
        self.outcome_codes: dict[int, tuple[tuple[int, str, str], ...]] = {}
        self._reasons: dict[int, list[tuple[int, Reason | None]]] = {}
        self._halted: dict[int, list[int]] = {}
        self._activations: dict[int, tuple[Activation, ...]] = {}
        visits: dict[tuple[int, ...], NDArray[np.intp]] = {}
        for tick in recording.ticks():
            self._take(tick, visits.setdefault(tick.visited, np.array(tick.visited, np.intp)))

    @classmethod
    def of(cls, recording: Recording) -> "RunIndex":
        """Return the index of a recording."""
        return cls(recording)

    def __len__(self) -> int:
        """Return the number of tick records, the runner's closing one included."""
        return len(self.times_s)

    @cached_property
    def last_tick(self) -> int:
        """Number of the last tick that asked the tree, -1 where there is none."""
        asked = np.flatnonzero(self.answers.any(axis=1))
        return int(asked[-1]) if asked.size else -1

    @cached_property
    def indices(self) -> dict[str, int]:
        """Index of each node by its path."""
        return {node.path: index for index, node in enumerate(self.nodes)}

    @cached_property
    def stations(self) -> tuple[int, ...]:
        """Nodes at which another file begins: the root, and every use of a subtree."""
        return tuple(
            index
            for index, node in enumerate(self.nodes)
            if node.parent is None or self.nodes[node.parent].file != node.file
        )

    def path_to(self, node: int) -> tuple[int, ...]:
        """Return the indices from the root down to a node."""
        path = [node]
        while (parent := self.nodes[path[-1]].parent) is not None:
            path.append(parent)
        return tuple(reversed(path))

    def answer(self, node: int, tick: int) -> NodeStatus:
        """Return what a node answered in a tick, INVALID where it was not asked."""
        return STATUSES[self.answers[tick, node]]

    def status(self, node: int, tick: int) -> NodeStatus:
        """Return the status of a node after a tick."""
        return STATUSES[self.statuses[tick, node]]

    def asked(self, tick: int) -> NDArray[np.intp]:
        """Return the nodes that were asked in a tick, in the order of the table."""
        return np.flatnonzero(self.answers[tick])

    def activations(self, node: int) -> tuple[Activation, ...]:
        """Return the lives of a node, in order."""
        if node not in self._activations:
            self._activations[node] = tuple(self._lives(node))
        return self._activations[node]

    def activation(self, node: int, tick: int) -> Activation | None:
        """Return the life that a node had in a tick, None where it had none."""
        lives = self.activations(node)
        place = bisect_right(lives, tick, key=lambda life: life.start) - 1
        return lives[place] if place >= 0 and tick <= lives[place].end else None

    def last_end(self, node: int, until: int) -> Activation | None:
        """Return the last life of a node that ended in a tick or before."""
        lives = self.activations(node)
        place = bisect_right(lives, until, key=lambda life: life.end) - 1
        if place >= 0 and lives[place].status is NodeStatus.RUNNING:
            place -= 1  # the recording ends before it did
        return lives[place] if place >= 0 else None

    def ended_ticks(self, node: int) -> NDArray[np.intp]:
        """Return the ticks in which a node answered success or failure."""
        return np.flatnonzero(self.answers[:, node] >= SUCCESS)

    def reason(self, node: int, tick: int) -> Reason | None:
        """Return why a node failed in a tick, as it said itself."""
        said = self._reasons.get(node, [])
        place = bisect_right(said, tick, key=lambda entry: entry[0]) - 1
        return said[place][1] if place >= 0 and self.answers[tick, node] == FAILURE else None

    def halted_by(self, node: int, tick: int) -> int | None:
        """Return which node halted another in a tick (`RUNNER` is one), None if none did."""
        return next((halt.by for halt in self.halts.get(tick, ()) if halt.node == node), None)

    def halted_ticks(self, node: int) -> list[int]:
        """Return the ticks in which a node was halted."""
        return list(self._halted.get(node, ()))

    def value_at(self, place: WritePlace) -> object:
        """Return what was written, in its JSON form."""
        return self.recording.tick(place.tick).writes[place.position].value

    def span_s(self, life: Activation) -> float:
        """Return how long a life lasted on the cell's clock [s]."""
        return float(self.times_s[life.end] - self.times_s[life.start])

    def _take(self, tick: Tick, visited: NDArray[np.intp]) -> None:
        number = tick.number
        self.times_s[number], self.durations_s[number] = tick.time_s, tick.duration_s
        row = self.statuses[number]
        if number:
            row[:] = self.statuses[number - 1]
        for node, status in tick.changes:
            row[node] = _CODES[status]
        if tick.halts:
            self.halts[number] = tick.halts
            for halt in tick.halts:
                self._halted.setdefault(halt.node, []).append(number)
        if tick.faults:
            self.faults[number] = tick.faults
        self._take_outcomes(tick)
        self._take_writes(tick)
        answers = row[visited]
        if not answers.all():
            self._recall(tick, visited, answers)
        self.answers[number, visited] = answers

    def _take_outcomes(self, tick: Tick) -> None:
        if not tick.outcomes:
            return
        for end in tick.outcomes:
            self._reasons.setdefault(end.node, []).append((tick.number, end.reason))
        self.outcome_codes[tick.number] = tuple(
            (end.node, end.status.value, "" if end.reason is None else end.reason.code)
            for end in tick.outcomes
        )

    def _take_writes(self, tick: Tick) -> None:
        for position, write in enumerate(tick.writes):
            place = WritePlace(write.key, tick.number, position, write.writer)
            self.writes.setdefault(write.key, []).append(place)
            self.writes_in.setdefault(tick.number, []).append(place)

    def _recall(self, tick: Tick, visited: NDArray[np.intp], answers: StatusTable) -> None:
        """Fill in what nodes answered that were halted later in the same tick.

        One that ran is among the halts; a leaf that ended is among the outcomes, or ended as
        it did in the tick before; a node with children answers as the last of them did.
        """
        halted = {halt.node for halt in tick.halts}
        ended = {end.node: _CODES[end.status] for end in tick.outcomes}
        known = dict(zip(visited.tolist(), answers.tolist(), strict=True))
        for place, node in enumerate(visited.tolist()):
            if known[node] == INVALID:
                before = int(self.answers[tick.number - 1, node]) if tick.number else INVALID
                below = [known[child] for child in self.children[node] if child in known]
                answer = RUNNING if node in halted else ended.get(node) or below[-1:] or before
                known[node] = answer[0] if isinstance(answer, list) else answer
                answers[place] = known[node]

    def _lives(self, node: int) -> Sequence[Activation]:
        answers, count = self.answers[:, node], len(self)
        ran = np.concatenate(([False], self.statuses[:-1, node] == RUNNING))[:count]
        starts = np.flatnonzero((answers != INVALID) & ~ran)
        halted = np.array(self._halted.get(node, []), np.intp)
        ends = np.union1d(np.flatnonzero(answers >= SUCCESS), halted)
        places = np.searchsorted(ends, starts)
        lives = []
        for start, place in zip(starts.tolist(), places.tolist(), strict=True):
            if place == len(ends):
                lives.append(Activation(node, start, count - 1, NodeStatus.RUNNING))
                continue
            end = int(ends[place])
            code = int(answers[end])
            ended = STATUSES[code] if code >= SUCCESS else NodeStatus.INVALID
            lives.append(Activation(node, start, end, ended))
        return lives


def _children(nodes: Sequence[RecordedNode]) -> tuple[tuple[int, ...], ...]:
    below: list[list[int]] = [[] for _ in nodes]
    for index, node in enumerate(nodes):
        if node.parent is not None:
            below[node.parent].append(index)
    return tuple(tuple(children) for children in below)
