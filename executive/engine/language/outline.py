"""What a document holds, node by node: names, paths and where each node stands in its file.

Names are worked out on the values as they were read, not on the models, so that a fault in a
document that has no model yet still names its node.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from executive.core.errors import Fault
from executive.core.skill import Port
from executive.engine.language.block_models import (
    BLOCKS,
    BlockBody,
    CasesBody,
    DecoratorBody,
    kind_of,
)
from executive.engine.language.document import DOCUMENTS, MissionDocument, TreeDocument
from executive.engine.language.node_models import NodeModel
from executive.engine.language.sources import Source, YamlPath


@dataclass(frozen=True, slots=True, eq=False)
class NodeSpec:
    """One node of a tree as it is written.

    Attributes:
        model: What it says.
        name: Name, the same for no two siblings.
        path: Names from the root of its tree down to it.
        at: Where its keys stand in the document.
        children: Its children, in order.
        source: The file.
    """

    model: NodeModel
    name: str
    path: str
    at: YamlPath
    children: tuple["NodeSpec", ...]
    source: Source

    def walk(self) -> Iterator["NodeSpec"]:
        """Yield the node and everything below it, parents before children."""
        yield self
        for child in self.children:
            yield from child.walk()

    @property
    def mark(self) -> tuple[int, int]:
        """Line and column of the word that says its kind, or of the brace around it."""
        if self.model.kind in BLOCKS:
            return self.source.key_mark(self.at)
        return self.source.value_mark(self.at)

    def fault(self, message: str, *keys: str | int) -> Fault:
        """Return a fault at one of its keys, or at the node itself."""
        line, column = self.source.value_mark((*self.at, *keys)) if keys else self.mark
        return Fault(self.source.file, line, column, self.path, message)


@dataclass(frozen=True, slots=True, eq=False)
class TreeSpec:
    """One tree or mission as it is written, with its ports.

    Attributes:
        document: What the file says.
        source: The file.
        root: The root node.
        inputs: Input ports by name.
        outputs: Output ports by name.
    """

    document: TreeDocument | MissionDocument
    source: Source
    root: NodeSpec
    inputs: Mapping[str, Port]
    outputs: Mapping[str, Port]

    @property
    def name(self) -> str:
        """Name of the tree."""
        return self.document.name


def outline(document: TreeDocument | MissionDocument, source: Source) -> NodeSpec:
    """Return the root node of a document, with everything below it."""
    paths = node_paths(source.data)
    return _spec(document.root, ("root",), source, paths)


def _spec(
    model: NodeModel, at: YamlPath, source: Source, paths: Mapping[YamlPath, str]
) -> NodeSpec:
    path = paths[at]
    body = (*at, model.kind) if model.kind in BLOCKS else at
    models: Sequence[NodeModel] = ()
    if isinstance(model, BlockBody):
        models = model.children
    elif isinstance(model, DecoratorBody):
        models = (model.child,)
    elif isinstance(model, CasesBody):
        models = (*model.cases.values(), *((model.default,) if model.default else ()))
    places = _child_places(source.data, at)
    children = tuple(
        _spec(child, place, source, paths) for child, place in zip(models, places, strict=True)
    )
    return NodeSpec(model, path.rpartition("/")[2], path, body, children, source)


def node_paths(data: object) -> dict[YamlPath, str]:
    """Return the path of every node of a document by where it stands, as far as it can be read."""
    if not isinstance(data, dict) or "root" not in data:
        return {}
    names = [data[kind] for kind in DOCUMENTS if isinstance(data.get(kind), str)]
    paths: dict[YamlPath, str] = {("root",): names[0] if names else "root"}
    open_nodes: list[YamlPath] = [("root",)]
    while open_nodes:
        at = open_nodes.pop()
        places = _child_places(data, at)
        names = _distinct([_labels(value_at(data, place)) for place in places])
        for place, name in zip(places, names, strict=True):
            paths[place] = f"{paths[at]}/{name}"
        open_nodes.extend(places)
    return paths


def value_at(data: object, path: YamlPath) -> object:
    """Return the value at a path of a document, None where there is none."""
    for key in path:
        if isinstance(data, dict):
            data = data.get(key)
        elif isinstance(data, list) and isinstance(key, int) and key < len(data):
            data = data[key]
        else:
            return None
    return data


def _child_places(data: object, at: YamlPath) -> list[YamlPath]:
    """Return where the children of the node at `at` stand."""
    kind = kind_of(value_at(data, at))
    if kind not in BLOCKS:
        return []
    body_at = (*at, kind)
    body = value_at(data, body_at)
    if isinstance(body, list):
        return [(*body_at, i) for i in range(len(body))]
    if not isinstance(body, dict):
        return []
    children = body.get("children")
    places: list[YamlPath] = [(*body_at, "child")] if "child" in body else []
    if isinstance(children, list):
        places += [(*body_at, "children", i) for i in range(len(children))]
    return places + _case_places(body, body_at)


def _case_places(body: Mapping[str, object], body_at: YamlPath) -> list[YamlPath]:
    cases = body.get("cases")
    if not isinstance(cases, dict):
        return []
    places: list[YamlPath] = [(*body_at, "cases", case) for case in cases]
    return [*places, (*body_at, "default")] if body.get("default") is not None else places


def _labels(value: object) -> tuple[str | None, str]:
    """Return the name that a node gives itself, and the one that it has otherwise."""
    kind = kind_of(value)
    if kind is None or not isinstance(value, dict):
        return None, "?"
    body = value[kind] if kind in BLOCKS else value
    name = body.get("name") if isinstance(body, dict) else None
    what = value[kind] if kind in ("skill", "subtree") else None
    return name if isinstance(name, str) else None, what if isinstance(what, str) else kind


def _distinct(labels: Sequence[tuple[str | None, str]]) -> list[str]:
    """Number the siblings that have no name of their own: `look`, `look_2`, ..."""
    taken = {given for given, _ in labels}
    seen: Counter[str] = Counter()
    names = []
    for given, otherwise in labels:
        name = given or otherwise
        while given is None:
            seen[otherwise] += 1
            name = otherwise if seen[otherwise] == 1 else f"{otherwise}_{seen[otherwise]}"
            if name not in taken:
                break
        names.append(name)
    return names
