"""How nodes can end, and what their kinds do with their children: one table for all kinds.

Rules speak of these properties and of no kind by name, so a new kind of node needs a line in
`TRAITS` and nothing else here.
"""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final

from executive.core.errors import InputError
from executive.core.registry import Registry
from executive.core.skill import Skill
from executive.engine.language.block_models import CasesBody, ForEachBody, ParallelBody, RetryBody
from executive.engine.language.expression import parse_expression
from executive.engine.language.node_models import ChanceNode, NodeModel, WhenNode
from executive.engine.language.outline import NodeSpec, TreeSpec


@dataclass(frozen=True, slots=True)
class May:
    """What a node may answer in a tick: it succeeds, it fails, it still runs."""

    succeed: bool
    fail: bool
    run: bool


ANYTHING: Final = May(succeed=True, fail=True, run=True)
Combine = Callable[[Any, Sequence[May]], May]


@dataclass(frozen=True, slots=True)
class Traits:
    """What a kind of node does.

    Attributes:
        may: Its answers, from what it says and the answers of its children.
        goes_on_after: The answer of a child after which the next one is asked: `succeed` for
            a sequence, `fail` for a selector, empty where children are not asked in turn.
        reactive: Whether it asks its first child, and those after it, anew in every tick.
        concurrent: Whether its children run side by side.
        again_after: The answer of its child after which it runs it again, empty for never.
        ignores: Answers of its child that make no difference to it.
        chooses: Whether its first child decides which of the others is run.
        rechooses: Whether an expression decides anew in every tick which child is run.
        once: Whether it keeps its child from being run a second time.
    """

    may: Combine
    goes_on_after: str = ""
    reactive: bool = False
    concurrent: bool = False
    again_after: str = ""
    ignores: frozenset[str] = frozenset()
    chooses: bool = False
    rechooses: bool = False
    once: bool = False


def constant(text: str) -> object:
    """Return the value of an expression that asks nothing; None where it asks something."""
    try:
        expression = parse_expression(text)
        if expression.reads or expression.asks:
            return None
        return expression.evaluate({})
    except InputError:
        return None


def number(value: float | str) -> float | None:
    """Return a number as it is written; None where a key says it at run time."""
    said = constant(value.removeprefix("$")) if isinstance(value, str) else value
    return said if isinstance(said, (int, float)) else None


def _anything(_model: NodeModel, _children: Sequence[May]) -> May:
    return ANYTHING


def _when(model: WhenNode, _children: Sequence[May]) -> May:
    value = constant(model.when)
    return May(succeed=value is not False, fail=value is not True, run=False)


def _chance(model: ChanceNode, _children: Sequence[May]) -> May:
    likely = number(model.chance)
    return May(succeed=likely != 0, fail=likely != 1, run=False)


def _at_once(_model: NodeModel, _children: Sequence[May]) -> May:
    return May(succeed=True, fail=False, run=False)


def _in_the_end(_model: NodeModel, _children: Sequence[May]) -> May:
    return May(succeed=True, fail=False, run=True)


def _never(_model: NodeModel, _children: Sequence[May]) -> May:
    return May(succeed=False, fail=True, run=False)


def _sequence(_model: NodeModel, children: Sequence[May]) -> May:
    reached = _reached(children, "succeed")
    return May(
        succeed=all(child.succeed for child in children),
        fail=any(child.fail for child in reached),
        run=any(child.run for child in reached),
    )


def _selector(_model: NodeModel, children: Sequence[May]) -> May:
    reached = _reached(children, "fail")
    return May(
        succeed=any(child.succeed for child in reached),
        fail=all(child.fail for child in children),
        run=any(child.run for child in reached),
    )


def _reached(children: Sequence[May], goes_on_after: str) -> Sequence[May]:
    stops = [i for i, child in enumerate(children) if not getattr(child, goes_on_after)]
    return children[: stops[0] + 1] if stops else children


def _if_then_else(_model: NodeModel, children: Sequence[May]) -> May:
    condition, then = children[:2]
    otherwise = children[2] if len(children) > 2 else May(succeed=False, fail=True, run=False)
    taken = [then] * condition.succeed + [otherwise] * condition.fail
    may = _one_of(taken)
    return May(may.succeed, may.fail, may.run or condition.run)


def _switch(model: CasesBody, children: Sequence[May]) -> May:
    may = _one_of(children)
    return May(may.succeed, may.fail or model.default is None, may.run)


def _one_of(children: Sequence[May]) -> May:
    return May(
        succeed=any(child.succeed for child in children),
        fail=any(child.fail for child in children),
        run=any(child.run for child in children),
    )


def _parallel(model: ParallelBody, children: Sequence[May]) -> May:
    needed = all if model.succeed == "all" else any
    may = _one_of(children)
    return May(needed(child.succeed for child in children), may.fail, may.run)


def _retry(model: RetryBody, children: Sequence[May]) -> May:
    (child,) = children
    return May(child.succeed, child.fail, child.run or (child.fail and number(model.times) != 1))


def _repeat(model: Any, children: Sequence[May]) -> May:
    (child,) = children
    again = child.succeed and number(model.times) != 1
    return May(child.succeed, child.fail, child.run or again)


def _may_fail(_model: NodeModel, children: Sequence[May]) -> May:
    return dataclasses.replace(children[0], fail=True)


def _for_each(model: ForEachBody, children: Sequence[May]) -> May:
    (child,) = children
    items = model.in_ if isinstance(model.in_, list) else None
    if items == []:
        return May(succeed=True, fail=False, run=False)
    again = child.succeed and (items is None or len(items) > 1)
    return May(child.succeed or items is None, child.fail, child.run or again)


