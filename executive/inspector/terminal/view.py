"""The panes of the inspector, and the run that they show."""

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, cast

from textual import on, work
from textual.app import App, ComposeResult
from textual.containers import Container
from textual.events import Resize
from textual.timer import Timer
from textual.widgets import ContentSwitcher, Footer
from textual.worker import get_current_worker

from executive.core.errors import CellwrightError, InputError
from executive.engine.recording.reader import Recording
from executive.engine.running.remote import send
from executive.inspector.report import mission_report
from executive.inspector.report_text import report_text
from executive.inspector.terminal import pages
from executive.inspector.terminal.bar import Bar
from executive.inspector.terminal.board import BoardRows
from executive.inspector.terminal.keys import TABS, TITLES
from executive.inspector.terminal.lanes import Lanes, Span
from executive.inspector.terminal.opened import OpenedRun
from executive.inspector.terminal.prompt import Prompt
from executive.inspector.terminal.rows import Rows
from executive.inspector.terminal.tabs import TabLine
from executive.inspector.terminal.told import Line, Told
from executive.inspector.terminal.tree import TreeRows

Start = Callable[[Recording], tuple[int | None, int]]
"""Returns the tick (None for the last) and the node to begin with, or raises `InputError`."""

_POLL_S, _SETTLE_S = 0.2, 0.04
_ASKS_A_QUESTION = frozenset({"key", "why", "report"})


