"""The line at the bottom: what there is to say, and where something is typed."""

from dataclasses import dataclass
from typing import ClassVar, Final

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.message import Message
from textual.widgets import Input, Static

LABELS: Final = {
    "filter": ("nodes with", "grasp"),
    "keys": ("keys with", "width"),
    "where": ("ticks where", "width < 3 and status('*grasp*') == RUNNING"),
    "go": ("go to tick", "412, -1, last, or a time such as 41.2s"),
    "break": ("break at", "NODE [on EVENT] [when EXPRESSION]"),
}


class Typed(Input):
    """Where something is typed; keeps what was typed before."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "older(1)", "Older", show=False),
        Binding("down", "older(-1)", "Newer", show=False),
        Binding("escape", "leave", "Leave", show=False),
    ]

    @dataclass
    class Left(Message):
        """The user pressed Escape."""

        kind: str

    def __init__(self, *, id: str) -> None:
        """Begin with nothing typed."""
        super().__init__(id=id, compact=True, select_on_focus=False)
        self.kind = ""
        self._history: dict[str, list[str]] = {}
        self._back = 0

    def begin(self, kind: str, value: str) -> None:
        """Let something be typed anew."""
        self.kind, self._back = kind, 0
        self.value, self.placeholder = value, LABELS[kind][1]
        self.cursor_position = len(value)

    def keep(self, value: str) -> None:
        """Keep what was typed; twice the same is kept once."""
        history = self._history.setdefault(self.kind, [])
        if value in history:
            history.remove(value)
        history.append(value)

    def action_older(self, steps: int) -> None:
        """Show what was typed before, or after that."""
        history = self._history.get(self.kind, [])
        self._back = max(0, min(self._back + steps, len(history)))
        self.value = history[-self._back] if self._back else ""
        self.cursor_position = len(self.value)

    def action_leave(self) -> None:
        """Leave without an answer."""
        self.post_message(self.Left(self.kind))


class Prompt(Horizontal):
    """A note, or a label with something to type, or both when what was typed is wrong."""

    DEFAULT_CSS = """
    Prompt {
        height: auto;
        max-height: 4;
        & > #label {
            display: none; width: auto; padding: 0 1 0 0;
            color: $text-primary; text-style: bold;
        }
        & > #typed { width: 1fr; display: none; height: 1; }
        & > #note { width: 1fr; height: auto; min-height: 1; color: $text-muted; }
        & > #note.-wrong { color: $text-error; }
        &.-asking > #label, &.-asking > #typed { display: block; }
        &.-asking > #note { display: none; }
        &.-asking > #note.-wrong { display: block; }
    }
    """

    def compose(self) -> ComposeResult:
        """Lay out the label, the field and the note."""
        yield Static(id="label", markup=False)
        yield Typed(id="typed")
        yield Static(id="note", markup=False)

    @property
    def typed(self) -> Typed:
        """The field."""
        return self.query_one(Typed)

    @property
    def asking(self) -> bool:
        """Whether something is being typed."""
        return self.has_class("-asking")

    def ask(self, kind: str, value: str = "") -> None:
        """Let something be typed."""
        self.say("")
        self.query_one("#label", Static).update(LABELS[kind][0])
        self.add_class("-asking")
        self.typed.begin(kind, value)
        self.typed.focus()

    def done(self) -> None:
        """Put the field away."""
        self.remove_class("-asking")
        self.say("")

    def say(self, text: str, *, wrong: bool = False) -> None:
        """Show a note in the place of the one before."""
        note = self.query_one("#note", Static)
        note.update(text)
        note.set_class(wrong, "-wrong")

    @property
    def said(self) -> str:
        """The note."""
        return str(self.query_one("#note", Static).content)