def _same(_model: NodeModel, children: Sequence[May]) -> May:
    return children[0]


def _inverted(_model: NodeModel, children: Sequence[May]) -> May:
    (child,) = children
    return May(child.fail, child.succeed, child.run)


def _forced_success(_model: NodeModel, children: Sequence[May]) -> May:
    (child,) = children
    return May(child.succeed or child.fail, False, child.run)


def _forced_failure(_model: NodeModel, children: Sequence[May]) -> May:
    (child,) = children
    return May(False, child.succeed or child.fail, child.run)


def _running_is_success(_model: NodeModel, children: Sequence[May]) -> May:
    (child,) = children
    return May(child.succeed or child.run, child.fail, run=False)


def _running_is_failure(_model: NodeModel, children: Sequence[May]) -> May:
    (child,) = children
    return May(child.succeed, child.fail or child.run, run=False)


_ENDS: Final = frozenset({"succeed", "fail"})
TRAITS: Final[Mapping[str, Traits]] = MappingProxyType(
    {
        "skill": Traits(_anything),
        "subtree": Traits(_anything),
        "when": Traits(_when),
        "set": Traits(_at_once),
        "unset": Traits(_at_once),
        "wait": Traits(_in_the_end),
        "wait_for": Traits(_in_the_end),
        "fail": Traits(_never),
        "chance": Traits(_chance),
        "sequence": Traits(_sequence, goes_on_after="succeed"),
        "reactive_sequence": Traits(_sequence, goes_on_after="succeed", reactive=True),
        "selector": Traits(_selector, goes_on_after="fail"),
        "reactive_selector": Traits(_selector, goes_on_after="fail", reactive=True),
        "parallel": Traits(_parallel, concurrent=True),
        "if_then_else": Traits(_if_then_else, chooses=True),
        "while_do_else": Traits(_if_then_else, chooses=True, reactive=True),
        "switch": Traits(_switch),
        "reactive_switch": Traits(_switch, rechooses=True),
        "retry": Traits(_retry, again_after="fail"),
        "repeat": Traits(_repeat, again_after="succeed"),
        "timeout": Traits(_may_fail),
        "cooldown": Traits(_may_fail),
        "for_each": Traits(_for_each, again_after="succeed"),
        "run_once": Traits(_same, once=True),
        "inverter": Traits(_inverted),
        "force_success": Traits(_forced_success, ignores=_ENDS),
        "force_failure": Traits(_forced_failure, ignores=_ENDS),
        "running_is_success": Traits(_running_is_success),
        "running_is_failure": Traits(_running_is_failure),
        "observe": Traits(_same),
    }
)
"""Every kind of node; a test holds it against the language."""

_UNKNOWN: Final = Traits(_anything)


def traits(node: NodeSpec) -> Traits:
    """Return what the kind of a node does."""
    return TRAITS.get(node.model.kind, _UNKNOWN)


@dataclass(slots=True)
class Outcomes:
    """How the nodes of a program can end, and what they do to the cell.

    Attributes:
        skills: Skills by name.
        subtrees: Trees by name.
        goes_on: Whether what raises fails, instead of ending the mission.
    """

    skills: Registry[type[Skill]]
    subtrees: Mapping[str, TreeSpec]
    goes_on: bool = False
    _known: dict[NodeSpec, May] = field(default_factory=dict)

    def may(self, node: NodeSpec) -> May:
        """Return what a node may answer, with its guards."""
        if node not in self._known:
            self._known[node] = self._guarded(node.model, self._bare(node))
        return self._known[node]

    def _bare(self, node: NodeSpec) -> May:
        if (skill := self.skill(node)) is not None:
            return May(succeed=True, fail=bool(skill.REASONS) or self.goes_on, run=True)
        if (inside := self.inside(node)) is not None:
            return self.may(inside)
        return traits(node).may(node.model, [self.may(child) for child in node.children])

    def _guarded(self, model: NodeModel, may: May) -> May:
        for keyword, text in model.guards.items():
            value = constant(text)
            if keyword == "unless":
                never = value is True
                open_ = value is not False
                may = May(may.succeed or open_, may.fail and not never, may.run and not never)
            else:
                never = value is False
                shut = value is not True
                may = May(may.succeed and not never, may.fail or shut, may.run and not never)
        return may

    def skill(self, node: NodeSpec) -> type[Skill] | None:
        """Return the skill that a node runs, None where it runs none."""
        name: str = getattr(node.model, "skill", "")
        return self.skills.get(name) if name in self.skills else None

    def inside(self, node: NodeSpec) -> NodeSpec | None:
        """Return the root that stands in the place of a node, None where none does."""
        tree = self.subtrees.get(getattr(node.model, "subtree", ""))
        return tree.root if tree is not None else None

    def below(self, node: NodeSpec) -> Sequence[NodeSpec]:
        """Return what a node has below it, through the border of a subtree."""
        inside = self.inside(node)
        return node.children if inside is None else (inside,)

    def running_again(self, node: NodeSpec, wanted: Callable[[type[Skill]], bool]) -> str:
        """Return the name of a skill that running a node again runs again, empty for none."""
        if traits(node).once or node.model.unless is not None:
            return ""
        skill = self.skill(node)
        if skill is not None and wanted(skill):
            return str(getattr(node.model, "skill", ""))
        found = (self.running_again(child, wanted) for child in self.below(node))
        return next((name for name in found if name), "")
