"""Holds a cell, and runs the missions that come in: one at a time, in the order in which they came.

After a stop, or a mission that was lost with its process, the cell is *held*: what is queued
waits until somebody says to go on.
"""

import threading
from collections import OrderedDict
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Literal

from executive.app.cell_locks import serving
from executive.app.missions import load, settings_of
from executive.app.service.journal import KEPT, Journal
from executive.app.service.messages import (
    CellState,
    CellStateName,
    MissionRequest,
    MissionView,
    TickView,
)
from executive.app.service.mission_process import MissionProcess, run_words
from executive.app.service.tick_feed import TickFeed
from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.recording.messages import RunReport
from executive.engine.running.remote import NotRunningError

MOST_QUEUED = 100
POLL_S = 0.1
JOURNAL = "missions.jsonl"

Ask = Callable[[MissionProcess], None]
_ENDED = "the service ended while it ran"


class BusyError(InputError):
    """The cell cannot do that now; the same request may do later."""


class UnknownMissionError(InputError):
    """There is no mission of that id."""


class CellService:
    """One cell with its queue; every method may be called from any thread.

    Use it as a context: the cell is held by this process, and missions run, while it lasts.
    """

    def __init__(self, cell: str, folder: Path, lock: Path) -> None:
        """Name the cell.

        Args:
            cell: Its name.
            folder: Where its missions are kept.
            lock: The file that whoever holds the cell holds.

        Raises:
            InputError: The folder cannot be made.
        """
        self._cell, self._folder, self._lock = cell, folder, lock
        self._journal = Journal(folder / JOURNAL)
        self._changed = threading.Condition()
        self._missions: OrderedDict[int, MissionView] = OrderedDict()
        self._keys: dict[str, int] = {}
        self._queue: list[int] = []
        self._running: int | None = None
        self._process: MissionProcess | None = None
        self._feed: TickFeed | None = None
        self._last: int | None = None
        self._state: CellStateName = "idle"
        self._why_held = ""
        self._closed = False
        self._stack = ExitStack()

    def __enter__(self) -> "CellService":
        """Take the cell, and begin.

        Raises:
            InputError: Another process holds it.
        """
        self._stack.enter_context(serving(self._cell, self._lock))
        self._know_again(self._journal.read())
        self._journal.begin(self._missions.values())
        thread = threading.Thread(target=self._work, name="missions")
        thread.start()
        self._stack.callback(thread.join)
        return self

    def __exit__(self, *_: object) -> None:
        """Stop what runs in order, keep what is queued, and let go of the cell."""
        with self._changed:
            self._closed = True
            process = self._process
            self._changed.notify_all()
        if process is not None:
            process.stop()
        self._stack.close()

    def submit(self, request: MissionRequest) -> MissionView:
        """Queue a mission; it has been checked, and is kept, when this returns.

        Raises:
            InputError: It is none of this cell's, or has faults.
            BusyError: Too many are queued.
        """
        if (known := self._known(request)) is not None:
            return known
        mission = load(request.mission)
        if mission.cell.name != self._cell:
            raise InputError(
                f"{request.mission}: runs on the cell {mission.cell.name!r}; expected a mission of "
                f"{self._cell!r}, which this service holds"
            )
        settings_of(mission, request.settings)
        return self._queued(request, None)

    def resume(self, number: int) -> MissionView:
        """Queue what goes on with a mission that was lost or stopped, from its last checkpoint.

        Raises:
            InputError: It has no recording, or came to its end.
            BusyError: Too many are queued.
        """
        with self._changed:
            view = self._view(number)
        ended = view.report is not None and view.report.outcome not in ("aborted", "error")
        if view.recording is None or view.state not in ("done", "lost") or ended:
            raise InputError(
                f"mission {number}: is {view.state}, there is nothing to go on with; expected one "
                "that was lost, stopped or broken"
            )
        return self._queued(view.request.model_copy(update={"key": ""}), number)

    def withdraw(self, number: int) -> MissionView:
        """Take a mission from the queue; the one that runs is stopped.

        Raises:
            UnknownMissionError: There is none.
            InputError: It is over.
        """
        with self._changed:
            view = self._view(number)
            if number in self._queue:
                self._queue.remove(number)
                return self._keep(view.model_copy(update={"state": "withdrawn"}))
            if number != self._running:
                raise InputError(f"mission {number}: is {view.state} already")
            self._state = "stopping"
            process = self._process
        if process is not None:
            process.stop()
        return view

    def mission(self, number: int) -> MissionView:
        """Return a mission.

        Raises:
            UnknownMissionError: There is none.
        """
        with self._changed:
            return self._view(number)

    def missions(self) -> list[MissionView]:
        """Return the missions that are known, the oldest first."""
        with self._changed:
            return [self._view(number) for number in self._missions]

    def state(self) -> CellState:
        """Return what the cell does now."""
        with self._changed:
            ticks, time_s = self._feed.progress if self._feed else (0, 0.0)
            return CellState(
                cell=self._cell,
                state=self._state,
                mission=self._running,
                ticks=ticks,
                time_s=time_s,
                queued=len(self._queue),
                last=self._last,
                why_held=self._why_held,
            )

    def ticks(self, after: int, most: int, mission: int | None = None) -> Sequence[TickView]:
        """Return ticks of the mission that runs, or ran last, that come after one.

        Args:
            after: Number of that tick; -1 for all that are kept.
            most: How many at most.
            mission: The mission that is meant; none are returned when it is another one now.
        """
        feed = self._feed
        if feed is None or mission not in (None, feed.mission):
            return ()
        return feed.after(after, most)

    def pause(self) -> CellState:
        """Pause the mission that runs.

        Raises:
            BusyError: None does, or it has not begun.
        """
        self._ask_running("pause", lambda process: process.pause())
        with self._changed:
            if self._state == "running":
                self._state = "paused"
        return self.state()

    def go_on(self) -> CellState:
        """Let a paused mission go on; where the cell is held, let the queue go on."""
        with self._changed:
            if self._state == "held":
                self._state, self._why_held = "idle", ""
                self._changed.notify_all()
            paused = self._state == "paused"
        if paused:
            self._ask_running("resume", lambda process: process.go_on())
            with self._changed:
                if self._state == "paused":
                    self._state = "running"
        return self.state()

    def stop(self) -> CellState:
        """Stop the mission that runs, in order, and hold the cell."""
        return self._stopped("stopped by a client", lambda process: process.stop())

    def emergency_stop(self) -> CellState:
        """Stop the mission that runs at once, and hold the cell."""
        return self._stopped("emergency stop", lambda process: process.emergency_stop())

    def _stopped(self, why: str, ask: Ask) -> CellState:
        with self._changed:
            process = self._process
            self._why_held = why
            self._state = "held" if self._running is None else "stopping"
        if process is not None:
            ask(process)
        return self.state()

    def _ask_running(self, what: str, ask: Ask) -> None:
        with self._changed:
            process = self._process if self._state in ("running", "paused") else None
        try:
            if process is None:
                raise NotRunningError("none runs")
            ask(process)
        except NotRunningError as error:
            raise BusyError(f"{what}: no mission is under way; got {error}") from None

    def _known(self, request: MissionRequest) -> MissionView | None:
        """Return the mission that was asked for with the same key.

        Raises:
            InputError: That was another mission.
        """
        with self._changed:
            number = self._keys.get(request.key) if request.key else None
            if number is None:
                return None
            known = self._view(number)
        if known.request != request:
            raise InputError(
                f"key {request.key!r}: is that of mission {number}, which is another one; "
                "expected the same request; try another key"
            )
        return known

    def _queued(self, request: MissionRequest, resumes: int | None) -> MissionView:
        known = self._known(request)  # under the lock again: two may have come at once
        with self._changed:
            if known is None and request.key in self._keys:
                known = self._view(self._keys[request.key])
            if known is not None:
                return known
            if len(self._queue) >= MOST_QUEUED:
                raise BusyError(f"{MOST_QUEUED} missions are queued; try again later")
            number = next(reversed(self._missions), 0) + 1
            view = MissionView(id=number, request=request, state="queued", resumes=resumes)
            self._keep(view)
            self._queue.append(number)
            self._changed.notify_all()
            return self._view(number)

    def _view(self, number: int) -> MissionView:
        if number not in self._missions:
            known = [str(one) for one in self._missions]
            raise UnknownMissionError(f"no mission {number}; {closest(str(number), known)}")
        view = self._missions[number]
        if number not in self._queue:
            return view
        ahead = self._queue.index(number) + (self._running is not None)
        return view.model_copy(update={"ahead": ahead})

    def _keep(self, view: MissionView) -> MissionView:
        """Know a change: first in the file, so that nothing is promised that a kill takes back."""
        self._journal.add(view)
        self._missions[view.id] = view
        if view.request.key:
            self._keys[view.request.key] = view.id
        while len(self._missions) > KEPT + MOST_QUEUED:
            _, oldest = self._missions.popitem(last=False)
            self._keys.pop(oldest.request.key, None)
        return view

    def _know_again(self, views: Sequence[MissionView]) -> None:
        """Take over what a service before this one has left."""
        for view in views:
            if view.state == "running":
                view = view.model_copy(update={"state": "lost", "reason": _ENDED})
                self._last, self._state = view.id, "held"
            self._missions[view.id] = view
            if view.request.key:
                self._keys[view.request.key] = view.id
            if view.state == "queued":
                self._queue.append(view.id)
                self._state = "held"
        if self._state == "held":
            self._why_held = "the service was started anew"

    def _work(self) -> None:
        while (number := self._next()) is not None:
            try:
                self._run(number)
            except Exception as error:  # one mission must not end the service
                self._lose(number, f"{type(error).__name__}: {error}")

    def _next(self) -> int | None:
        """Wait for a mission; None when the service ends."""
        with self._changed:
            while not self._closed and (self._state != "idle" or not self._queue):
                self._changed.wait()
            if self._closed:
                return None
            self._running = self._queue.pop(0)
            self._state = "starting"
            return self._running

    def _run(self, number: int) -> None:
        recording = self._folder / f"mission_{number:06d}.mcap"
        with self._changed:
            view = self._keep(
                self._missions[number].model_copy(
                    update={"state": "running", "recording": str(recording)}
                )
            )
            words = self._words(view)
            self._feed = feed = TickFeed(number, recording)
            self._process = process = MissionProcess(words, recording, self._lock)
            stopping = self._state == "stopping" or self._closed
        if stopping:
            process.stop()
        while process.watch():
            feed.refresh()
            with self._changed:
                if self._state == "starting" and feed.begun:
                    self._state = "running"
                self._changed.wait(POLL_S)
        feed.refresh()
        report, reason = process.report()
        self._end(view, "done" if report is not None else "lost", report=report, reason=reason)

    def _words(self, view: MissionView) -> list[str]:
        if view.resumes is None:
            return run_words(view.request)
        earlier = self._missions[view.resumes].recording
        assert earlier is not None
        return ["resume", earlier]

    def _lose(self, number: int, reason: str) -> None:
        self._end(self._missions[number], "lost", report=None, reason=reason)

    def _end(
        self,
        view: MissionView,
        state: Literal["done", "lost"],
        *,
        report: RunReport | None,
        reason: str,
    ) -> None:
        with self._changed:
            try:
                ended = view.model_copy(update={"state": state, "report": report, "reason": reason})
                self._missions[view.id] = ended
                self._keep(ended)
            except InputError as error:  # a full disk: it is known here, and the cell waits
                self._why_held = self._why_held or str(error)
            if state == "lost":
                self._why_held = self._why_held or f"mission {view.id} was lost: {reason}"
            self._running, self._process, self._last = None, None, view.id
            self._state = "held" if self._why_held else "idle"
            self._changed.notify_all()
