"""Rules about children that are asked in turn."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from executive.core.skill import Skill
from executive.engine.language.outline import NodeSpec
from executive.engine.lint.findings import Rule, Spot
from executive.engine.lint.outcomes import constant, traits
from executive.engine.lint.subject import Ancestors, Subject

_SAID = {"succeed": "always fails", "fail": "always succeeds"}
"""What a child does that never gives the answer after which the next one is asked."""


def _unreachable(subject: Subject) -> Iterator[Spot]:
    for node, _ in subject.nodes():
        if traits(node).chooses:
            yield from _never_taken(subject, node)
        wanted = traits(node).goes_on_after
        if not wanted:
            continue
        for child, later in pairwise(node.children):
            if not getattr(subject.outcomes.may(child), wanted):
                says = f"never asked: {child.name!r} before it {_SAID[wanted]}"
                yield Spot(later, f"{says}; drop it, or put it first")
                break


def _never_taken(subject: Subject, node: NodeSpec) -> Iterator[Spot]:
    condition, *branches = node.children
    may = subject.outcomes.may(condition)
    for branch, taken in zip(branches, (may.succeed, may.fail), strict=False):
        if not taken:
            says = "always fails" if not may.succeed else "always succeeds"
            yield Spot(branch, f"never run: {condition.name!r} {says}; drop one of the two")


def _constant(subject: Subject) -> Iterator[Spot]:
    for node, _ in subject.nodes():
        conditions = dict(node.model.guards)
        if (text := getattr(node.model, "when", None)) is not None:
            conditions["when"] = text
        for keyword, text in conditions.items():
            if isinstance(value := constant(text), bool):
                always = "true" if value else "false"
                message = f"{keyword}: always {always}, it asks nothing"
                yield Spot(node, f"{message}; drop it, or ask about a key", (keyword,))


def _asked_once(subject: Subject) -> Iterator[Spot]:
    for node, above in subject.nodes():
        if traits(node).goes_on_after != "succeed" or traits(node).reactive:
            continue
        changing = _changing(subject, node, above)
        for i, child in enumerate(node.children):
            keys = sorted(_asked(subject, child) & changing)
            runs = [later for later in node.children[i + 1 :] if subject.outcomes.may(later).run]
            if keys and runs:
                once = f"asked once, but ${keys[0]} may change while {runs[0].name!r} runs"
                yield Spot(child, f"{once}; try `while` on {runs[0].name!r}, or reactive_sequence")


def _asked(subject: Subject, node: NodeSpec) -> frozenset[str]:
    """Return the keys that a condition asks about, none for a node that does anything else."""
    nodes = list(node.walk())
    is_condition = getattr(nodes[-1].model, "when", None) is not None
    plain = all(len(one.children) <= 1 and not traits(one).once for one in nodes)
    return subject.reads(nodes[-1]) if is_condition and plain else frozenset()


def _changing(subject: Subject, node: NodeSpec, above: Ancestors) -> frozenset[str]:
    """Return the keys that other nodes may write while a node runs."""
    line = (*above, node)
    others: list[NodeSpec] = []
    for parent, child in pairwise(line):
        if traits(parent).concurrent:
            others += [one for one in parent.children if one is not child]
        elif traits(parent).reactive:
            others += parent.children[: parent.children.index(child)]
    return frozenset().union(*(subject.written_below(other) for other in others))


def _restarted(subject: Subject) -> Iterator[Spot]:
    def acts(skill: type[Skill]) -> bool:
        return skill.ACTS or not skill.REPEATABLE

    for node, _ in subject.nodes():
        if not traits(node).reactive:
            continue
        asked = node.children[:1] if traits(node).chooses else node.children
        for i, child in enumerate(asked):
            goes_on = traits(node).chooses or getattr(
                subject.outcomes.may(child), traits(node).goes_on_after
            )
            runs = _first_running(subject, node.children[i + 1 :])
            skill = subject.outcomes.running_again(child, acts)
            if goes_on and runs and skill:
                message = f"{skill} is run again in every tick while {runs!r} runs"
                yield Spot(child, f"{message}; try a block that goes on, or run_once around it")


def _first_running(subject: Subject, nodes: Sequence[NodeSpec]) -> str:
    return next((node.name for node in nodes if subject.outcomes.may(node).run), "")


UNREACHABLE = Rule(
    "L101",
    "unreachable child",
    "In a selector nothing comes after a child that always succeeds, in a sequence nothing after "
    "one that always fails. A skill without REASONS never fails.",
    _unreachable,
)
CONSTANT = Rule(
    "L102",
    "constant condition",
    "A condition without a key gives the same answer for ever.",
    _constant,
)
ASKED_ONCE = Rule(
    "L103",
    "condition asked once",
    "A sequence goes on where it was, so a `when` in it is not asked again, while another node "
    "may change the key in the meantime.",
    _asked_once,
)
RESTARTED = Rule(
    "L104",
    "acting again in every tick",
    "A reactive block begins with its first child in every tick. A child before the one that "
    "runs is started again each time, with everything that it moves.",
    _restarted,
)
