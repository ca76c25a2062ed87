"""In which order keys stand, and what stands on one line: read from the models of the language."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from executive.engine.language.block_models import BLOCKS, LEAVES, kind_of
from executive.engine.language.document import DOCUMENTS
from executive.engine.language.node_models import NodeModel
from executive.engine.language.outline import node_paths, value_at
from executive.engine.language.sources import YamlPath

_PORT: Final = ("type", "unit", "default", "about")
_ENDINGS: Final = ("on_start", "on_success", "on_failure", "on_halt", "finally")
_LAST: Final = ("cases", "default", "child", "children")
_OPEN: Final = ("in", "out", "scenario", "config", "keep", "skills")
"""Keys of a document whose values stand on lines of their own."""


@dataclass(frozen=True, slots=True)
class Places:
    """What stands where in one document.

    Attributes:
        data: The document.
        kinds: Kind of each node, by the place where it stands.
        containers: Places with nodes somewhere below them.
    """

    data: object
    kinds: Mapping[YamlPath, str]
    containers: frozenset[YamlPath]

    def is_open(self, path: YamlPath) -> bool:
        """Return whether what stands at a place never fits on one line."""
        if self.kinds.get(path) in BLOCKS or path in self.containers or not path:
            return True
        return len(path) == 1 and path[0] in _OPEN

    def known_order(self, path: YamlPath) -> Sequence[str]:
        """Return the keys of the mapping at a place in their order, none where any order is."""
        if not path:
            return _document_order(self.data)
        if path in self.kinds:
            return node_order(self.kinds[path])
        if self.kinds.get(path[:-1]) == path[-1] and path[-1] in BLOCKS:
            return node_order(str(path[-1]))
        return _PORT if len(path) == 2 and path[0] in ("in", "out") else ()


def find_places(data: object) -> Places:
    """Return what stands where in a document without faults."""
    nodes = node_paths(data)
    kinds = {path: kind for path in nodes if (kind := kind_of(value_at(data, path)))}
    above = {path[:length] for path in nodes for length in range(len(path))}
    return Places(data, kinds, frozenset(above))


def node_order(kind: str) -> list[str]:
    """Return the keys of a kind of node: kind, name, about, guards, its own, ports, endings, nodes.

    Args:
        kind: Its kind.
    """
    model = {**LEAVES, **BLOCKS}[kind]
    names = [field.alias or name for name, field in model.model_fields.items()]
    common = [field.alias or name for name, field in NodeModel.model_fields.items()]
    first = [name for name in common if name not in _ENDINGS]
    own = [name for name in names if name not in (*common, kind, "out", *_LAST)]
    if kind in LEAVES:  # what a leaf runs comes before how; the list of a loop is its own
        own = [name for name in own if name != "in"] + ["in"] * ("in" in own)
    endings = [name for name in _ENDINGS if name in names]
    last = [name for name in _LAST if name in names]
    return [kind, *first, *own, *(["out"] if "out" in names else []), *endings, *last]


def _document_order(data: object) -> Sequence[str]:
    kinds = data if isinstance(data, dict) else {}
    kind = next(name for name in DOCUMENTS if isinstance(kinds.get(name), str))
    return [field.alias or name for name, field in DOCUMENTS[kind].model_fields.items()]
