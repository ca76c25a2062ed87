"""The inspector in the terminal: puts the panes together and moves through the ticks."""

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar, cast

import numpy as np
from textual import on, work
from textual.app import App, ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.events import Resize
from textual.timer import Timer
from textual.widgets import ContentSwitcher, Footer, Input
from textual.worker import get_current_worker

from executive.core.errors import CellwrightError, InputError
from executive.engine.recording.reader import Recording
from executive.engine.remote import send
from executive.inspector.report import mission_report
from executive.inspector.report_text import report_text
from executive.inspector.search import search
from executive.inspector.terminal import pages
from executive.inspector.terminal.bar import Bar
from executive.inspector.terminal.board import BoardRows
from executive.inspector.terminal.keys import LIVE_ACTIONS, TABS, TITLES, bindings
from executive.inspector.terminal.lanes import Lanes, Span
from executive.inspector.terminal.opened import OpenedRun
from executive.inspector.terminal.overlays import Help, Sure
from executive.inspector.terminal.prompt import Prompt, Typed
from executive.inspector.terminal.rows import Rows
from executive.inspector.terminal.tabs import TabLine
from executive.inspector.terminal.told import Line, Told
from executive.inspector.terminal.tree import TreeRows
from executive.inspector.web.finding import Wish, found

Start = Callable[[Recording], tuple[int | None, int]]
"""Returns the tick (None for the last) and the node to begin with, or raises `InputError`."""

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 16.0, 64.0)
_FRAME_S, _POLL_S, _SETTLE_S = 0.05, 0.2, 0.04
_ASKS_A_QUESTION = frozenset({"key", "why", "report"})
_NOTHING = "nothing further that way"