class RunView(App[str]):
    """Shows one recording; returns what was wrong with it, if it could not be opened.

    Attributes:
        tick: Number of the tick that is shown.
        node: Index of the selected node.
        key: The selected key of the blackboard, empty for none.
    """

    ENABLE_COMMAND_PALETTE = False
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-wide")]  # noqa: RUF012 - as the base has it
    CSS = """
    #body { height: 1fr; layout: vertical; }
    #tree { height: 1fr; }
    #board { display: none; }
    #pages { height: 1fr; }
    #body.-board > #board { display: block; }
    #body.-board > #pages { display: none; }
    .-wide #body { layout: grid; grid-size: 2 3; grid-rows: 1 2fr 1fr; grid-columns: 1fr 1fr; }
    .-wide #tree { row-span: 2; height: 100%; }
    .-wide #pages { row-span: 2; height: 100%; display: block; }
    .-wide #board { display: block; border-top: solid $panel; }
    .-wide #pages, .-wide #tabs { border-left: solid $panel; }
    #body.-zoomed { layout: vertical; }
    #body.-zoomed > * { display: none; }
    #body.-zoomed > .-full { display: block; height: 1fr; border: none; }
    """

    def __init__(self, path: Path, start: Start = lambda _: (None, 0)) -> None:
        """Look at a recording.

        Args:
            path: The recording.
            start: Where to begin.
        """
        super().__init__()
        self._path, self._start = path, start
        self._opened: OpenedRun | None = None
        self.tick, self.node, self.key = 0, 0, ""
        self._tab = "why"
        self._following = False
        self._state: Mapping[str, Any] | None = None
        self._stood: object = None
        self._settling: Timer | None = None

    def compose(self) -> ComposeResult:
        """Lay out the panes."""
        yield Bar(id="bar", markup=False)
        yield Lanes(id="lanes")
        with Container(id="body"):
            yield TreeRows(id="tree")
            yield TabLine(id="tabs")
            with ContentSwitcher(id="pages", initial=self._tab):
                for name in TABS[1:]:
                    yield Told(id=name, fold=name not in ("yaml", "report"))
            yield BoardRows(id="board")
        yield Prompt(id="prompt")
        yield Footer(compact=True, show_command_palette=False)

    @property
    def tree_rows(self) -> TreeRows:
        """The tree."""
        return self.query_one("#tree", TreeRows)

    @property
    def board(self) -> BoardRows:
        """The blackboard."""
        return self.query_one("#board", BoardRows)

    @property
    def lanes(self) -> Lanes:
        """What happened over time."""
        return self.query_one("#lanes", Lanes)

    @property
    def prompt(self) -> Prompt:
        """The line at the bottom."""
        return self.query_one("#prompt", Prompt)

    @property
    def playing(self) -> str:
        """How fast the run is played; empty when it is not."""
        return ""

    @property
    def is_wide(self) -> bool:
        """Whether there is room for the blackboard beside the other panes."""
        return self.screen_stack[0].has_class("-wide")

    def note(self, text: str, *, wrong: bool = False) -> None:
        """Say something in the line at the bottom."""
        self.prompt.say(text, wrong=wrong)

    def on_mount(self) -> None:
        """Begin to read."""
        self.note(f"opening {self._path} …")
        self._show_tabs()
        self.tree_rows.focus()
        self._read()

    @work(thread=True, group="read")
    def _read(self) -> None:
        worker = get_current_worker()
        try:
            opened = OpenedRun(self._path)
            tick, node = self._start(opened.recording)
        except InputError as error:
            self.call_later(self.exit, str(error))
            return

        def go_on(done: int, count: int) -> bool:
            self.call_later(self._tell_progress, done, count)
            return not worker.is_cancelled

        self.call_later(self._begin, opened, tick, node)
        opened.read(go_on)
        if not worker.is_cancelled:
            opened.past(tick=0)
            self.call_later(self._has_read)
        while not (worker.is_cancelled or opened.ended):
            self._look_again(opened)
            time.sleep(_POLL_S)

    def _look_again(self, opened: OpenedRun) -> None:
        try:
            more = opened.refresh()
        except CellwrightError as error:
            self.call_later(self.note, str(error), wrong=True)
            more = False
        self.call_later(self._take_progress, more, self._asked_state(opened))

    def _asked_state(self, opened: OpenedRun) -> Mapping[str, Any] | None:
        if opened.ended:
            return None
        try:
            return cast(Mapping[str, Any], send(opened.path, "state"))
        except InputError:
            return None

    def _begin(self, opened: OpenedRun, tick: int | None, node: int) -> None:
        self._opened = opened
        nodes = opened.recording.header.nodes
        skills = [index for index, one in enumerate(nodes) if one.kind == "skill"]
        self.tree_rows.set_nodes(nodes)
        self.lanes.set_run(opened.activity, skills)
        self.lanes.set_span(Span(0, max(1, opened.last)))
        self._following = not opened.ended and tick is None
        self.tick = max(0, opened.last_asked if tick is None else tick)
        self.select(node)
        self.key = self.board.selected

    def _tell_progress(self, done: int, count: int) -> None:
        self.lanes.renew()
        self.note(f"reading: {done:,} of {count:,} ticks, {done / count:.0%}")

    def _has_read(self) -> None:
        self.note("")
        self.lanes.renew()
        self._show_tabs()
        self._show_page()

    def _take_progress(self, more: bool, state: Mapping[str, Any] | None) -> None:
        opened = self._opened
        if opened is None:
            return
        changed = state != self._state
        self._state = state
        if changed:
            self.refresh_bindings()
            self._show_tabs()
            self._stand()
        if more:
            span, last = self.lanes.span, opened.last
            self.lanes.set_span(Span(span.first, max(span.last, last)))
            self.lanes.renew()
            if self._following:
                self.tick = max(0, last)
        if more or changed:
            self.show()

    def _stand(self) -> None:
        """Select the node that a paused run has come to stand at."""
        place = (self._state or {}).get("standing")
        where = None if place is None else (place["tick"], place["node"])
        if place is not None and place["node"] and where != self._stood and self._opened:
            paths = [node.path for node in self._opened.recording.header.nodes]
            self.select(paths.index(place["node"]))
        self._stood = where

    def show(self) -> None:
        """Show the tick that is chosen, in every pane."""
        opened = self._opened
        if opened is None:
            return
        self.query_one(Bar).show(opened, self._state, self.tick, self.playing)
        if opened.last >= 0:
            recording, number = opened.recording, self.tick
            reasons, visited = recording.reasons(number), recording.tick(number).visited
            self.tree_rows.set_tick(recording.statuses(number), frozenset(visited), reasons)
            self.board.set_tick(recording.blackboard(number), number)
        self._show_lane()
        self._show_page()

    def _show_lane(self) -> None:
        if self._opened is not None:
            name = self._opened.recording.header.nodes[self.node].name
            self.lanes.set_place(self.tick, self.node, name)

    def _show_page(self) -> None:
        """Show the pane beside the tree; one that asks a question waits for a moment of rest."""
        opened = self._opened
        if opened is None or opened.last < 0:
            return
        if self._tab in _ASKS_A_QUESTION:
            if self._settling is not None:
                self._settling.stop()
            self._settling = self.set_timer(_SETTLE_S, self._ask_page)
        elif self._tab == "tick":
            self._tell("tick", pages.tick_page(opened.recording, self.tick))
        elif self._tab == "yaml":
            lines, at = pages.source_page(opened.recording.header, self.node)
            self._tell("yaml", lines, at)
        else:
            path = opened.recording.header.nodes[self.node].path
            self._tell("debug", pages.debug_page(self._state, path))

    @work(thread=True, exclusive=True, group="page")
    def _ask_page(self) -> None:
        opened, asked = self._opened, (self._tab, self.node, self.key, self.tick)
        if opened is None:
            return
        tab, node, key, tick = asked
        try:
            at: int | None = None
            if tab == "report":
                lines = pages.text_page(report_text(mission_report(opened.past())))
            elif tab == "why":
                lines = pages.why_page(opened.past(tick=tick), node, tick)
            elif key:
                lines, at = pages.key_page(opened.past(tick=tick), key, tick)
            else:
                lines = [Line("no key is selected; Enter on one of the blackboard", "muted")]
        except CellwrightError as error:
            lines = [Line(str(error), "failure")]
        if not get_current_worker().is_cancelled:
            self.call_later(self._answer, asked, lines, at)

    def _answer(self, asked: tuple[str, int, str, int], lines: list[Line], at: int | None) -> None:
        if asked == (self._tab, self.node, self.key, self.tick):
            self._tell(asked[0], lines, at)

    def _tell(self, tab: str, lines: list[Line], at: int | None = None) -> None:
        told = self.query_one(f"#{tab}", Told)
        if list(told.lines) != lines:
            told.tell(lines, cursor=at)

    def _show_tabs(self) -> None:
        tabs = [
            (number, name, title)
            for number, (name, title) in enumerate(zip(TABS, TITLES, strict=True), start=1)
            if not (name == "board" and self.is_wide) and not (name == "debug" and not self._live)
        ]
        body = self.query_one("#body")
        up = body.has_class("-board") and not self.is_wide
        self.query_one(TabLine).set_tabs(tabs, "board" if up else self._tab)

    @property
    def _live(self) -> bool:
        return self._state is not None

    def on_resize(self, _: Resize) -> None:
        """Lay out for the new width."""
        self.call_after_refresh(self._show_tabs)
        self.call_after_refresh(self.show)

    def select(self, node: int) -> None:
        """Select a node."""
        self.node = node
        self.tree_rows.select(node)
        self.show()

    @on(Rows.Moved, "#tree")
    def _take_selected(self) -> None:
        self.node = self.tree_rows.selected
        self._show_lane()
        self._show_page()

    def _leave_prompt(self) -> None:
        if self.prompt.asking:
            keys = self.prompt.typed.kind == "keys"
            self.prompt.done()
            (self.board if keys else self.tree_rows).focus()
