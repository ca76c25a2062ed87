"""Rules about nodes with one child that run it again, limit it or change its answer."""

from collections.abc import Iterator

from executive.engine.language.block_models import CooldownBody, RetryBody, TimeoutBody
from executive.engine.language.node_models import FailNode
from executive.engine.language.outline import NodeSpec
from executive.engine.lint.findings import Rule, Spot
from executive.engine.lint.outcomes import number, traits
from executive.engine.lint.subject import Subject


def _unrepeatable(subject: Subject) -> Iterator[Spot]:
    for node, _ in subject.nodes():
        if not traits(node).again_after or "item" in type(node.model).model_fields:
            continue
        for child in node.children:
            skill = subject.outcomes.running_again(child, lambda one: not one.REPEATABLE)
            if skill:
                message = f"runs {skill} again, which cannot be repeated"
                yield Spot(node, f"{message}; try run_once around it, or leave it out")


def _without_effect(subject: Subject) -> Iterator[Spot]:
    for node, above in subject.nodes():
        what = traits(node)
        if len(node.children) != 1:
            continue
        child = subject.outcomes.may(node.children[0])
        if what.again_after == "fail" and not child.fail:
            yield Spot(node, f"{node.children[0].name!r} never fails; drop the {node.model.kind}")
        elif what.ignores and not (child.succeed and child.fail):
            sure = "always succeeds" if child.succeed else "never succeeds"
            is_forced = subject.outcomes.may(node) == child
            if is_forced:
                yield Spot(node, f"{node.children[0].name!r} {sure}; drop the {node.model.kind}")
        elif what.ignores and above and traits(above[-1]).ignores:
            message = f"{above[-1].model.kind} above it ignores the answer"
            yield Spot(node, f"{message}; drop one of the two")
        if isinstance(node.model, RetryBody):
            for code in sorted(set(node.model.gives_up_on) - set(_reasons(subject, node))):
                message = f"nothing below fails with {code!r}"
                yield Spot(node, f"{message}; try another code, or leave it out", ("gives_up_on",))


def _reasons(subject: Subject, node: NodeSpec) -> Iterator[str]:
    """Yield the codes with which skills and `fail` nodes fail that are below a node."""
    for child in subject.outcomes.below(node):
        skill = subject.outcomes.skill(child)
        yield from skill.REASONS if skill is not None else ()
        if isinstance(child.model, FailNode):
            yield child.model.fail
        yield from _reasons(subject, child)


def _late_timeout(subject: Subject) -> Iterator[Spot]:
    for node, above in subject.nodes():
        model = node.model
        if not isinstance(model, TimeoutBody):
            continue
        outer = [_seconds(one) for one in above if isinstance(one.model, TimeoutBody)]
        shortest = min((limit for limit in outer if limit is not None), default=float("inf"))
        seconds = number(model.seconds)
        if not subject.outcomes.may(node.children[0]).run:
            message = f"{node.children[0].name!r} never runs longer than a tick; drop the timeout"
            yield Spot(node, message)
        elif seconds is not None and seconds >= shortest:
            message = f"a timeout above it of {shortest:g} s comes first; try a shorter one"
            yield Spot(node, message, ("seconds",))
    yield from _short_pauses(subject)


def _short_pauses(subject: Subject) -> Iterator[Spot]:
    """Find retries whose pauses alone take longer than the timeout above them."""
    for node, above in subject.nodes():
        if not isinstance(node.model, RetryBody) or not above:
            continue
        if not isinstance(above[-1].model, TimeoutBody):
            continue
        pauses_s, limit_s = _pauses_s(node.model), _seconds(above[-1])
        if pauses_s is not None and limit_s is not None and pauses_s >= limit_s:
            message = f"its pauses take {pauses_s:g} s, the timeout is {limit_s:g} s"
            yield Spot(node, f"{message}; try fewer times or a shorter delay_s", ("delay_s",))


def _past_mission(subject: Subject) -> Iterator[Spot]:
    mission = subject.mission
    limit_s = mission.timeout_s if mission else None
    if limit_s is None:
        return
    for node, _ in subject.expanded():
        seconds = _seconds(node) if isinstance(node.model, TimeoutBody) else None
        if seconds is not None and seconds >= limit_s:
            message = f"mission {subject.tree.name!r} ends after {limit_s:g} s, before this timeout"
            yield Spot(node, f"{message}; try a shorter one", ("seconds",))


def _idle_cooldown(subject: Subject) -> Iterator[Spot]:
    for node, above in subject.expanded():
        if not isinstance(node.model, CooldownBody):
            continue
        if not any(map(_runs_again, above)):
            message = "nothing above it runs it a second time"
            yield Spot(node, f"{message}; drop the cooldown, or repeat it")
    yield from _slow_retries(subject)


def _slow_retries(subject: Subject) -> Iterator[Spot]:
    for node, above in subject.expanded():
        retry = above[-1].model if above else None
        if not isinstance(node.model, CooldownBody) or not isinstance(retry, RetryBody):
            continue
        seconds, delay_s, pauses_s = _seconds(node), number(retry.delay_s), _pauses_s(retry)
        if seconds is None or delay_s is None or pauses_s is None:
            continue
        if delay_s >= seconds:
            yield Spot(node, "the retry above it waits longer; drop the cooldown")
        elif pauses_s < seconds:
            message = "the retry above it uses up its attempts while the child cools down"
            yield Spot(node, f"{message}; try delay_s: {seconds:g} instead of the cooldown")


def _seconds(node: NodeSpec) -> float | None:
    """Return the time that a timeout or a cooldown says, None where a key says it."""
    return number(getattr(node.model, "seconds", ""))


def _pauses_s(retry: RetryBody) -> float | None:
    """Return how long the pauses of a retry are in all [s], None where a key says it."""
    times, delay_s = number(retry.times), number(retry.delay_s)
    return None if times is None or delay_s is None else (times - 1) * delay_s


def _runs_again(node: NodeSpec) -> bool:
    return traits(node).reactive or bool(traits(node).again_after)


UNREPEATABLE = Rule(
    "L105",
    "repeats what cannot be repeated",
    "A skill with `REPEATABLE = False` must not be run again after it has ended, but a retry or "
    "a repeat does so.",
    _unrepeatable,
)
WITHOUT_EFFECT = Rule(
    "L107",
    "decorator without effect",
    "A retry of what never fails, or that gives up on what does not happen; a forced answer that "
    "is forced already.",
    _without_effect,
)
LATE_TIMEOUT = Rule(
    "L110",
    "timeout that cannot come",
    "A timeout around what never runs, or not shorter than one above it; or pauses of a retry "
    "that the timeout above does not leave time for.",
    _late_timeout,
)
PAST_MISSION = Rule(
    "L111",
    "timeout after the mission",
    "A timeout in a mission or its subtrees that is not shorter than the mission's `timeout_s`.",
    _past_mission,
    missions_only=True,
)
IDLE_COOLDOWN = Rule(
    "L112",
    "cooldown without effect",
    "A cooldown around what is run only once, or under a retry that waits longer anyway or "
    "does not wait for it.",
    _idle_cooldown,
    missions_only=True,
)
