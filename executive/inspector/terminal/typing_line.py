"""What the user types: filters, expressions, ticks, breakpoints."""

from textual import on, work
from textual.widgets import Input

from executive.core.errors import InputError
from executive.inspector.finding import Wish
from executive.inspector.terminal.commanding import Commanding
from executive.inspector.terminal.opened import OpenedRun
from executive.inspector.terminal.prompt import Typed


class Typing(Commanding):
    """A view of a run that is told by words what to show."""

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
