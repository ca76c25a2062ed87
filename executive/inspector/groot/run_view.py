"""A run as Groot2 watches it: the tree, statuses, blackboards and transitions at a moment.

The moment is the last tick of a recording, which grows while the run goes on, or moves through
a recording in time.
"""

import time
from collections import deque
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final

from executive.engine.recording.growing import GrowingRecording
from executive.engine.recording.reader import Recording
from executive.engine.ticks import NodeStatus, Tick
from executive.inspector.groot.boards import blackboards, packed
from executive.inspector.groot.live_tree import LiveTree
from executive.inspector.groot.wire import NodeByte, Transition

_BYTES: Final = {
    NodeStatus.INVALID: NodeByte.IDLE,
    NodeStatus.RUNNING: NodeByte.RUNNING,
    NodeStatus.SUCCESS: NodeByte.SUCCESS,
    NodeStatus.FAILURE: NodeByte.FAILURE,
}
_KEPT_TRANSITIONS: Final = 100_000
_LOOKED_BACK: Final = 1000
"""So many ticks before the moment at which a client joins tell what idle nodes were before."""


class RunView:
    """One run; `refresh` moves the moment on."""

    def __init__(
        self,
        path: Path,
        *,
        speed: float | None = None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """Open a recording.

        Args:
            path: The recording.
            speed: Play it from its first tick, so many seconds of the cell a second; without
                it, the moment is always the last tick.
            now: The machine's clock [s].

        Raises:
            RecordingError: It cannot be read.
            InputError: It has more nodes than the protocol can number.
        """
        self.path = path
        self._growing = GrowingRecording(path)
        self._speed, self._now, self._began_s = speed, now, now()
        self._since_s: float | None = None
        self._transitions: deque[Transition] = deque(maxlen=_KEPT_TRANSITIONS)
        self._begin()

    @property
    def recording(self) -> Recording:
        """The recording as far as it has been read."""
        return self._growing.recording

    @property
    def live(self) -> bool:
        """Whether the run still goes on."""
        return self.recording.result is None

    def refresh(self) -> None:
        """Read what has been written since, and move on.

        Raises:
            RecordingError: The file is gone.
        """
        self._growing.refresh()
        if self.recording.header != self._header:
            self._begin()  # another run took the file's place
        self._follow()

    def statuses(self) -> list[int]:
        """Return the byte of every node in the order of their numbers."""
        uses = [self._bytes[station.root] for station in self.tree.stations[1:]]
        return [*self._bytes, *uses]

    def blackboards(self, names: Iterable[str]) -> bytes:
        """Return the values of blackboards as MessagePack; without names, of all."""
        board = {} if self._at < 0 else self.recording.blackboard(self._at)
        return packed(blackboards(board, self.tree.boards, [*names]))

    def record_transitions(self, wanted: bool) -> None:
        """Begin to keep transitions, or stop."""
        if wanted:
            self._transitions.clear()
        self._since_s = self._time_s() if wanted else None

    def take_transitions(self) -> list[Transition]:
        """Return the transitions since the last call."""
        taken = [*self._transitions]
        self._transitions.clear()
        return taken

    def _begin(self) -> None:
        self._header = self.recording.header
        self.tree = LiveTree(self._header)
        self._uses: dict[int, list[int]] = {}
        for station in self.tree.stations[1:]:
            self._uses.setdefault(station.root, []).append(station.uid)
        self._bytes: list[int] = [NodeByte.IDLE] * len(self._header.nodes)
        self._at = -1
        self._transitions.clear()
        self._follow()

    def _follow(self) -> None:
        last = self._moment()
        if last - self._at > _LOOKED_BACK and self._since_s is None:
            self._at = last - _LOOKED_BACK
            self._bytes = [_BYTES[status] for status in self.recording.statuses(self._at)]
        while self._at < last:
            self._at += 1
            self._take(self.recording.tick(self._at))

    def _moment(self) -> int:
        recording = self.recording
        last = len(recording) - 1
        if self._speed is None or last < 0:
            return last
        begin_s = recording.tick(0).time_s
        now_s = begin_s + (self._now() - self._began_s) * self._speed
        at = max(self._at, 0)
        while at < last and recording.tick(at + 1).time_s <= now_s:
            at += 1
        return at

    def _time_s(self) -> float:
        return self.recording.tick(self._at).time_s if self._at >= 0 else 0.0

    def _take(self, tick: Tick) -> None:
        for node, status in tick.changes:
            before, byte = self._bytes[node], _BYTES[status]
            idles = byte is NodeByte.IDLE and 0 < before < NodeByte.IDLE_AFTER
            self._bytes[node] = NodeByte.IDLE_AFTER + before if idles else byte
            if self._since_s is not None:
                for uid in (node + 1, *self._uses.get(node, ())):
                    self._transitions.append(Transition(tick.time_s - self._since_s, uid, byte))
