"""Everything about a tree that can be known to be wrong before the first tick."""

from collections.abc import Mapping
from typing import Any

from executive.core.errors import Fault, InputError
from executive.core.registry import Registry, closest
from executive.core.skill import Port, Skill
from executive.engine.language.cases import case_faults
from executive.engine.language.outline import NodeSpec, TreeSpec
from executive.engine.language.porttypes import accepts, is_sequence, type_name
from executive.engine.language.units import unit_of
from executive.engine.language.values import key_of
from executive.engine.loading.claim_checks import claim_faults
from executive.engine.loading.flow import find_early_reads
from executive.engine.loading.inference import infer
from executive.engine.loading.keys import KeyTable
from executive.engine.loading.nodeports import PortTable
from executive.engine.loading.structure import structural_faults
from executive.engine.loading.wiring import Gives, Use, wire


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
    faults = [*structural_faults(tree, skills), *claim_faults(tree, skills, subtrees)]
    ports = PortTable(skills, subtrees)
    wirings = {node: wire(node, ports, faults) for node in tree.root.walk()}
    check = _WiringCheck(tree, KeyTable(tree, wirings), faults)
    for node, wiring in wirings.items():
        for use in wiring.uses:
            check.use(node, use)
        for gives in wiring.written:
            check.write(node, gives)
    check.outputs()
    given = frozenset({*tree.inputs, *tree.document.keep})
    find_early_reads(tree.root, wirings, given, check.early_read)
    return faults


class _WiringCheck:
    """Holds what nodes read and write against what is known about the keys."""

    def __init__(self, tree: TreeSpec, keys: KeyTable, faults: list[Fault]) -> None:
        self._tree, self._keys, self._faults = tree, keys, faults

    def use(self, node: NodeSpec, use: Use) -> None:
        """Check a read: its names, its fields, its type."""
        named = sorted(use.value.reads | use.value.asks)
        unknown = [key for key in named if key not in self._keys.types]
        for key in unknown:
            known = closest(key, [*self._keys.types])
            self._complain(node, use, f"nothing in this tree writes {key!r}; {known}")
        if unknown:
            return
        try:
            kind = infer(use.value, self._keys.types)
        except InputError as error:
            self._complain(node, use, str(error))
            return
        if use.is_condition and not accepts(bool, kind):
            hint = "size(...) > 0" if is_sequence(kind) else "a comparison"
            self._complain(node, use, f"expected true or false, got {type_name(kind)}; try {hint}")
        if use.port is not None:
            self._input(node, use, use.port, kind)
        self._unit(node, use)
        for case, fault in case_faults(use.cases, kind):
            self._faults.append(node.fault(fault, "cases", case))

    def _input(self, node: NodeSpec, use: Use, port: Port, kind: Any) -> None:
        key = key_of(use.value)
        if not accepts(port.type, kind):
            origin = f", written by {self._keys.misfit(key, port.type)}" if key else ""
            given = f"${use.value.text} is {type_name(kind)}{origin}"
            self._complain(node, use, f"expected {type_name(port.type)}, but {given}")

    def _unit(self, node: NodeSpec, use: Use) -> None:
        try:
            unit = unit_of(use.value, self._keys.units)
        except InputError as error:
            self._complain(node, use, str(error))
            return
        wanted = use.port.unit if use.port else ""
        if wanted and unit and wanted != unit:
            given = f"${use.value.text} is in {unit}"
            self._complain(node, use, f"expected the unit {wanted}, but {given}")

    def write(self, node: NodeSpec, gives: Gives) -> None:
        """Check a write: not to an input, and to an output with its type and unit."""
        key = gives.key
        if key in self._tree.inputs:
            message = f"{key!r} is an input of the tree, which is not written; try another key"
            self._faults.append(node.fault(message, *gives.at))
        self._written_unit(node, gives)
        declared = self._tree.outputs.get(key)
        if declared is None:
            return
        kind = self._keys.written_type(gives)
        if not accepts(declared.type, kind):
            wanted = f"output {key!r} of the tree is {type_name(declared.type)}"
            message = f"{wanted}, but this writes {type_name(kind)}"
            self._faults.append(node.fault(message, *gives.at))

    def _written_unit(self, node: NodeSpec, gives: Gives) -> None:
        """Check that all who write a key do so in one unit."""
        unit, wanted = self._keys.written_unit(gives), self._keys.units.get(gives.key, "")
        if unit and wanted and unit != wanted:
            is_output = gives.key in self._tree.outputs
            what = f"output {gives.key!r} of the tree" if is_output else f"${gives.key}"
            message = f"{what} is in {wanted}, this in {unit}"
            self._faults.append(node.fault(message, *gives.at))

    def outputs(self) -> None:
        """Check that every declared output is written somewhere."""
        source = self._tree.source
        for name in self._tree.outputs:
            if name not in self._keys.writers:
                message = (
                    f"output {name!r} is never written; {closest(name, [*self._keys.writers])}"
                )
                line, column = source.key_mark(("out", name))
                self._faults.append(Fault(source.file, line, column, self._tree.name, message))

    def early_read(self, node: NodeSpec, use: Use, key: str) -> None:
        """Complain about a read that no write can come before."""
        if key in self._keys.writers:
            writers = ", ".join(writer.path for writer, _ in self._keys.writers[key])
            self._complain(node, use, f"${key} has no value yet; {writers} writes it later")

    def _complain(self, node: NodeSpec, use: Use, message: str) -> None:
        self._faults.append(node.fault(f"{use.name}: {message}", *use.at))
