"""What every node did at every tick, as one matrix: the lanes of the page are cut from it."""

from collections.abc import Mapping
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


_CODES: Mapping[str, Code] = {
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
        self._visited = np.zeros(0, np.intp)
        self._count = 0

    def __len__(self) -> int:
        """Return how many ticks are in."""
        return self._count

    def follow(self, recording: Recording, until: int | None = None) -> None:
        """Take in the ticks of a recording that are not in yet, up to one that is left out."""
        end = len(recording) if until is None else min(until, len(recording))
        for number in range(self._count, end):
            self._make_room()
            moves, row = recording.moves(number), self._codes[number]
            for node, status in moves.changes:
                self._statuses[node] = _CODES[status]
            if moves.visited is not None:
                self._visited = np.array(moves.visited, np.intp)
            row[self._visited] = self._statuses[self._visited]
            if moves.halted:
                row[moves.halted] = Code.HALTED
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
