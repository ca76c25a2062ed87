"""What every node did at every tick, as one matrix: the lanes of the page are cut from it."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from executive.engine.recording.reader import Recording
from executive.engine.ticks import NodeStatus

Codes = NDArray[np.uint8]


class Code(IntEnum):
    """What a node did in a tick; where many ticks share a column, the highest is shown."""

    NOTHING = 0
    SUCCESS = 1
    RUNNING = 2
    HALTED = 3
    FAILURE = 4


_CODES = {
    NodeStatus.INVALID: Code.NOTHING,
    NodeStatus.SUCCESS: Code.SUCCESS,
    NodeStatus.RUNNING: Code.RUNNING,
    NodeStatus.FAILURE: Code.FAILURE,
}


class Activity:
    """The codes of all nodes at all ticks of a recording that may still grow."""

    def __init__(self, nodes: int) -> None:
        """Begin without ticks."""
        self._codes: Codes = np.zeros((256, nodes), np.uint8)
        self._statuses: Codes = np.zeros(nodes, np.uint8)
        self._count = 0

    def __len__(self) -> int:
        """Return how many ticks are in."""
        return self._count

    def follow(self, recording: Recording) -> None:
        """Take in the ticks of a recording that are not in yet."""
        for number in range(self._count, len(recording)):
            self._make_room()
            tick, row = recording.tick(number), self._codes[number]
            for node, status in tick.changes:
                self._statuses[node] = _CODES[status]
            visited = np.fromiter(tick.visited, np.intp, len(tick.visited))
            row[visited] = self._statuses[visited]
            row[[halt.node for halt in tick.halts]] = Code.HALTED
            self._count += 1

    def lanes(self, first: int, last: int, columns: int) -> Codes:
        """Return the codes of ticks `first` to `last`, squeezed into columns.

        Args:
            first: First tick.
            last: Last tick, inclusive.
            columns: Most columns; there are fewer where there are fewer ticks.

        Returns:
            Codes, shape (nodes, columns).
        """
        codes = self._codes[max(first, 0) : min(last + 1, self._count)]
        if len(codes) <= columns:
            return codes.T.copy()
        starts = np.linspace(0, len(codes), columns, endpoint=False).astype(np.intp)
        squeezed: Codes = np.maximum.reduceat(codes, starts, axis=0).T
        return np.ascontiguousarray(squeezed)

    def _make_room(self) -> None:
        if self._count == len(self._codes):
            self._codes = np.concatenate([self._codes, np.zeros_like(self._codes)])
