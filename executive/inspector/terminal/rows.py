"""Rows of text of which one is chosen: every pane of the inspector is made of them.

Only rows that can be seen are drawn, so a tree of hundreds of nodes costs no more than the
part of it that fits on the screen.
"""

from dataclasses import dataclass
from typing import ClassVar

from rich.style import Style
from rich.text import Text
from textual.binding import Binding, BindingType
from textual.events import Click
from textual.geometry import Size
from textual.message import Message
from textual.scroll_view import ScrollView
from textual.strip import Strip

from executive.engine.ticks import NodeStatus

LOOKS = ("success", "failure", "running", "halted", "muted", "strong", "name")
STATUS_LOOKS = {
    NodeStatus.SUCCESS: "success",
    NodeStatus.FAILURE: "failure",
    NodeStatus.RUNNING: "running",
    NodeStatus.INVALID: "muted",
}
_GUTTER, _HERE = "  ", "▌ "


class Rows(ScrollView, can_focus=True, inherit_bindings=False):
    """Rows of which one is under the cursor.

    Attributes:
        cursor: Place of that row.
    """

    COMPONENT_CLASSES: ClassVar[set[str]] = {"rows--cursor", *(f"rows--{look}" for look in LOOKS)}
    DEFAULT_CSS = """
    Rows {
        height: 1fr;
        overflow-x: hidden;
        scrollbar-size: 1 1;
        & > .rows--success { color: $text-success; }
        & > .rows--failure { color: $text-error; text-style: bold; }
        & > .rows--running { color: $text-warning; }
        & > .rows--halted { color: $text-accent; }
        & > .rows--muted { text-style: dim; }
        & > .rows--strong { text-style: bold; }
        & > .rows--name { color: $text-primary; }
        & > .rows--cursor { background: $panel; }
        &:focus > .rows--cursor { background: $primary-muted; }
    }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "move(-1)", "Up", show=False),
        Binding("down", "move(1)", "Down", show=False),
        Binding("pageup", "page(-1)", "Page up", show=False),
        Binding("pagedown", "page(1)", "Page down", show=False),
        Binding("enter", "choose", "Choose", show=False),
    ]

    @dataclass
    class Moved(Message):
        """The user moved the cursor."""

        rows: "Rows"

        @property
        def control(self) -> "Rows":
            """The rows."""
            return self.rows

    @dataclass
    class Chosen(Message):
        """The user pressed Enter on a row, or clicked it twice."""

        rows: "Rows"

        @property
        def control(self) -> "Rows":
            """The rows."""
            return self.rows

    def __init__(self, *, id: str) -> None:
        """Begin without rows."""
        super().__init__(id=id)
        self.cursor = 0

    @property
    def count(self) -> int:
        """Number of rows."""
        raise NotImplementedError

    def row(self, index: int) -> Text:
        """Return one row."""
        raise NotImplementedError

    @property
    def room(self) -> int:
        """Columns that a row may have."""
        return self.scrollable_content_region.width

    def changed(self, *, width: int = 0) -> None:
        """Draw anew after rows have changed.

        Args:
            width: Of the widest row, where rows may be scrolled sideways.
        """
        self.cursor = max(0, min(self.cursor, self.count - 1))
        size = Size(width + len(_GUTTER) if width else 0, self.count)
        if size != self.virtual_size:
            self.virtual_size = size
        self.refresh()

    def put_cursor(self, index: int) -> None:
        """Put the cursor on a row and let it be seen."""
        self.cursor = max(0, min(index, self.count - 1))
        self.see(self.cursor)
        self.refresh()

    def see(self, index: int, *, centred: bool = False) -> None:
        """Scroll as far as is needed to see a row."""
        top, height = self.scroll_offset.y, max(self.size.height, 1)
        if top <= index < top + height:
            return
        wanted = index - height // 2 if centred else index if index < top else index - height + 1
        self.scroll_to(y=max(0, wanted), animate=False)

    def look(self, name: str) -> Style:
        """Return the style of one of `LOOKS`, as the theme has it."""
        return self.get_component_rich_style(f"rows--{name}", partial=True)

    def render_line(self, y: int) -> Strip:
        """Return one line of what can be seen."""
        index = self.scroll_offset.y + y
        style, width, left = self.rich_style, self.room, self.scroll_offset.x
        if not 0 <= index < self.count:
            return Strip.blank(width, style)
        here = index == self.cursor
        text = Text.assemble(_HERE if here else _GUTTER, self.row(index), end="")
        if here:
            style += self.get_component_rich_style("rows--cursor", partial=True)
        strip = Strip(text.render(self.app.console), text.cell_len)
        return strip.crop_extend(left, left + width, style).apply_style(style)

    def action_move(self, step: int) -> None:
        """Move the cursor by some rows."""
        self._go(self.cursor + step)

    def action_page(self, pages: int) -> None:
        """Move the cursor by some screens."""
        self._go(self.cursor + pages * max(1, self.size.height - 1))

    def action_choose(self) -> None:
        """Choose the row under the cursor."""
        if self.count:
            self.post_message(self.Chosen(self))

    def on_click(self, event: Click) -> None:
        """Put the cursor on the row that is clicked; a second click chooses it."""
        offset = event.get_content_offset(self)
        if offset is None or self.scroll_offset.y + offset.y >= self.count:
            return
        self._go(self.scroll_offset.y + offset.y)
        self.clicked(offset.x + self.scroll_offset.x - len(_GUTTER))
        if event.chain == 2:
            self.action_choose()

    def clicked(self, column: int) -> None:
        """Take a click on the row under the cursor, at a column of its text."""

    def _go(self, index: int) -> None:
        self.put_cursor(index)
        self.post_message(self.Moved(self))
