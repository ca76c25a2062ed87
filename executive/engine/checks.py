"""Everything about a tree that can be known to be wrong before the first tick."""

from collections import Counter
from collections.abc import Mapping
from typing import Any, Union

from executive.core.errors import Fault, InputError
from executive.core.registry import Registry, closest
from executive.core.skill import Port, Skill
from executive.engine.document import (
    BlockBody,
    ParallelBody,
    SkillNode,
)
from executive.engine.flow import find_early_reads
from executive.engine.inference import infer
from executive.engine.nodeports import PortTable
from executive.engine.outline import NodeSpec, TreeSpec
from executive.engine.porttypes import accepts, is_sequence, item_type, type_name
from executive.engine.values import key_of
from executive.engine.wiring import Gives, Use, Wiring, wire


def check_tree(
    tree: TreeSpec,
    skills: Registry[type[Skill]],
    subtrees: Mapping[str, TreeSpec | None],
) -> list[Fault]:
    """Return every fault in the nodes, ports and wiring of one tree.

    Args:
        tree: The tree.
        skills: Skills by name.
        subtrees: Trees that it uses, by name; None for one that has faults itself.
    """
    return _TreeCheck(tree, skills, subtrees).faults()


class _TreeCheck:
    def __init__(
        self,
        tree: TreeSpec,
        skills: Registry[type[Skill]],
        subtrees: Mapping[str, TreeSpec | None],
    ) -> None:
        self._tree, self._skills = tree, skills
        self._faults: list[Fault] = []
        self._nodes = tuple(tree.root.walk())
        ports = PortTable(skills, subtrees)
        self._wirings = {node: wire(node, ports, self._faults) for node in self._nodes}
        self._writers: dict[str, list[tuple[NodeSpec, Gives]]] = {}
        for node, wiring in self._wirings.items():
            for gives in wiring.written:
                self._writers.setdefault(gives.key, []).append((node, gives))
        self._types: dict[str, Any] = {name: port.type for name, port in tree.inputs.items()}

    def faults(self) -> list[Fault]:
        for node in self._nodes:
            self._check_node(node)
        self._check_root_name()
        self._settle_types()
        for wiring in self._wirings.values():
            for use in wiring.uses:
                self._check_use(wiring, use)
            for gives in wiring.written:
                self._check_write(wiring.node, gives)
        self._check_outputs()
        known = frozenset(self._tree.inputs)
        find_early_reads(self._tree.root, self._wirings, known, self._complain_early)
        return self._faults

    def _check_node(self, node: NodeSpec) -> None:
        model = node.model
        if isinstance(model, SkillNode) and model.skill not in self._skills:
            known = closest(model.skill, [*self._skills])
            self._faults.append(node.fault(f"unknown skill {model.skill!r}; {known}", "skill"))
        if isinstance(model, BlockBody):
            self._check_siblings(node)
        if isinstance(model, ParallelBody):
            self._check_policies(node, model)

    def _check_siblings(self, node: NodeSpec) -> None:
        counts = Counter(child.name for child in node.children)
        for child in node.children:
            if counts[child.name] > 1:
                message = f"another child of {node.name!r} is named {child.name!r} too"
                self._faults.append(child.fault(message, "name"))

    def _check_policies(self, node: NodeSpec, model: ParallelBody) -> None:
        names = [child.name for child in node.children]
        for policy, value in (("succeed", model.succeed), ("fail", model.fail)):
            if isinstance(value, int) and value > len(names):
                message = f"{policy}: expected at most {len(names)}, the number of children"
                self._faults.append(node.fault(f"{message}; got {value}", policy))
        for name in model.succeed if isinstance(model.succeed, tuple) else ():
            if name not in names:
                message = f"succeed: no child is named {name!r}; {closest(name, names)}"
                self._faults.append(node.fault(message, "succeed"))

    def _check_root_name(self) -> None:
        root = self._tree.root
        if root.model.name not in (None, self._tree.name):
            message = f"the root is named after its tree, {self._tree.name!r}; drop the name"
            self._faults.append(root.fault(message, "name"))

    def _settle_types(self) -> None:
        """Work out the type of every key from what declares or writes it.

        Assignments may build on each other, so they are looked at until nothing changes.
        """
        for name, port in self._tree.outputs.items():
            self._types.setdefault(name, port.type)
        for _ in range(len(self._writers) + 1):
            before = dict(self._types)
            for key, writers in self._writers.items():
                if key not in self._tree.inputs and key not in self._tree.outputs:
                    kinds = tuple(dict.fromkeys(self._written_type(gives) for _, gives in writers))
                    self._types[key] = Any if Any in kinds else Union[kinds]  # noqa: UP007 - values
            if self._types == before:
                return

    def _written_type(self, gives: Gives) -> Any:
        if gives.port is not None:
            return gives.port.type
        source = gives.value or gives.item_of
        if source is None:
            return Any
        try:
            kind = infer(source, self._types)
        except InputError:
            return Any  # told where the expression is used
        return kind if gives.item_of is None else _item(kind)

    def _check_use(self, wiring: Wiring, use: Use) -> None:
        unknown = [key for key in sorted(use.value.reads | use.value.asks) if not self._exists(key)]
        for key in unknown:
            known = closest(key, [*self._types])
            message = f"{use.name}: nothing in this tree writes {key!r}; {known}"
            self._faults.append(wiring.node.fault(message, *use.at))
        if unknown:
            return
        try:
            kind = infer(use.value, self._types)
        except InputError as error:
            self._faults.append(wiring.node.fault(f"{use.name}: {error}", *use.at))
            return
        if use.is_condition and not accepts(bool, kind):
            message = f"{use.name}: expected true or false, got {type_name(kind)}"
            hint = "; try a comparison" if not is_sequence(kind) else "; try size(...) > 0"
            self._faults.append(wiring.node.fault(message + hint, *use.at))
        if use.port is not None:
            self._check_input(wiring.node, use, use.port, kind)

    def _exists(self, key: str) -> bool:
        return key in self._types

    def _check_input(self, node: NodeSpec, use: Use, port: Port, kind: Any) -> None:
        key = key_of(use.value)
        if not accepts(port.type, kind):
            origin = f", written by {self._writer_of(key, port.type)}" if key else ""
            self._faults.append(
                node.fault(
                    f"{use.name}: expected {type_name(port.type)}, "
                    f"but ${use.value.text} is {type_name(kind)}{origin}",
                    *use.at,
                )
            )
        unit = self._unit_of(key) if key else ""
        if port.unit and unit and port.unit != unit:
            message = f"{use.name}: expected the unit {port.unit}, but ${key} is in {unit}"
            self._faults.append(node.fault(message, *use.at))

    def _writer_of(self, key: str, wanted: Any) -> str:
        """Name who gives a key a value that does not fit."""
        if key in self._tree.inputs:
            return "whoever uses this tree: it is an input"
        for node, gives in self._writers.get(key, []):
            if not accepts(wanted, self._written_type(gives)):
                return node.path
        return "this tree: it is an output"

    def _unit_of(self, key: str) -> str:
        ports = [self._tree.inputs.get(key), self._tree.outputs.get(key)]
        ports += [gives.port for _, gives in self._writers.get(key, [])]
        return next((port.unit for port in ports if port and port.unit), "")

    def _check_write(self, node: NodeSpec, gives: Gives) -> None:
        if gives.key in self._tree.inputs:
            message = (
                f"{gives.key!r} is an input of the tree, which is not written; try another key"
            )
            self._faults.append(node.fault(message, *gives.at))
        declared = self._tree.outputs.get(gives.key)
        if declared is None:
            return
        kind = self._written_type(gives)
        if not accepts(declared.type, kind):
            message = (
                f"output {gives.key!r} of the tree is {type_name(declared.type)}, "
                f"but this writes {type_name(kind)}"
            )
            self._faults.append(node.fault(message, *gives.at))
        unit = gives.port.unit if gives.port else ""
        if unit and declared.unit and unit != declared.unit:
            message = f"output {gives.key!r} of the tree is in {declared.unit}, this in {unit}"
            self._faults.append(node.fault(message, *gives.at))

    def _check_outputs(self) -> None:
        for name in self._tree.outputs:
            if name not in self._writers and name not in self._tree.inputs:
                source = self._tree.source
                line, column = source.key_mark(("out", name))
                known = closest(name, [*self._writers])
                message = f"output {name!r} is never written; {known}"
                self._faults.append(Fault(source.file, line, column, self._tree.name, message))

    def _complain_early(self, node: NodeSpec, use: Use, key: str) -> None:
        if key in self._types and key in self._writers:
            writers = ", ".join(writer.path for writer, _ in self._writers[key])
            message = f"{use.name}: ${key} has no value yet; {writers} writes it later"
            self._faults.append(node.fault(message, *use.at))


def _item(kind: Any) -> Any:
    return item_type(kind) if is_sequence(kind) else Any
