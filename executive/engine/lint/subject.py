"""What the rules look at: one tree with its wiring, and what its nodes may do."""

import dataclasses
from collections.abc import Iterator, Mapping
from functools import cached_property

from executive.core.errors import Fault
from executive.engine.language.document import MissionDocument
from executive.engine.language.outline import NodeSpec
from executive.engine.lint.certain import Certain
from executive.engine.lint.outcomes import Outcomes
from executive.engine.loading.loader import Program
from executive.engine.loading.nodeports import PortTable
from executive.engine.loading.wiring import Wiring, wire

Ancestors = tuple[NodeSpec, ...]


class Subject:
    """One checked tree, as the rules ask about it.

    Attributes:
        program: The tree with the trees that it uses.
        tree: The tree.
        outcomes: How its nodes can end.
    """

    def __init__(
        self,
        program: Program,
        known: "dict[str, Subject] | None" = None,
        goes_on: bool | None = None,
    ) -> None:
        """Look at a program.

        Args:
            program: The tree with the trees that it uses.
            known: Subtrees of it that were looked at before.
            goes_on: Whether its mission goes on when a node raises; as it says itself if None.
        """
        self.program, self.tree = program, program.tree
        if goes_on is None:
            goes_on = self.mission is not None and self.mission.on_error == "fail"
        self.outcomes = Outcomes(program.skills, program.subtrees, goes_on)
        self._inner: dict[str, Subject] = {} if known is None else known

    @cached_property
    def wirings(self) -> Mapping[NodeSpec, Wiring]:
        """What each node reads and writes."""
        ports = PortTable(self.program.skills, self.program.subtrees)
        faults: list[Fault] = []  # a checked tree has none
        return {node: wire(node, ports, faults) for node in self.tree.root.walk()}

    @cached_property
    def certain(self) -> Certain:
        """Which keys its nodes surely write."""
        return Certain(self)

    @cached_property
    def mission(self) -> MissionDocument | None:
        """What the file says, if it is a mission."""
        document = self.tree.document
        return document if isinstance(document, MissionDocument) else None

    def nodes(self) -> Iterator[tuple[NodeSpec, Ancestors]]:
        """Yield the nodes of the tree with what is above them, nearest last."""
        yield from _walk(self.tree.root, ())

    def expanded(self) -> Iterator[tuple[NodeSpec, Ancestors]]:
        """Yield the nodes of the tree and of its subtrees with what is above them.

        A node that uses a subtree stands above the root of that subtree.
        """
        yield from self._expand(self.tree.root, ())

    def _expand(self, node: NodeSpec, above: Ancestors) -> Iterator[tuple[NodeSpec, Ancestors]]:
        yield node, above
        for child in self.outcomes.below(node):
            yield from self._expand(child, (*above, node))

    def inner(self, name: str) -> "Subject | None":
        """Return a subtree as a subject of its own, None where it is not known."""
        tree = self.program.subtrees.get(name)
        if tree is None:
            return None
        if name not in self._inner:
            program = dataclasses.replace(self.program, tree=tree)
            self._inner[name] = Subject(program, self._inner, self.outcomes.goes_on)
        return self._inner[name]

    def written_below(self, node: NodeSpec) -> frozenset[str]:
        """Return the keys of this tree that a node or anything below it may write."""
        return frozenset(
            gives.key for below in node.walk() for gives in self.wirings[below].written
        )

    def reads(self, node: NodeSpec) -> frozenset[str]:
        """Return the keys that a node itself reads or asks about; to unset one is neither."""
        uses = [use.value for use in self.wirings[node].uses if use.at != ("unset",)]
        return frozenset().union(*(value.reads | value.asks for value in uses))


def _walk(node: NodeSpec, above: Ancestors) -> Iterator[tuple[NodeSpec, Ancestors]]:
    yield node, above
    for child in node.children:
        yield from _walk(child, (*above, node))