class InspectorApp(App[str]):
    """Shows one recording; returns what was wrong with it, if it could not be opened.

    Attributes:
        tick: Number of the tick that is shown.
        node: Index of the selected node.
        key: The selected key of the blackboard, empty for none.
    """

    ENABLE_COMMAND_PALETTE = False
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-wide")]  # noqa: RUF012 - as the base has it
    BINDINGS: ClassVar[list[BindingType]] = [*bindings()]
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
        self._speed = SPEEDS.index(1.0)
        self._playing: Timer | None = None
        self._begun: tuple[float, int] = (0.0, 0)
        self._settling: Timer | None = None
        self._where, self._matches = "", list[int]()

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
    def is_wide(self) -> bool:
        """Whether there is room for the blackboard beside the other panes."""
        return self.screen_stack[0].has_class("-wide")

    def note(self, text: str, *, wrong: bool = False) -> None:
        """Say something in the line at the bottom."""
        self.prompt.say(text, wrong=wrong)

    # Opening, and following while the run goes on: in a thread of its own.

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

    # Showing.

    def show(self) -> None:
        """Show the tick that is chosen, in every pane."""
        opened = self._opened
        if opened is None:
            return
        speed = f"play x{SPEEDS[self._speed]:g}" if self._playing else ""
        self.query_one(Bar).show(opened, self._state, self.tick, speed)
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

    # Moving.

    def go(self, tick: int) -> None:
        """Show a tick, or the nearest there is."""
        opened = self._opened
        if opened is None:
            return
        self.tick = max(0, min(tick, opened.last))
        self._following = not opened.ended and self.tick == opened.last
        self.lanes.set_span(self.lanes.span.around(self.tick, max(1, opened.last)))
        self.show()

    def select(self, node: int) -> None:
        """Select a node."""
        self.node = node
        self.tree_rows.select(node)
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

    # Finding: in a thread, because the index of a live run may have to be made anew.

    def action_seek(self, kind: str, direction: int) -> None:
        """Go to the next tick, or the one before, in which something happened."""
        opened = self._opened
        if opened is None:
            return
        if kind == "where" and not self._where:
            self.action_ask("where")
            return
        path = opened.recording.header.nodes[self.node].path
        self.note("searching …")
        wish = Wish(kind, self.tick, direction > 0, node=path, key=self.key, where=self._where)
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

    # What is typed.

    def action_ask(self, kind: str) -> None:
        """Let something be typed."""
        opened = self._opened
        if opened is None or (kind == "break" and not self._live):
            return
        if kind == "filter" and self.focused is self.board:
            kind = "keys"
        path = opened.recording.header.nodes[self.node].path
        known = {"filter": self.tree_rows.outline.words, "where": self._where, "break": path}
        self.prompt.ask(kind, known.get(kind, ""))

    @on(Input.Changed, "#typed")
    def _type(self, event: Input.Changed) -> None:
        if not self.prompt.asking:
            return
        if self.prompt.typed.kind == "filter":
            self.tree_rows.outline.filter(event.value)
            self.tree_rows.refold(self.node)
        elif self.prompt.typed.kind == "keys":
            self.board.filter(event.value)

    @on(Input.Submitted, "#typed")
    def _take_typed(self, event: Input.Submitted) -> None:
        typed, value, opened = self.prompt.typed, event.value.strip(), self._opened
        if opened is None:
            return
        if value:
            typed.keep(value)
        if typed.kind in ("filter", "keys") or not value:
            self._leave_prompt()
            self._take_selected()
        elif typed.kind == "where":
            self._seek(opened, Wish("where", self.tick, where=value))
        elif typed.kind == "go":
            self._go_to(opened, value)
        elif typed.kind == "break":
            self.command("break", text=value)

    @work(thread=True, exclusive=True, group="seek")
    def _go_to(self, opened: OpenedRun, text: str) -> None:
        try:
            tick = opened.past().names.tick(text)
        except InputError as error:
            self.call_later(self._refuse, str(error))
            return
        self.call_later(self._leave_prompt)
        self.call_later(self.go, tick)

    @on(Typed.Left)
    def _leave_typed(self, message: Typed.Left) -> None:
        if message.kind == "filter":
            self.tree_rows.outline.filter("")
            self.tree_rows.refold(self.node)
        elif message.kind == "keys":
            self.board.filter("")
        self._leave_prompt()

    def _leave_prompt(self) -> None:
        if self.prompt.asking:
            keys = self.prompt.typed.kind == "keys"
            self.prompt.done()
            (self.board if keys else self.tree_rows).focus()

    # Panes.

    @on(Rows.Moved, "#tree")
    def _take_selected(self) -> None:
        self.node = self.tree_rows.selected
        self._show_lane()
        self._show_page()

    @on(Rows.Moved, "#board")
    def _take_key(self) -> None:
        self.key = self.board.selected
        self._show_page()

    @on(Rows.Chosen, "#tree")
    def _fold(self) -> None:
        self.tree_rows.outline.toggle(self.tree_rows.selected)
        self.tree_rows.refold(self.tree_rows.selected)

    @on(Rows.Chosen, "#board")
    def _open_key(self) -> None:
        self.key = self.board.selected
        self.action_tab("key")

    @on(Rows.Chosen)
    def _lead(self, message: Rows.Chosen) -> None:
        line = message.rows.here if isinstance(message.rows, Told) else None
        if line is None or not line.leads:
            return
        if line.act:
            self.run_worker(self.run_action(line.act))
            return
        if line.key:
            self.key = line.key
            self.board.select(line.key)
            self.action_tab("key")
        if line.node is not None:
            self.node = line.node
            self.tree_rows.select(line.node)
        self.go(self.tick if line.tick is None else line.tick)

    @on(TabLine.Picked)
    def _pick(self, message: TabLine.Picked) -> None:
        self.action_tab(message.name)

    def action_tab(self, name: str) -> None:
        """Show a pane; go into it when it is shown already."""
        body = self.query_one("#body")
        if name == "board":
            shown = self.is_wide or body.has_class("-board")
            body.add_class("-board")
        else:
            shown = self._tab == name and (self.is_wide or not body.has_class("-board"))
            body.remove_class("-board")
            self._tab = name
            self.query_one("#pages", ContentSwitcher).current = name
        if shown or (self.focused is not None and not self.focused.display):
            self.query_one(f"#{name}").focus()
        self._show_tabs()
        self._show_page()

    def action_fold_idle(self) -> None:
        """Fold what never ran; unfold all when something is folded."""
        opened, outline = self._opened, self.tree_rows.outline
        if opened is None:
            return
        idle: set[int] = set()
        if not outline.folded:
            ran = opened.activity.lanes(0, opened.last, 1)[:, 0] > 0
            for node in range(len(ran) - 1, 0, -1):
                ran[outline.nodes[node].parent] |= ran[node]
            idle = set(np.flatnonzero(~ran).tolist())
        outline.fold(idle)
        self.tree_rows.refold(self.node)
        self._take_selected()

    def action_zoom_pane(self) -> None:
        """Give the pane with the focus all the room, or share it again."""
        body = self.query_one("#body")
        full = self.query(".-full")
        if full:
            full.remove_class("-full")
            body.remove_class("-zoomed")
            return
        pane = self.focused if self.focused in body.children else self.query_one("#pages")
        if pane is not None:
            pane.add_class("-full")
            body.add_class("-zoomed")

    def action_theme(self) -> None:
        """Change between dark and light."""
        self.theme = "textual-light" if self.current_theme.dark else "textual-dark"

    def action_help(self) -> None:
        """Show all keys."""
        self.push_screen(Help())

    # Commands to a live run.

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer what commands a live run only while there is one."""
        breaks = action == "ask" and parameters == ("break",)
        return self._live if action in LIVE_ACTIONS or breaks else True

    @work(thread=True, group="command")
    def command(self, name: str, **arguments: object) -> None:
        """Send a command to the live run."""
        try:
            state = send(self._path, name, by="terminal", **arguments)
        except InputError as error:
            self.call_later(self._refuse, str(error))
            return
        self.call_later(self._commanded, state)

    def _commanded(self, state: Mapping[str, Any]) -> None:
        self.note("")
        self._leave_prompt()
        self._take_progress(more=False, state=state)

    def action_pause_or_resume(self) -> None:
        """Pause the mission, or let it go on."""
        self.command("resume" if self._state and self._state["paused"] else "pause")

    def action_step(self, step: str) -> None:
        """Go on by a tick or a node."""
        self._following = True
        self.command("step", step=step)

    def action_stop(self) -> None:
        """Stop the mission in order."""
        self.command("stop")

    def action_emergency_stop(self) -> None:
        """Stop the arms at once, if the user is sure."""

        def answered(sure: bool | None) -> None:
            if sure:
                self.command("emergency_stop")

        self.push_screen(Sure("Stop the arms now?"), answered)

    def action_force(self, answer: str) -> None:
        """Let the selected node answer something else."""
        if self._opened is not None:
            path = self._opened.recording.header.nodes[self.node].path
            self.command("force", nodes=path, answer=answer)

    def action_unforce(self, nodes: str) -> None:
        """Let a node answer for itself again."""
        self.command("unforce", nodes=nodes)

    def action_unbreak(self, number: int) -> None:
        """Remove a breakpoint."""
        self.command("unbreak", number=number)
