"""The keys of one tree: who writes each, and what type and unit it has."""

from collections.abc import Mapping
from typing import Any, Union

from executive.core.errors import InputError
from executive.engine.inference import infer
from executive.engine.outline import NodeSpec, TreeSpec
from executive.engine.porttypes import accepts, is_sequence, item_type
from executive.engine.wiring import Gives, Wiring


class KeyTable:
    """What is known about keys before the first tick.

    Attributes:
        types: Type of each key that is declared or written.
        writers: Nodes that write each key, and how.
    """

    def __init__(self, tree: TreeSpec, wirings: Mapping[NodeSpec, Wiring]) -> None:
        """Gather the writers and work out the types."""
        self._tree = tree
        self.writers: dict[str, list[tuple[NodeSpec, Gives]]] = {}
        for node, wiring in wirings.items():
            for gives in wiring.written:
                self.writers.setdefault(gives.key, []).append((node, gives))
        declared = {**tree.outputs, **tree.inputs}
        self.types: dict[str, Any] = {name: port.type for name, port in declared.items()}
        self._settle_types()

    def _settle_types(self) -> None:
        """Work out the types of the keys that the tree does not declare.

        Assignments may build on each other, so they are looked at until nothing changes.
        """
        own = [key for key in self.writers if key not in self.types]
        for _ in range(len(own) + 1):
            before = dict(self.types)
            for key in own:
                self.types[key] = self._type_of_all(key)
            if self.types == before:
                return

    def _type_of_all(self, key: str) -> Any:
        kinds = tuple(dict.fromkeys(self.written_type(gives) for _, gives in self.writers[key]))
        return Any if Any in kinds else Union[kinds]  # noqa: UP007 - the members are values

    def written_type(self, gives: Gives) -> Any:
        """Return the type of what a node writes, `Any` where it cannot be told."""
        if gives.port is not None:
            return gives.port.type
        source = gives.value or gives.item_of
        if source is None:
            return Any
        try:
            kind = infer(source, self.types)
        except InputError:
            return Any  # told where the expression is used
        if gives.item_of is None:
            return kind
        return item_type(kind) if is_sequence(kind) else Any

    def misfit(self, key: str, wanted: Any) -> str:
        """Name who gives a key a value that does not fit."""
        if key in self._tree.inputs:
            return "whoever uses this tree: it is an input"
        for node, gives in self.writers.get(key, []):
            if not accepts(wanted, self.written_type(gives)):
                return node.path
        return "this tree: it is an output"

    def unit(self, key: str) -> str:
        """Return the unit that somebody declares for a key, empty where nobody does."""
        ports = [self._tree.inputs.get(key), self._tree.outputs.get(key)]
        ports += [gives.port for _, gives in self.writers.get(key, [])]
        return next((port.unit for port in ports if port and port.unit), "")
