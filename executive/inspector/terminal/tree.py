"""The tree with the status of every node."""

from collections.abc import Mapping, Sequence

from rich.text import Text

from executive.core.outcome import Reason
from executive.engine.recording.messages import RecordedNode
from executive.engine.ticks import NodeStatus
from executive.inspector.terminal.outline import Outline
from executive.inspector.terminal.rows import STATUS_LOOKS, Rows
from executive.inspector.views import ICONS

_INDENT = 2


class TreeRows(Rows):
    """One row for each node that is shown; the selected node is the one under the cursor.

    Attributes:
        outline: Which nodes are shown.
    """

    def __init__(self, *, id: str) -> None:
        """Begin without nodes."""
        super().__init__(id=id)
        self.outline = Outline(())
        self._statuses: Sequence[NodeStatus] = ()
        self._visited: frozenset[int] = frozenset()
        self._reasons: Mapping[int, Reason] = {}

    def set_nodes(self, nodes: Sequence[RecordedNode]) -> None:
        """Show another tree."""
        self.outline = Outline(nodes)
        self.changed()

    def set_tick(
        self,
        statuses: Sequence[NodeStatus],
        visited: frozenset[int],
        reasons: Mapping[int, Reason],
    ) -> None:
        """Show statuses; nodes that were not visited are dim."""
        self._statuses, self._visited, self._reasons = statuses, visited, reasons
        self.refresh()

    @property
    def selected(self) -> int:
        """Index of the selected node."""
        return self.outline.shown[self.cursor] if self.outline.shown else 0

    def select(self, node: int) -> None:
        """Select a node, and let it be seen."""
        self.outline.reveal(node)
        self.changed()
        self.put_cursor(self.outline.nearest_shown(node))

    def refold(self, node: int) -> None:
        """Show what the outline says now, with a node selected or what hides it."""
        self.changed()
        self.put_cursor(self.outline.nearest_shown(node))

    @property
    def count(self) -> int:
        """Number of nodes that are shown."""
        return len(self.outline.shown)

    def row(self, index: int) -> Text:
        """Return one node."""
        outline = self.outline
        at = outline.shown[index]
        node = outline.nodes[at]
        status = self._statuses[at] if at < len(self._statuses) else NodeStatus.INVALID
        mark = self.look(STATUS_LOOKS[status])
        visited = at in self._visited
        text = Text(" " * (_INDENT * outline.depths[at]))
        text.append(self._twist(at), self.look("muted"))
        text.append(f"{ICONS[status][0]} ", mark)
        name = self.look("strong") if visited else self.look("muted")
        text.append(node.name, name + self.look("name") if outline.is_hit(at) else name)
        if node.type not in (node.name, ""):
            text.append(f" {node.type}", self.look("muted"))
        if status is NodeStatus.FAILURE and at in self._reasons:
            text.append(f"  {self._reasons[at]}", mark)
        return text

    def _twist(self, node: int) -> str:
        if not self.outline.children[node]:
            return "  "
        return "▸ " if node in self.outline.folded and not self.outline.words else "▾ "

    def clicked(self, column: int) -> None:
        """Fold or unfold where the small triangle is clicked."""
        start = _INDENT * self.outline.depths[self.selected]
        if start <= column < start + 2:
            self.action_choose()
