"""Lines of text that lead somewhere: to a node, a tick, a key, or to something to be done."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich.style import Style
from rich.text import Text
from textual.events import Resize

from executive.inspector.terminal.rows import Rows

_CONTINUED = 2


@dataclass(frozen=True, slots=True)
class Line:
    """One line.

    Attributes:
        text: What it says; words in it may have the look of a status.
        look: Look of the whole line; empty for none.
        parts: Text and look of each part, where a line has more than one look.
        node: Node that Enter selects; None for none.
        tick: Tick that Enter goes to; None for none.
        key: Key that Enter selects; empty for none.
        act: Action of the application that Enter takes; empty for none.
    """

    text: str = ""
    look: str = ""
    parts: tuple[tuple[str, str], ...] = ()
    node: int | None = None
    tick: int | None = None
    key: str = ""
    act: str = ""

    @property
    def leads(self) -> bool:
        """Whether Enter does anything."""
        return bool(self.act or self.key) or (self.node, self.tick) != (None, None)


class Told(Rows):
    """Lines, folded at the width of the pane; Enter goes where one leads."""

    def __init__(self, *, id: str, fold: bool = True) -> None:
        """Begin without lines.

        Args:
            id: Of the widget.
            fold: Whether long lines are folded; they are scrolled sideways otherwise.
        """
        super().__init__(id=id)
        self._fold = fold
        self._lines: Sequence[Line] = ()
        self._rows: list[tuple[Text, Line]] = []
        if not fold:
            self.styles.overflow_x = "auto"

    def tell(self, lines: Sequence[Line], *, cursor: int | None = None) -> None:
        """Show lines.

        Args:
            lines: The lines.
            cursor: The line that the cursor is put on; it stays where it is without.
        """
        self._lines = lines
        self._break()
        if cursor is not None:
            place = next((i for i, (_, at) in enumerate(self._rows) if at is lines[cursor]), 0)
            self.see(place, centred=True)
            self.put_cursor(place)

    @property
    def lines(self) -> Sequence[Line]:
        """The lines."""
        return self._lines

    @property
    def here(self) -> Line | None:
        """The line under the cursor."""
        return self._rows[self.cursor][1] if self._rows else None

    @property
    def count(self) -> int:
        """Number of lines, folded ones counted as often as they are folded."""
        return len(self._rows)

    def row(self, index: int) -> Text:
        """Return one line, or a part of one that is folded."""
        return self._rows[index][0]

    def on_resize(self, _: Resize) -> None:
        """Fold at the new width."""
        self._break()

    def _break(self) -> None:
        width = self.room - 2
        self._rows = []
        widest = 0
        for line in self._lines:
            text = self._text(line)
            widest = max(widest, text.cell_len)
            if not self._fold or text.cell_len <= width or width < 2 * _CONTINUED:
                self._rows.append((text, line))
                continue
            first, *rest = self._folded(text, width)
            self._rows.append((first, line))
            self._rows += [(Text(" " * _CONTINUED).append_text(part), line) for part in rest]
        self.changed(width=0 if self._fold else widest)

    def _folded(self, text: Text, width: int) -> list[Text]:
        parts = text.wrap(self.app.console, width - _CONTINUED, no_wrap=False)
        return [part for part in parts if part.plain.strip()] or [text]

    def _text(self, line: Line) -> Text:
        if not line.parts:
            return Text(line.text, self._styled(line.look))
        return Text.assemble(*((text, self._styled(look)) for text, look in line.parts))

    def _styled(self, look: str) -> Style:
        return self.look(look) if look else Style.null()
