"""Rules about the shape of a tree and the names in it."""

from collections import Counter
from collections.abc import Iterator
from typing import Final

from executive.engine.lint.findings import Rule, Spot
from executive.engine.lint.outcomes import traits
from executive.engine.lint.subject import Subject

DEEP: Final = 10
"""More levels in one file than anybody keeps in mind."""


def _one_child(subject: Subject) -> Iterator[Spot]:
    for node, _ in subject.nodes():
        what = traits(node)
        if (what.goes_on_after or what.concurrent) and len(node.children) == 1:
            guarded = node.model.guards or node.model.endings
            put = "its guards and endings on the child" if guarded else "the child in its place"
            yield Spot(node, f"one child; try {put}")


def _too_deep(subject: Subject) -> Iterator[Spot]:
    for node, above in subject.nodes():
        if len(above) == DEEP:
            message = f"{len(above) + 1} levels deep in one file; expected {DEEP} at most"
            yield Spot(node, f"{message}, try a subtree")


def _names(subject: Subject) -> Iterator[Spot]:
    nodes = [node for node, _ in subject.nodes()]
    counts = Counter(node.model.name for node in nodes if node.model.name)
    for node in nodes:
        name = node.model.name
        if not name:
            continue
        if counts[name] > 1:
            yield Spot(node, f"{name!r} names {counts[name]} nodes of this tree", ("name",))
        elif name in subject.program.skills and getattr(node.model, "skill", name) != name:
            yield Spot(node, f"{name!r} is the name of another skill; try its own", ("name",))


def _never_halted(subject: Subject) -> Iterator[Spot]:
    for node, _ in subject.nodes():
        if node.model.on_halt and not subject.outcomes.may(node).run:
            message = "on_halt: it ends in the tick in which it starts, nothing can halt it"
            yield Spot(node, f"{message}; try on_success or on_failure", ("on_halt",))


ONE_CHILD = Rule("L106", "block with one child", "A block with one child adds nothing.", _one_child)
TOO_DEEP = Rule(
    "L108",
    "too deep",
    f"More than {DEEP} levels in one file; a subtree would give the inner part a name.",
    _too_deep,
)
NEVER_HALTED = Rule(
    "L109",
    "on_halt that cannot happen",
    "`on_halt` on a node that never runs longer than a tick.",
    _never_halted,
)
NAMES = Rule(
    "L401",
    "misleading name",
    "Two nodes of a tree with one given name, or a node named like a skill that it does not run: "
    "reports that name it mislead.",
    _names,
)
