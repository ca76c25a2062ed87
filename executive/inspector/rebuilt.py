"""The trees of a recording as they were written, out of the sources in its header.

No skill is needed for it: only the documents, what stands where, and which key a name means.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from executive.core.errors import InputError
from executive.core.skill import REQUIRED
from executive.engine.blackboard import Blackboard
from executive.engine.language.block_models import ForEachBody
from executive.engine.language.document import MissionDocument, TreeDocument
from executive.engine.language.expression import Expression, parse_expression
from executive.engine.language.node_models import SetNode, SkillNode, SubtreeNode, WhenNode
from executive.engine.language.outline import NodeSpec, outline
from executive.engine.language.scope import Scope
from executive.engine.language.sources import read_source
from executive.engine.language.values import Literal, Value, parse_value
from executive.engine.loading.validation import validate
from executive.engine.recording.messages import MissionHeader

_MAX_DEPTH = 300


@dataclass(frozen=True, slots=True, eq=False)
class PastScope:
    """The names that the nodes of one tree saw.

    Attributes:
        scope: Their values at the moment that the blackboard is at.
        wired: What inputs were wired to, and the names outside that this is about.
    """

    scope: Scope
    wired: Mapping[str, tuple[Value, "PastScope"]]

    def keys(self, name: str) -> frozenset[str]:
        """Return the keys of the blackboard that a name comes from."""
        if name not in self.wired:
            return frozenset((self.scope.key(name),))
        value, outer = self.wired[name]
        reads = value.reads if isinstance(value, Expression) else frozenset()
        return frozenset(key for read in reads for key in outer.keys(read))


@dataclass(frozen=True, slots=True, eq=False)
class WrittenNode:
    """One node as it was written.

    Attributes:
        spec: What its file says; for the guard around a node, what it says about that node.
        names: What its expressions see.
        is_guard: Whether it is the guard around the node that `spec` is about.
    """

    spec: NodeSpec
    names: PastScope
    is_guard: bool

    def conditions(self) -> dict[str, Expression]:
        """Return what it asks, by keyword: `when`, or `if`, `unless` and `while` of a guard."""
        if self.is_guard:
            return {kind: parse_expression(text) for kind, text in self.spec.model.guards.items()}
        model = self.spec.model
        return {"when": parse_expression(model.when)} if isinstance(model, WhenNode) else {}

    def reads(self) -> frozenset[str]:
        """Return every key that it reads, asks about or compares."""
        names = (name for value in self._values() for name in value.reads | value.asks)
        return frozenset(key for name in names for key in self.names.keys(name))

    def _values(self) -> Iterator[Expression]:
        model = self.spec.model
        if self.is_guard:
            yield from self.conditions().values()
            for texts in model.endings.values():
                yield from (parse_expression(text) for text in texts.values())
            return
        yield from self.conditions().values()
        raw: list[object] = []
        if isinstance(model, SetNode):
            yield from (parse_expression(text) for text in model.set.values())
        if isinstance(model, SkillNode):
            raw = [*model.in_.values()]
        if isinstance(model, ForEachBody):
            raw = [model.in_]
        values = (parse_value(value) for value in raw)
        yield from (value for value in values if isinstance(value, Expression))


@dataclass(frozen=True, slots=True)
class _Place:
    path: str
    names: PastScope


class Rebuilt:
    """Every node of a recorded tree as it was written, by path.

    Attributes:
        nodes: The nodes; empty where the header holds no sources, or none that can be read.
        stations: Name of the subtree that stands at a path, the innermost where there are two.
        owners: What the keys of each use of a tree begin with, and the path where it stands.
    """

    def __init__(self, header: MissionHeader, blackboard: Blackboard) -> None:
        """Read the sources; names get their values from the blackboard."""
        self.nodes: dict[str, WrittenNode] = {}
        self.stations: dict[str, str] = {}
        self.owners: dict[str, str] = {header.mission: header.mission}
        self._blackboard = blackboard
        self._documents = _documents(header)
        root = self._documents.get(header.mission)
        if root is not None:
            scope = PastScope(Scope(header.mission, blackboard), {})
            self._add(root[1], _Place(header.mission, scope), 0)

    def _add(self, spec: NodeSpec, place: _Place, depth: int) -> None:
        model = spec.model
        if depth > _MAX_DEPTH:
            return
        if model.guards or model.endings:
            path = f"{place.path}.guard"
            while path in self.nodes:
                path += ".guard"
            self.nodes[path] = WrittenNode(spec, place.names, True)
        if isinstance(model, SubtreeNode):
            self._add_subtree(model, place, depth)
            return
        self.nodes[place.path] = WrittenNode(spec, place.names, False)
        for child in spec.children:
            self._add(child, _Place(f"{place.path}/{child.name}", place.names), depth + 1)

    def _add_subtree(self, model: SubtreeNode, place: _Place, depth: int) -> None:
        found = self._documents.get(model.subtree)
        if found is None:
            return
        document, root = found
        self.stations[place.path] = model.subtree
        scope, wired = Scope(self._owner(place.path, model.subtree), self._blackboard), {}
        for name, port in document.in_.items():
            default = port.default if port.has_default else REQUIRED
            value = parse_value(model.in_[name]) if name in model.in_ else Literal(port.default)
            scope.bind_input(name, value, place.names.scope, default)
            wired[name] = value, place.names
        for name, reference in model.out.items():
            scope.bind_output(name, reference.removeprefix("$"), place.names.scope)
            wired[name] = parse_value(reference), place.names
        self._add(root, _Place(place.path, PastScope(scope, wired)), depth + 1)

    def _owner(self, path: str, tree: str) -> str:
        """Return what the keys of a tree begin with, as it is worked out when a tree is built."""
        owner = path if path not in self.owners else f"{path}.{tree}"
        self.owners[owner] = path
        return owner


def _documents(
    header: MissionHeader,
) -> dict[str, tuple[MissionDocument | TreeDocument, NodeSpec]]:
    """Return the trees of a recording by name; what cannot be read is left out."""
    found = {}
    for recorded in header.sources:
        try:
            source = read_source(recorded.file, recorded.text)
            document, _ = validate(source)
        except InputError:
            continue
        if isinstance(document, MissionDocument | TreeDocument):
            found[document.name] = document, outline(document, source)
    return found
