"""The inspector in the terminal: its keys, its panes, and what is folded."""

from typing import ClassVar

import numpy as np
from textual import on
from textual.binding import BindingType
from textual.widgets import ContentSwitcher

from executive.inspector.terminal.keys import bindings
from executive.inspector.terminal.overlays import Help
from executive.inspector.terminal.rows import Rows
from executive.inspector.terminal.tabs import TabLine
from executive.inspector.terminal.told import Told
from executive.inspector.terminal.typing_line import Typing


class InspectorApp(Typing):
    """Shows one recording; returns what was wrong with it, if it could not be opened."""

    TITLE = "Cellwright"
    BINDINGS: ClassVar[list[BindingType]] = [*bindings()]

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
