"""The keys of one tree: who writes each, and what type and unit it has."""

from collections.abc import Callable, Mapping
from typing import Any, Union

from executive.core.errors import InputError
from executive.engine.language.outline import NodeSpec, TreeSpec
from executive.engine.language.porttypes import accepts, is_sequence, item_type, literal_type
from executive.engine.language.units import unit_of
from executive.engine.loading.inference import infer
from executive.engine.loading.wiring import Gives, Wiring


class KeyTable:
    """What is known about keys before the first tick.

    Attributes:
        types: Type of each key that is declared, written or kept.
        units: Unit of each key that has one.
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
        self._settle(self.types, self._type_of_all)
        self.units: dict[str, str] = {
            name: port.unit for name, port in declared.items() if port.unit
        }
        self._settle(self.units, self._first_unit)

    def _settle(self, known: dict[str, Any], work_out: Callable[[str], Any]) -> None:
        """Work out what the tree does not declare of its keys.

        Assignments may build on each other, so they are looked at until nothing changes.
        """
        own = [key for key in {**self.writers, **self._tree.document.keep} if key not in known]
        for _ in range(len(own) + 1):
            before = dict(known)
            for key in own:
                known[key] = work_out(key)
            if known == before:
                return

    def _type_of_all(self, key: str) -> Any:
        kept = self._tree.document.keep
        first = [literal_type(kept[key])] if key in kept else []
        written = [self.written_type(gives) for _, gives in self.writers.get(key, [])]
        kinds = tuple(dict.fromkeys(first + written))
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

    def _first_unit(self, key: str) -> str:
        units = (self.written_unit(gives) for _, gives in self.writers.get(key, []))
        return next((unit for unit in units if unit), "")

    def written_unit(self, gives: Gives) -> str:
        """Return the unit of what a node writes, empty where it cannot be told."""
        if gives.port is not None:
            return gives.port.unit
        source = gives.value or gives.item_of
        try:
            return unit_of(source, self.units) if source else ""
        except InputError:
            return ""  # told where the expression is used
