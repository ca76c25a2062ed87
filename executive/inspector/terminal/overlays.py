"""What is laid over the inspector: the help, and the question before an emergency stop."""

from typing import ClassVar

from rich.table import Table
from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

from executive.inspector.terminal.keys import GROUPS, LEGEND


class Help(ModalScreen[None]):
    """All keys, and what the marks mean."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,q,question_mark", "dismiss", "Close", show=False)
    ]
    DEFAULT_CSS = """
    Help {
        align: center middle;
        & > VerticalScroll {
            width: 78; height: auto; max-height: 100%; padding: 0 1; background: $panel;
        }
    }
    """

    def compose(self) -> ComposeResult:
        """Lay out the list of keys."""
        with VerticalScroll():
            yield Static(_keys())

    def on_click(self) -> None:
        """Close."""
        self.dismiss()


def _keys() -> Table:
    table = Table(box=None, show_header=False, padding=(0, 1, 0, 0), expand=True)
    table.add_column(no_wrap=True, style="bold")
    table.add_column()
    for title, keys in GROUPS.items():
        table.add_row("", Text(title, "bold underline"))
        for key in keys:
            table.add_row(key.shown, key.told)
    table.add_row("", Text("Marks", "bold underline"))
    for line in LEGEND:
        table.add_row("", line)
    return table


class Sure(ModalScreen[bool]):
    """Asks once; only `y` says yes."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("y", "answer(True)", "Yes", show=False),
        Binding("n,escape,q", "answer(False)", "No", show=False),
    ]
    DEFAULT_CSS = """
    Sure {
        align: center middle;
        & > Static {
            width: auto; height: auto; padding: 1 3;
            background: $error; color: $text; text-style: bold;
        }
    }
    """

    def __init__(self, question: str) -> None:
        """Ask a question."""
        super().__init__()
        self._question = question

    def compose(self) -> ComposeResult:
        """Lay out the question."""
        yield Static(f"{self._question}  y / n", markup=False)

    def action_answer(self, yes: bool) -> None:
        """Close with the answer."""
        self.dismiss(yes)
