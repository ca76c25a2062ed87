"""The last ticks of the running mission, for whoever wants to hear them."""

import threading
from collections import deque
from pathlib import Path

from executive.app.service.messages import TickView
from executive.core.errors import RecordingError
from executive.engine.recording.growing import GrowingRecording
from executive.engine.recording.reader import Recording

KEPT = 2000
"""Ticks that a slow listener may lag behind; those before are in the recording."""


class TickFeed:
    """Follows one recording; may be asked from any thread.

    Listeners ask for what is new to them, so none of them costs memory or holds up another.
    """

    def __init__(self, mission: int, recording: Path) -> None:
        """Follow a recording that need not be there yet."""
        self._mission, self._path = mission, recording
        self._growing: GrowingRecording | None = None
        self._ticks: deque[TickView] = deque(maxlen=KEPT)
        self._lock = threading.Lock()
        self._next, self._time_s = 0, 0.0

    @property
    def mission(self) -> int:
        """Id of the mission."""
        return self._mission

    @property
    def progress(self) -> tuple[int, float]:
        """Number of ticks so far, and the time of the last one on the cell's clock [s]."""
        return self._next, self._time_s

    @property
    def begun(self) -> bool:
        """Whether the recording is there."""
        return self._growing is not None

    def refresh(self) -> None:
        """Read what has been written since."""
        try:
            if self._growing is None:
                if not self._path.exists():
                    return
                self._growing = GrowingRecording(self._path)
            else:
                self._growing.refresh()
        except RecordingError:  # its first message is not complete yet
            return
        self._take(self._growing.recording)

    def _take(self, recording: Recording) -> None:
        count = len(recording)
        with self._lock:
            for number in range(max(self._next, count - KEPT), count):
                self._ticks.append(_view(self._mission, recording, number))
            if count > self._next:
                self._time_s = recording.tick(count - 1).time_s
            self._next = count

    def after(self, tick: int, most: int) -> list[TickView]:
        """Return ticks that come after one, the oldest first."""
        with self._lock:
            first = self._next - len(self._ticks)
            begin = max(0, tick + 1 - first)
            return [
                self._ticks[place] for place in range(begin, min(len(self._ticks), begin + most))
            ]


def _view(mission: int, recording: Recording, number: int) -> TickView:
    tick, nodes = recording.tick(number), recording.header.nodes
    return TickView(
        mission=mission,
        tick=tick.number,
        time_s=tick.time_s,
        changes={nodes[node].path: status.value for node, status in tick.changes},
        outcomes={
            nodes[one.node].path: str(one.reason) for one in tick.outcomes if one.reason is not None
        },
        writes=tuple(write.key for write in tick.writes),
    )
