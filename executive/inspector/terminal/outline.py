"""Which nodes of a tree are shown: folded ones hide what is below them, a filter picks some."""

from collections.abc import Sequence

from executive.engine.recording.messages import RecordedNode


class Outline:
    """The nodes of a run as an outline.

    Attributes:
        nodes: Node table.
        children: Indices of the children of each node.
        depths: How deep each node is; 0 for the root.
        folded: Nodes whose children are hidden.
        words: What the filter asks for, in lower case; empty for everything.
        shown: Indices of the nodes that are shown, in order.
    """

    def __init__(self, nodes: Sequence[RecordedNode]) -> None:
        """Begin with every node shown."""
        self.nodes = nodes
        self.children: list[list[int]] = [[] for _ in nodes]
        self.depths: list[int] = []
        for index, node in enumerate(nodes):
            self.depths.append(0 if node.parent is None else self.depths[node.parent] + 1)
            if node.parent is not None:
                self.children[node.parent].append(index)
        self.folded: set[int] = set()
        self.words = ""
        self.shown = list(range(len(nodes)))

    def toggle(self, node: int) -> None:
        """Fold or unfold a node that has children."""
        if self.children[node]:
            self.folded ^= {node}
            self._show()

    def fold(self, nodes: set[int]) -> None:
        """Fold these nodes and no others; what has no children stays as it is."""
        self.folded = {node for node in nodes if self.children[node]}
        self._show()

    def filter(self, words: str) -> None:
        """Show only nodes with these words in their path or type, and the way down to each."""
        self.words = words.strip().lower()
        self._show()

    def reveal(self, node: int) -> None:
        """Let a node be shown: unfold what is above it, and drop a filter that hides it."""
        above = self.nodes[node].parent
        while above is not None:
            self.folded.discard(above)
            above = self.nodes[above].parent
        if node not in self.shown:
            self._show()
        if node not in self.shown:
            self.filter("")

    def is_hit(self, node: int) -> bool:
        """Return whether a filter is set and asks for a node."""
        named = f"{self.nodes[node].path} {self.nodes[node].type}".lower()
        return bool(self.words) and self.words in named

    def nearest_shown(self, node: int) -> int:
        """Return the place of a node among the shown ones, or that of what hides it."""
        places = {shown: place for place, shown in enumerate(self.shown)}
        at: int | None = node
        while at is not None and at not in places:
            at = self.nodes[at].parent
        return 0 if at is None else places[at]

    def _show(self) -> None:
        kept = [not self.words or self.is_hit(index) for index in range(len(self.nodes))]
        for index in range(len(self.nodes) - 1, 0, -1):
            parent = self.nodes[index].parent
            if kept[index] and parent is not None:
                kept[parent] = True
        hidden = [False] * len(self.nodes)
        for index, node in enumerate(self.nodes):
            if node.parent is not None:
                folded = not self.words and node.parent in self.folded
                hidden[index] = hidden[node.parent] or folded
        self.shown = [i for i in range(len(self.nodes)) if kept[i] and not hidden[i]]
