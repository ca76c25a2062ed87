"""Moves through the ticks: step by step, by playing, by what is looked for."""

import time
from pathlib import Path
from typing import Final

from textual import on, work
from textual.timer import Timer
from textual.worker import get_current_worker

from executive.core.errors import InputError
from executive.inspector.finding import Wish, found
from executive.inspector.search import search
from executive.inspector.terminal.lanes import Lanes
from executive.inspector.terminal.opened import OpenedRun
from executive.inspector.terminal.view import RunView, Start

SPEEDS: Final = (0.25, 0.5, 1.0, 2.0, 4.0, 16.0, 64.0)
_FRAME_S = 0.05
_NOTHING = "nothing further that way"


class Moving(RunView):
    """A view of a run in which the user moves from tick to tick."""

    def __init__(self, path: Path, start: Start = lambda _: (None, 0)) -> None:
        """Look at a recording; see `RunView`."""
        super().__init__(path, start)
        self._speed = SPEEDS.index(1.0)
        self._playing: Timer | None = None
        self._begun: tuple[float, int] = (0.0, 0)
        self._where = ""

    @property
    def playing(self) -> str:
        """How fast the run is played; empty when it is not."""
        return f"play x{SPEEDS[self._speed]:g}" if self._playing else ""

    def go(self, tick: int) -> None:
        """Show a tick, or the nearest there is."""
        opened = self._opened
        if opened is None:
            return
        self.tick = max(0, min(tick, opened.last))
        self._following = not opened.ended and self.tick == opened.last
        self.lanes.set_span(self.lanes.span.around(self.tick, max(1, opened.last)))
        self.show()

    def action_tick_by(self, step: int) -> None:
        """Move by some ticks."""
        self.note("")
        self.go(self.tick + step)

    def action_first(self) -> None:
        """Go to the first tick."""
        self.go(0)

    def action_last(self) -> None:
        """Go to the last tick, and follow a live run."""
        if self._opened is not None:
            self.go(self._opened.last)

    def action_play(self) -> None:
        """Play from here on, or stop playing."""
        if self._playing is not None:
            self._playing.stop()
            self._playing = None
        elif self._opened is not None:
            if self.tick >= self._opened.last:
                self.go(0)
            self._begun = (time.monotonic(), self.tick)
            self._playing = self.set_interval(_FRAME_S, self._play_on)
        self.show()

    def _play_on(self) -> None:
        opened = self._opened
        if opened is None:
            return
        begun_s, first = self._begun
        rate_hz = opened.recording.header.tick_hz * SPEEDS[self._speed]
        tick = first + int((time.monotonic() - begun_s) * rate_hz)
        if tick != self.tick:
            self.go(tick)
        if self.tick >= opened.last:
            self.action_play()

    def action_speed(self, step: int) -> None:
        """Play faster or slower."""
        self._speed = max(0, min(self._speed + step, len(SPEEDS) - 1))
        self._begun = (time.monotonic(), self.tick)
        self.note(f"speed x{SPEEDS[self._speed]:g}")
        self.show()

    def action_zoom(self, factor: float) -> None:
        """Show fewer or more ticks in the lanes."""
        if self._opened is not None:
            last = max(1, self._opened.last)
            self.lanes.set_span(self.lanes.span.zoomed(factor, self.tick, last))

    @on(Lanes.Scrubbed)
    def _scrub(self, message: Lanes.Scrubbed) -> None:
        self.go(message.tick)

    def action_seek(self, kind: str, direction: int) -> None:
        """Go to the next tick, or the one before, in which something happened."""
        opened = self._opened
        if opened is None:
            return
        if kind == "where" and not self._where:
            self.prompt.ask("where")
            return
        path = opened.recording.header.nodes[self.node].path
        self.note("searching …")
        wish = Wish(
            kind,
            self.tick,
            direction > 0,
            node=path,
            key=self.key or self.board.selected,
            where=self._where,
        )
        self._seek(opened, wish)

    @work(thread=True, exclusive=True, group="seek")
    def _seek(self, opened: OpenedRun, wish: Wish) -> None:
        try:
            index = opened.past().index
            matches = search(index, wish.where) if wish.kind == "where" else []
            tick = found(index, wish)
        except InputError as error:
            self.call_later(self._refuse, str(error))
            return
        if not get_current_worker().is_cancelled:
            self.call_later(self._arrive, wish, tick, matches)

    def _refuse(self, message: str) -> None:
        self.note(message, wrong=True)

    def _arrive(self, wish: Wish, tick: int | None, matches: list[int]) -> None:
        said = ""
        if wish.kind == "where":
            self._where = wish.where
            self.lanes.set_found(matches)
            after = sum(match > (self.tick if tick is None else tick) for match in matches)
            said = f"{len(matches)} ticks with {wish.where}; {after} after this one (n, N)"
            self._leave_prompt()
        if tick is None:
            said = f"{_NOTHING}; {said}" if said else _NOTHING
        self.note(said)
        if tick is not None:
            self.go(tick)
