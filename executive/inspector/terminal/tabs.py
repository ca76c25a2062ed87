"""One line of tabs."""

from dataclasses import dataclass
from typing import ClassVar

from rich.text import Text
from textual.events import Click
from textual.message import Message
from textual.widget import Widget


class TabLine(Widget):
    """Names side by side, with a number each; a click chooses one."""

    COMPONENT_CLASSES: ClassVar[set[str]] = {"tabs--chosen", "tabs--other"}
    DEFAULT_CSS = """
    TabLine {
        height: 1;
        background: $panel;
        & > .tabs--chosen {
            color: $block-cursor-foreground; background: $block-cursor-background;
            text-style: bold;
        }
        & > .tabs--other { text-style: dim; }
    }
    """

    @dataclass
    class Picked(Message):
        """The user clicked a tab."""

        name: str

    def __init__(self, *, id: str) -> None:
        """Begin without tabs."""
        super().__init__(id=id)
        self._tabs: list[tuple[int, str, str]] = []
        self._chosen = ""

    def set_tabs(self, tabs: list[tuple[int, str, str]], chosen: str) -> None:
        """Show tabs, each with its number, name and title."""
        self._tabs, self._chosen = tabs, chosen
        self.refresh()

    def render(self) -> Text:
        """Return the line; the chosen tab is in brackets, so that no colour is needed."""
        text = Text(no_wrap=True, end="")
        for number, name, title in self._tabs:
            chosen = name == self._chosen
            look = self.get_component_rich_style(f"tabs--{'chosen' if chosen else 'other'}")
            text.append(f"[{number} {title}]" if chosen else f" {number} {title} ", look)
        return text

    def on_click(self, event: Click) -> None:
        """Choose the tab that is clicked."""
        left = 0
        for number, name, title in self._tabs:
            left += len(f" {number} {title} ")
            if event.x < left:
                self.post_message(self.Picked(name))
                return
