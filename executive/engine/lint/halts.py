"""Who can halt each leaf that may run: what a reader of a tree has to know of reactive blocks."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from executive.engine.language.block_models import ParallelBody, TimeoutBody
from executive.engine.language.outline import NodeSpec
from executive.engine.lint.outcomes import number, traits
from executive.engine.lint.subject import Ancestors, Subject


@dataclass(frozen=True, slots=True)
class Halts:
    """Who can halt one leaf.

    Attributes:
        node: Path of the leaf with its subtrees put in.
        by: What can halt it, outermost first, besides a stop of the whole run.
    """

    node: str
    by: tuple[str, ...]


def find_halts(subject: Subject) -> Iterator[Halts]:
    """Yield who can halt each leaf of a tree and of its subtrees that may run."""
    for node, above in subject.expanded():
        if subject.outcomes.below(node) or not subject.outcomes.may(node).run:
            continue
        yield Halts(_path(subject, (*above, node)), tuple(_halters(subject, (*above, node))))


def _halters(subject: Subject, line: Ancestors) -> Iterator[str]:
    limit_s = subject.mission.timeout_s if subject.mission else None
    if limit_s is not None:
        yield f"the mission after {limit_s:g} s"
    for length, node in enumerate(line, start=1):
        path = _path(subject, line[:length])
        if node.model.while_ is not None:
            yield f"{path}: while {node.model.while_}"
        if length < len(line):
            yield from _by_parent(path, node, line[length])


def _by_parent(path: str, parent: NodeSpec, child: NodeSpec) -> Iterator[str]:
    model = parent.model
    if isinstance(model, TimeoutBody):
        seconds = number(model.seconds)
        yield f"{path}: timeout after {model.seconds if seconds is None else f'{seconds:g} s'}"
    if isinstance(model, ParallelBody) and model.on_done == "stop" and len(parent.children) > 1:
        others = ", ".join(one.name for one in parent.children if one is not child)
        yield f"{path}: {others}, which may decide it"
    if traits(parent).reactive and child in parent.children[1:]:
        earlier = parent.children[: parent.children.index(child)]
        asked = earlier[:1] if traits(parent).chooses else earlier
        yield f"{path}: {', '.join(one.name for one in asked)}, asked in every tick"
    if traits(parent).rechooses:
        yield f"{path}: another case, asked in every tick"


def _path(subject: Subject, line: Ancestors) -> str:
    """Return the path of the last node; the root of a subtree goes by the name that uses it."""
    names = [line[0].name]
    for parent, node in pairwise(line):
        if subject.outcomes.inside(parent) is not node:
            names.append(node.name)
    return "/".join(names)
