"""What happened over time: one lane for the run, one for the selected node, and the playhead."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray
from rich.style import Style
from rich.text import Text
from textual.events import Click, MouseDown, MouseMove, MouseUp, Resize
from textual.message import Message
from textual.strip import Strip
from textual.widget import Widget

from executive.inspector.activity import Activity, Code, Codes

MARKS: Final = {
    Code.NOTHING: (" ", "muted"),
    Code.SUCCESS: ("▂", "success"),
    Code.RUNNING: ("▄", "running"),
    Code.HALTED: ("▒", "halted"),
    Code.FAILURE: ("█", "failure"),
}
"""How each code is drawn: told apart by height, so that no colour is needed."""

_NAME_WIDTH = 12
_LABEL_EVERY = 12


@dataclass(frozen=True, slots=True)
class Span:
    """The ticks that the lanes show, both ends included."""

    first: int
    last: int

    @property
    def count(self) -> int:
        """How many ticks."""
        return self.last - self.first + 1

    def zoomed(self, factor: float, tick: int, end: int) -> "Span":
        """Return a span of another length in which a tick stays where it is.

        Args:
            factor: New length by old length.
            tick: The tick.
            end: The last tick of the run.
        """
        count = max(2, min(round(self.count * factor), end + 1))
        part = (tick - self.first) / max(1, self.count - 1)
        first = max(0, min(round(tick - part * (count - 1)), end + 1 - count))
        return Span(first, max(first + 1, first + count - 1))

    def around(self, tick: int, end: int) -> "Span":
        """Return this span, or one as long that has a tick in the middle if this lacks it."""
        if self.first <= tick <= self.last:
            return self
        first = max(0, min(tick - self.count // 2, end + 1 - self.count))
        return Span(first, first + self.count - 1)

    def column(self, tick: int, width: int) -> int:
        """Return the column in which a tick begins, of so many."""
        return (tick - self.first) * width // self.count

    def tick(self, column: int, width: int) -> int:
        """Return the tick that a column shows."""
        return self.first + max(0, min(column, width - 1)) * self.count // width


class Lanes(Widget):
    """An axis with the playhead, the lane of the run, and that of the selected node.

    The lane of the run shows the leaves that are skills: what the cell did.
    """

    COMPONENT_CLASSES: ClassVar[set[str]] = {
        *(f"lanes--{look}" for _, look in MARKS.values()),
        "lanes--head",
    }
    DEFAULT_CSS = """
    Lanes {
        height: 3;
        & > .lanes--success { color: $success; }
        & > .lanes--failure { color: $error; }
        & > .lanes--running { color: $warning; }
        & > .lanes--halted { color: $accent; }
        & > .lanes--muted { text-style: dim; }
        & > .lanes--head { color: $text-primary; text-style: bold; }
    }
    """

    @dataclass
    class Scrubbed(Message):
        """The user pointed at a tick."""

        tick: int

    def __init__(self, *, id: str) -> None:
        """Begin without ticks."""
        super().__init__(id=id)
        self.span = Span(0, 1)
        self._activity: Activity | None = None
        self._skills: NDArray[np.intp] = np.zeros(0, np.intp)
        self._tick, self._node, self._title = 0, 0, ""
        self._found: NDArray[np.intp] = np.zeros(0, np.intp)
        self._codes: Codes | None = None
        self._held = False

    def set_run(self, activity: Activity, skills: Sequence[int]) -> None:
        """Show another run, of which some nodes are skills."""
        self._activity, self._skills = activity, np.array(skills, np.intp)
        self.renew()

    def set_place(self, tick: int, node: int, name: str) -> None:
        """Put the playhead on a tick, and show the lane of a node."""
        self._tick, self._node, self._title = tick, node, name
        self.refresh()

    def set_found(self, ticks: Sequence[int]) -> None:
        """Mark ticks that a search has found."""
        self._found = np.array(ticks, np.intp)
        self.refresh()

    def set_span(self, span: Span) -> None:
        """Show other ticks."""
        if span != self.span:
            self.span = span
            self.renew()

    def renew(self) -> None:
        """Cut the lanes anew: there is more of the run, or another part is shown."""
        self._codes = None
        self.refresh()

    @property
    def width(self) -> int:
        """Columns of a lane."""
        return max(1, self.size.width - _NAME_WIDTH)

    def render_line(self, y: int) -> Strip:
        """Return the axis, the lane of the run, or that of the node."""
        text = (self._axis, self._run_lane, self._node_lane)[y]() if y < 3 else Text()
        strip = Strip(text.render(self.app.console), text.cell_len)
        return strip.crop_extend(0, self.size.width, self.rich_style).apply_style(self.rich_style)

    def _axis(self) -> Text:
        cells = [" "] * (_NAME_WIDTH + self.width)
        for tick in self._labels():
            at = _NAME_WIDTH + self.span.column(tick, self.width)
            label = f"╵{tick}"
            cells[at : at + len(label)] = label
        inside = (self._found >= self.span.first) & (self._found <= self.span.last)
        for column in np.unique((self._found[inside] - self.span.first) * self.width):
            cells[_NAME_WIDTH + int(column) // self.span.count] = "•"
        head = min(_NAME_WIDTH + self._head(), len(cells) - 1)
        text = Text.assemble(("".join(cells[:head]), self._look("muted")), end="")
        text.append("▼", self._look("head"))
        return text.append("".join(cells[head + 1 :]), self._look("muted"))

    def _labels(self) -> range:
        least = self.span.count * _LABEL_EVERY / self.width
        steps = (digit * 10**power for power in range(9) for digit in (1, 2, 5))
        step = next(step for step in steps if step >= least)
        return range(-(-self.span.first // step) * step, self.span.last + 1, step)

    def _head(self) -> int:
        """Return the column of the playhead: the middle of its tick."""
        begin = self.span.column(self._tick, self.width)
        end = self.span.column(self._tick + 1, self.width)
        return max(0, min((begin + max(begin, end - 1)) // 2, self.width - 1))

    def _run_lane(self) -> Text:
        codes = self._cut()
        together = codes[self._skills].max(axis=0) if len(self._skills) else codes[0]
        return self._lane("run", together)

    def _node_lane(self) -> Text:
        codes = self._cut()
        return self._lane(self._title, codes[self._node] if self._node < len(codes) else codes[0])

    def _lane(self, name: str, codes: NDArray[np.uint8]) -> Text:
        label = name if len(name) < _NAME_WIDTH else f"{name[: _NAME_WIDTH - 2]}…"
        text = Text.assemble((label.ljust(_NAME_WIDTH), self._look("muted")), end="")
        if not codes.size:
            return text
        known = min(self.width, self.span.column(len(self._activity or ()), self.width))
        places = np.arange(known) * len(codes) // max(1, known)
        shown = codes[places]
        edges = [0, *(np.flatnonzero(np.diff(shown)) + 1).tolist(), known] if known else []
        for begin, end in pairwise(edges):
            mark, look = MARKS[Code(int(shown[begin]))]
            text.append(mark * (end - begin), self._look(look))
        return text

    def _cut(self) -> Codes:
        """Return the codes of what is shown; cut only when that has changed."""
        if self._activity is None:
            return np.zeros((1, 0), np.uint8)
        if self._codes is None:
            self._codes = self._activity.lanes(self.span.first, self.span.last, self.width)
        return self._codes

    def _look(self, name: str) -> Style:
        return self.get_component_rich_style(f"lanes--{name}", partial=True)

    def on_resize(self, _: Resize) -> None:
        """Cut the lanes to the new width."""
        self.renew()

    def on_mouse_down(self, event: MouseDown) -> None:
        """Begin to scrub."""
        self._held = True
        self.capture_mouse()
        self._point(event.x)

    def on_mouse_move(self, event: MouseMove) -> None:
        """Scrub."""
        if self._held:
            self._point(event.x)

    def on_mouse_up(self, _: MouseUp) -> None:
        """End scrubbing."""
        self._held = False
        self.release_mouse()

    def on_click(self, event: Click) -> None:
        """Take a click for the lanes alone."""
        event.stop()

    def _point(self, x: int) -> None:
        self.post_message(self.Scrubbed(self.span.tick(x - _NAME_WIDTH, self.width)))
