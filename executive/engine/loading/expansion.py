"""A tree with its subtrees put in, as text and drawings show it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from executive.engine.language.block_models import BLOCKS, CasesBody
from executive.engine.language.node_models import NodeModel, SkillNode, SubtreeNode
from executive.engine.language.outline import NodeSpec
from executive.engine.loading.loader import Program

_ELSEWHERE = {"name", "about", "children", "child", "memory", "cases", "default"}


@dataclass(frozen=True, slots=True, eq=False)
class ExpandedNode:
    """One node of a tree with its subtrees put in.

    Attributes:
        name: Its name, that of the node that uses it where it is the root of a subtree.
        kind: Its kind.
        details: What it says besides: skill, ports, parameters and conditions.
        children: Its children, in order.
    """

    name: str
    kind: str
    details: tuple[str, ...]
    children: tuple["ExpandedNode", ...]

    def walk(self) -> Iterator["ExpandedNode"]:
        """Yield the node and everything below it, parents before children."""
        yield self
        for child in self.children:
            yield from child.walk()


def expand(program: Program) -> ExpandedNode:
    """Return the root of a checked tree with its subtrees put in."""
    return _expand(program, program.tree.root, program.tree.name, ())


def _expand(program: Program, spec: NodeSpec, name: str, above: tuple[str, ...]) -> ExpandedNode:
    details = (*above, *_details(spec.model, name))
    if isinstance(spec.model, SubtreeNode):
        root = program.subtrees[spec.model.subtree].root
        return _expand(program, root, name, (f"subtree {spec.model.subtree}", *details))
    children = tuple(
        _expand(program, child, child.name, case)
        for child, case in zip(spec.children, _cases(spec), strict=True)
    )
    return ExpandedNode(name, spec.model.kind, details, children)


def _cases(spec: NodeSpec) -> Iterator[tuple[str, ...]]:
    """Yield what each child of a node stands for."""
    cases = [*spec.model.cases] if isinstance(spec.model, CasesBody) else []
    for i, _ in enumerate(spec.children):
        yield (f"case {cases[i]}",) if i < len(cases) else ("default",) if cases else ()


def _details(model: NodeModel, name: str) -> Iterator[str]:
    if isinstance(model, SkillNode) and model.skill != name:
        yield f"skill {model.skill}"
    if isinstance(model, (SkillNode, SubtreeNode)):
        yield from _wires("in", model.in_)
        yield from _wires("out", model.out)
    elif model.kind in BLOCKS:
        yield from _parameters(model)
    else:
        yield _shown(getattr(model, model.kind))
        yield from _parameters(model)
    if model.checkpoint:
        yield "checkpoint"
    yield from (f"{keyword} {text}" for keyword, text in model.guards.items())
    yield from (f"{keyword} {_shown(texts)}" for keyword, texts in model.endings.items())


def _wires(direction: str, wired: Mapping[str, object]) -> Iterator[str]:
    """Yield the ports of a leaf; one that is wired to the key of its own name is shown once."""
    shown = (
        f"${port}" if value == f"${port}" else f"{port}: {_shown(value)}"
        for port, value in wired.items()
    )
    if wired:
        yield f"{direction} {', '.join(shown)}"


def _parameters(model: NodeModel) -> Iterator[str]:
    """Yield what a block sets besides what every node has."""
    own = set(type(model).model_fields) - {*NodeModel.model_fields, *_ELSEWHERE, model.kind}
    for field, info in type(model).model_fields.items():
        value = getattr(model, field)
        if field in own and (info.is_required() or value != info.default):
            yield f"{info.alias or field} {_shown(value)}"


def _shown(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} = {_shown(item)}" for key, item in value.items())
    return ", ".join(value) if isinstance(value, tuple) else str(value)
