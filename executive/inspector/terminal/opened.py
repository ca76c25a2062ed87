"""The run that is looked at: read piece by piece, followed while it goes on."""

import threading
from collections.abc import Callable
from pathlib import Path

from executive.core.errors import recording_named_by_the_user
from executive.engine.recording.growing import GrowingRecording
from executive.engine.recording.reader import Recording
from executive.inspector.activity import Activity
from executive.inspector.past import PastRun

_PIECE = 2000
"""Ticks that are read between two words about how far reading is."""


class OpenedRun:
    """One recording, read again as it grows; its methods may be called from any thread.

    Attributes:
        path: The file.
        activity: What every node did at every tick that has been read.
    """

    def __init__(self, path: Path) -> None:
        """Open a recording; its ticks are read by `read`.

        Raises:
            InputError: It cannot be read, or holds no tick.
        """
        self.path = path
        self._growing = self._opened(path)
        self.activity = Activity(len(self.recording.header.nodes))
        self._lock = threading.Lock()
        self._past: PastRun | None = None

    @property
    def recording(self) -> Recording:
        """The recording as far as it has been read."""
        return self._growing.recording

    @property
    def ended(self) -> bool:
        """Whether the run came to its end and said so."""
        return self.recording.result is not None

    @property
    def last(self) -> int:
        """Number of the last tick record, -1 where there is none yet."""
        return len(self.recording) - 1

    @property
    def last_asked(self) -> int:
        """The last tick that asked the tree: after it the runner may have stopped the rest."""
        last = self.last
        return last if last <= 0 or self.recording.tick(last).visited else last - 1

    def read(self, go_on: Callable[[int, int], bool]) -> None:
        """Read all ticks.

        Args:
            go_on: Told again and again how many have been read, of how many; reading ends
                when it returns False.
        """
        recording = self.recording
        while len(self.activity) < len(recording):
            self.activity.follow(recording, len(self.activity) + _PIECE)
            if not go_on(len(self.activity), len(recording)):
                return

    def refresh(self) -> bool:
        """Read what has been written since; return whether there was anything."""
        if not self._growing.refresh():
            return False
        self.activity.follow(self.recording)
        return True

    def past(self, *, tick: int | None = None) -> PastRun:
        """Return the run as questions need it.

        Args:
            tick: The tick that the question is about; None when it is about the whole run, as
                far as it has been read.
        """
        with self._lock:
            needed = len(self.recording) if tick is None or self.ended else tick + 1
            known = 0 if self._past is None else len(self._past.index)
            if self._past is None or known < needed or self._past.recording is not self.recording:
                self._past = PastRun(self.recording)
            return self._past

    @staticmethod
    def _opened(path: Path) -> GrowingRecording:
        with recording_named_by_the_user():
            return GrowingRecording(path)
