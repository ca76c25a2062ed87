"""Which py_trees node, or node of ours, a kind of node in YAML becomes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import OneShotPolicy, Status
from py_trees.composites import Selector
from py_trees.composites import Sequence as SequenceNode
from py_trees.decorators import FailureIsSuccess, Inverter, OneShot, SuccessIsFailure

from executive.core.clock import Clock
from executive.engine.language.amounts import Amount
from executive.engine.language.block_models import (
    CasesBody,
    CooldownBody,
    ForEachBody,
    ObserveBody,
    ParallelBody,
    RepeatBody,
    RetryBody,
    RunOnceBody,
    SwitchBody,
    TimeoutBody,
)
from executive.engine.language.expression import parse_expression
from executive.engine.language.node_models import (
    ChanceNode,
    FailNode,
    NodeModel,
    SetNode,
    UnsetNode,
    WaitForNode,
    WaitNode,
    WhenNode,
)
from executive.engine.language.scope import Scope
from executive.engine.language.values import parse_value
from executive.engine.nodes.choosing import IfThenElse, Switch
from executive.engine.nodes.decorators import (
    Cooldown,
    ForEach,
    Repeat,
    Retry,
    Timeout,
    WhileRunning,
)
from executive.engine.nodes.guards import Guard
from executive.engine.nodes.leaf import Assignment, Condition
from executive.engine.nodes.leaves import Chance, Fail, Unset, Wait, WaitFor
from executive.engine.nodes.observing import Observe
from executive.engine.nodes.parallel import Parallel
from executive.engine.nodes.supervision import Supervision


@dataclass(frozen=True, slots=True)
class Site:
    """Where a node is built, and what it may need there.

    Attributes:
        name: Its name.
        path: Its path.
        scope: Names that it sees.
        clock: The mission's clock.
        supervision: What its leaves answer to.
        children: Its children, in order.
        names: Their names in the file, in order.
        seed: Seed of the run.
    """

    name: str
    path: str
    scope: Scope
    clock: Clock
    supervision: Supervision
    children: Sequence[Behaviour]
    names: Sequence[str]
    seed: int

    @property
    def child(self) -> Behaviour:
        """The child of a decorator."""
        return self.children[0]


def assemble(model: NodeModel, site: Site) -> Behaviour:
    """Return the behaviour of any node that runs no skill and no subtree."""
    return _ASSEMBLERS[model.kind](model, site)


def _when(model: WhenNode, site: Site) -> Behaviour:
    expression = parse_expression(model.when)
    return Condition(site.name, site.path, expression, site.scope, site.supervision)


def _set(model: SetNode, site: Site) -> Behaviour:
    expressions = {key: parse_expression(text) for key, text in model.set.items()}
    return Assignment(site.name, site.path, expressions, site.scope, site.supervision)


def _parallel(model: ParallelBody, site: Site) -> Behaviour:
    count = len(site.children)
    amounts: Mapping[object, int] = {"all": count, "any": 1}
    succeed: int | frozenset[int]
    if isinstance(model.succeed, tuple):
        succeed = frozenset(site.names.index(name) for name in model.succeed)
    else:
        succeed = model.succeed if isinstance(model.succeed, int) else amounts[model.succeed]
    fail = model.fail if isinstance(model.fail, int) else amounts.get(model.fail)
    wait = model.on_done == "wait"
    site.supervision.claims.note_parallel(site.path)
    return Parallel(site.name, site.children, succeed=succeed, fail=fail, wait=wait)


def _retry(model: RetryBody, site: Site) -> Behaviour:
    times, delay_s = (Amount(model, key, site.scope) for key in ("times", "delay_s"))
    return Retry(
        *(site.name, site.child),
        times=times,
        delay_s=delay_s,
        backoff=model.backoff,
        gives_up_on=model.gives_up_on,
        clock=site.clock,
    )


def _repeat(model: RepeatBody, site: Site) -> Behaviour:
    times, delay_s = (Amount(model, key, site.scope) for key in ("times", "delay_s"))
    return Repeat(site.name, site.child, times=times, delay_s=delay_s, clock=site.clock)


def _timeout(model: TimeoutBody, site: Site) -> Behaviour:
    seconds = Amount(model, "seconds", site.scope)
    return Timeout(site.name, site.child, seconds=seconds, clock=site.clock)


def _cooldown(model: CooldownBody, site: Site) -> Behaviour:
    seconds = Amount(model, "seconds", site.scope)
    return Cooldown(site.name, site.child, seconds=seconds, clock=site.clock)


def _run_once(model: RunOnceBody, site: Site) -> Behaviour:
    policies = {
        "finished": OneShotPolicy.ON_COMPLETION,
        "success": OneShotPolicy.ON_SUCCESSFUL_COMPLETION,
    }
    return OneShot(site.name, site.child, policies[model.until])


def _observe(model: ObserveBody, site: Site) -> Behaviour:
    keys = {
        field: reference and reference.removeprefix("$")
        for field, reference in (("status", model.status), ("counts", model.counts))
    }
    return Observe(site.name, site.path, site.child, **keys, scope=site.scope)


def _switch(model: CasesBody, site: Site) -> Behaviour:
    return Switch(
        *(site.name, site.children),
        on=parse_expression(model.on),
        cases=[*model.cases],
        scope=site.scope,
        memory=isinstance(model, SwitchBody),
    )


def _wait(model: WaitNode, site: Site) -> Behaviour:
    seconds = Amount(model, "wait", site.scope)
    return Wait(site.name, site.path, seconds, site.clock, site.supervision)


def _wait_for(model: WaitForNode, site: Site) -> Behaviour:
    expression = parse_expression(model.wait_for)
    return WaitFor(site.name, site.path, expression, site.scope, site.supervision)


def _fail(model: FailNode, site: Site) -> Behaviour:
    return Fail(site.name, site.path, model.fail, model.text, site.supervision)


def _unset(model: UnsetNode, site: Site) -> Behaviour:
    return Unset(site.name, site.path, model.keys, site.scope, site.supervision)


def _chance(model: ChanceNode, site: Site) -> Behaviour:
    probability = Amount(model, "chance", site.scope)
    return Chance(site.name, site.path, probability, site.seed, site.supervision)


def _for_each(model: ForEachBody, site: Site) -> Behaviour:
    return ForEach(
        site.name,
        site.path,
        site.child,
        item=model.item.removeprefix("$"),
        items=parse_value(model.in_),
        scope=site.scope,
    )


_ASSEMBLERS: Mapping[str, Callable[[Any, Site], Behaviour]] = {
    "when": _when,
    "set": _set,
    "sequence": lambda _, site: SequenceNode(site.name, True, [*site.children]),
    "reactive_sequence": lambda _, site: SequenceNode(site.name, False, [*site.children]),
    "selector": lambda _, site: Selector(site.name, True, [*site.children]),
    "reactive_selector": lambda _, site: Selector(site.name, False, [*site.children]),
    "parallel": _parallel,
    "retry": _retry,
    "repeat": _repeat,
    "timeout": _timeout,
    "cooldown": _cooldown,
    "for_each": _for_each,
    "run_once": _run_once,
    "if_then_else": lambda _, site: IfThenElse(site.name, site.children, memory=True),
    "while_do_else": lambda _, site: IfThenElse(site.name, site.children, memory=False),
    "switch": _switch,
    "reactive_switch": _switch,
    "observe": _observe,
    "running_is_success": lambda _, site: WhileRunning(site.name, site.child, says=Status.SUCCESS),
    "running_is_failure": lambda _, site: WhileRunning(site.name, site.child, says=Status.FAILURE),
    "unset": _unset,
    "wait": _wait,
    "wait_for": _wait_for,
    "fail": _fail,
    "chance": _chance,
    "inverter": lambda _, site: Inverter(site.name, site.child),
    "force_success": lambda _, site: FailureIsSuccess(site.name, site.child),
    "force_failure": lambda _, site: SuccessIsFailure(site.name, site.child),
}


def guard(model: NodeModel, name: str, path: str, child: Behaviour, scope: Scope) -> Behaviour:
    """Return the conditions and assignments around a node as a node around it."""
    return Guard(
        name,
        path,
        child,
        conditions={key: parse_expression(text) for key, text in model.guards.items()},
        assignments={
            keyword: {key: parse_expression(text) for key, text in texts.items()}
            for keyword, texts in model.endings.items()
        },
        scope=scope,
    )
