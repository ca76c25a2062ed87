"""Plain calls do what py_trees' generators do, on any tree; and nobody's halt is missed."""

import sys
from contextlib import suppress
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from py_trees.behaviour import Behaviour
from py_trees.common import OneShotPolicy, ParallelPolicy, Status
from py_trees.composites import Parallel as ForeignParallel
from py_trees.composites import Selector, Sequence
from py_trees.decorators import (
    Condition,
    Decorator,
    EternalGuard,
    FailureIsSuccess,
    Inverter,
    OneShot,
    RunningIsFailure,
)
from py_trees.decorators import Retry as ForeignRetry

from executive.core.clock import ManualClock
from executive.engine.blackboard import Blackboard
from executive.engine.nodes.choosing import IfThenElse
from executive.engine.nodes.decorators import Cooldown, Repeat, Retry, Timeout
from executive.engine.nodes.gated import Gated
from executive.engine.nodes.parallel import Parallel
from executive.engine.nodes.supervision import Supervision
from executive.engine.nodes.ticking import NODE_STATUS, DirectTicks
from executive.engine.running.probe import TreeProbe
from executive.engine.running.stopping import stop_running
from executive.engine.ticks import NodeStatus

RUNNING, SUCCESS, FAILURE, INVALID = (
    Status.RUNNING,
    Status.SUCCESS,
    Status.FAILURE,
    Status.INVALID,
)
TICKS = 12
DEEPEST = 200


class BrokenError(Exception):
    """What leaves of these tests raise."""


class Scripted(Behaviour):
    """Answers from a list, over and over, and writes every call into a journal."""

    def __init__(self, name, answers, journal):
        super().__init__(name)
        self._answers, self._journal, self._asked = answers, journal, 0

    def initialise(self):
        self._journal.append((self.name, "initialise"))

    def update(self):
        self._journal.append((self.name, "update"))
        answer = self._answers[self._asked % len(self._answers)]
        self._asked += 1
        if answer == "raise":
            raise BrokenError(self.name)
        return answer

    def terminate(self, new_status):
        self._journal.append((self.name, "terminate", self.status, new_status))


class Noting(Decorator):
    """A decorator of py_trees' kind that notes its calls as well."""

    def __init__(self, name, child, journal):
        super().__init__(name, child)
        self._journal = journal

    def initialise(self):
        self._journal.append((self.name, "initialise"))

    def update(self):
        return self.decorated.status

    def terminate(self, new_status):
        self._journal.append((self.name, "terminate", self.status, new_status))


class Fussy(Sequence):
    """A composite with a `stop` of its own."""

    def stop(self, new_status=INVALID):
        super().stop(new_status)
        self.feedback_message = "stopped"


class Gate(Gated):
    """Answers by itself in every third tick."""

    def __init__(self, name, child, journal):
        super().__init__(name, child)
        self._journal, self._asked = journal, 0

    def before(self):
        self._asked += 1
        return None if self._asked % 3 else self.fail("gate.closed", f"asked {self._asked} times")

    def terminate(self, new_status):
        self._journal.append((self.name, "terminate", self.status, new_status))


class World:
    """What the nodes of one tree share."""

    def __init__(self):
        self.journal, self.clock, self.count = [], ManualClock(), 0

    def name(self, kind):
        self.count += 1
        return f"{kind}{self.count}"


COMPOSITES = {
    "sequence": lambda name, children, _: Sequence(name, True, children),
    "reactive_sequence": lambda name, children, _: Sequence(name, False, children),
    "selector": lambda name, children, _: Selector(name, True, children),
    "reactive_selector": lambda name, children, _: Selector(name, False, children),
    "all": lambda name, children, _: Parallel(
        name, children, succeed=len(children), fail=None, wait=False
    ),
    "any": lambda name, children, _: Parallel(name, children, succeed=1, fail=1, wait=True),
    "first": lambda name, children, _: Parallel(
        name, children, succeed=frozenset({0}), fail=2, wait=False
    ),
    "foreign_parallel": lambda name, children, _: ForeignParallel(
        name, ParallelPolicy.SuccessOnOne(), children
    ),
    "choose_once": lambda name, children, _: IfThenElse(name, children, memory=True),
    "choose": lambda name, children, _: IfThenElse(name, children, memory=False),
    "fussy": lambda name, children, _: Fussy(name, True, children),
}
DECORATORS = {
    "inverter": lambda name, child, _: Inverter(name, child),
    "force": lambda name, child, _: FailureIsSuccess(name, child),
    "once": lambda name, child, _: OneShot(name, child, OneShotPolicy.ON_COMPLETION),
    "retry": lambda name, child, w: Retry(name, child, times=2, delay_s=0.1, clock=w.clock),
    "repeat": lambda name, child, w: Repeat(name, child, times=2, clock=w.clock),
    "timeout": lambda name, child, w: Timeout(name, child, seconds=0.3, clock=w.clock),
    "cooldown": lambda name, child, w: Cooldown(name, child, seconds=0.2, clock=w.clock),
    "noting": lambda name, child, w: Noting(name, child, w.journal),
    "gate": lambda name, child, w: Gate(name, child, w.journal),
    "eternal": lambda name, child, w: EternalGuard(
        name, child, lambda: round(w.clock.now_s() * 10) % 4 != 3
    ),
    "condition": lambda name, child, _: Condition(name, child, SUCCESS),
    "running_is_failure": lambda name, child, _: RunningIsFailure(name, child),
    "foreign_retry": lambda name, child, _: ForeignRetry(name, child, 2),
}


def plans(answers):
    """Return descriptions of trees: a list of answers, or a kind with what is below it."""
    leaf = st.tuples(st.just("leaf"), st.lists(st.sampled_from(answers), min_size=1, max_size=4))
    return st.recursive(
        leaf,
        lambda inner: st.one_of(
            st.tuples(st.sampled_from([*COMPOSITES]), st.lists(inner, min_size=1, max_size=4)),
            st.tuples(st.sampled_from([*DECORATORS]), inner),
        ),
        max_leaves=12,
    )


def grow(plan, world):
    """Make the nodes of a plan."""
    kind, below = plan
    name = world.name(kind)
    if kind == "leaf":
        return Scripted(name, below, world.journal)
    if kind in COMPOSITES:
        return COMPOSITES[kind](name, [grow(each, world) for each in below], world)
    return DECORATORS[kind](name, grow(below, world), world)


def preorder(node):
    return [node, *(below for child in node.children for below in preorder(child))]


def states(nodes):
    return [
        (node.name, node.status, getattr(node, "current_child", None) and node.current_child.name)
        for node in nodes
    ]


def by_generators(root):
    return [(node.name, node.status) for node in root.tick()]


class ByCalls:
    def __init__(self, root):
        self._nodes = preorder(root)
        self.direct = DirectTicks(root, self._nodes)

    def tick(self):
        self.direct.tick()
        log = self.direct.log
        broken = [node.name for node in log.broken]
        named = [(self._nodes[i].name, Status[status.value]) for i, status in log.events]
        return [(name, s) for name, s in named if s is not INVALID or name in broken]


@settings(max_examples=400, deadline=None)
@given(plans([RUNNING, SUCCESS, FAILURE]))
def test_statuses_answers_and_calls_are_those_of_generators(plan):
    theirs, ours = World(), World()
    root, same = grow(plan, theirs), grow(plan, ours)
    calls = ByCalls(same)
    for _ in range(TICKS):
        assert calls.tick() == by_generators(root)
        assert states(preorder(same)) == states(preorder(root))
        assert ours.journal == theirs.journal
        for world in (theirs, ours):
            world.clock.sleep_until(world.clock.now_s() + 0.1)


@settings(max_examples=200, deadline=None)
@given(plans([RUNNING, SUCCESS, FAILURE]), st.lists(st.booleans(), min_size=6, max_size=6))
def test_both_ways_can_take_turns(plan, turns):
    theirs, ours = World(), World()
    root, same = grow(plan, theirs), grow(plan, ours)
    calls = ByCalls(same)
    for direct in turns:
        calls.tick() if direct else same.tick_once()
        root.tick_once()
        assert states(preorder(same)) == states(preorder(root))
        assert ours.journal == theirs.journal


@settings(max_examples=200, deadline=None)
@given(plans([RUNNING, SUCCESS, FAILURE, None, "SUCCESS"]))
def test_an_answer_that_is_no_status_makes_the_same_mess(plan):
    theirs, ours = World(), World()
    root, same = grow(plan, theirs), grow(plan, ours)
    calls = ByCalls(same)
    for _ in range(TICKS):
        answers = by_generators(root)
        calls.tick()
        assert states(preorder(same)) == states(preorder(root))
        assert ours.journal == theirs.journal
        first = next((name for name, status in answers if status is INVALID), None)
        broken = calls.direct.log.broken
        assert (broken[0].name if broken else None) == first


@settings(max_examples=200, deadline=None)
@given(plans([RUNNING, SUCCESS, FAILURE, "raise"]))
def test_what_raised_is_the_leaf_that_raised(plan):
    world = World()
    calls = ByCalls(grow(plan, world))
    log = calls.direct.log
    for _ in range(TICKS):
        with suppress(BrokenError):
            calls.tick()
        updates = [line for line in world.journal if line[1] == "update"]
        if log.raised is not None:
            assert (log.raised.name, log.terminating) == (updates[-1][0], False)
            return


def probe_of(root):
    nodes = []

    def visit(node, parent):
        index = len(nodes)
        nodes.append(
            SimpleNamespace(index=index, path=node.name, type="", parent=parent, behaviour=node)
        )
        for child in node.children:
            visit(child, index)

    visit(root, None)
    parts = {"blackboard": Blackboard(), "supervision": Supervision()}
    return TreeProbe(SimpleNamespace(root=root, nodes=tuple(nodes), **parts))


def looked_at_everywhere(root, nodes, before):
    """Return answers in order, changes and halted nodes: from the statuses of all nodes."""
    index = {id(node): i for i, node in enumerate(nodes)}
    answers = {}
    for node in root.tick():
        answers[index[id(node)]] = node.status
    after = [node.status for node in nodes]
    changes = [
        (i, now) for i, (was, now) in enumerate(zip(before, after, strict=True)) if was != now
    ]
    halted = [
        i for i, now in enumerate(after) if now is INVALID and answers.get(i, before[i]) is RUNNING
    ]
    return answers, changes, halted, after


@settings(max_examples=300, deadline=None)
@given(plans([RUNNING, SUCCESS, FAILURE]))
def test_what_a_tick_changed_is_what_looking_at_every_node_finds(plan):
    theirs, ours = World(), World()
    root, probe = grow(plan, theirs), probe_of(grow(plan, ours))
    nodes = preorder(root)
    statuses = [INVALID] * len(nodes)
    for number in range(TICKS):
        tick, error = probe.tick(number, 0.0)
        answers, changes, halted, statuses = looked_at_everywhere(root, nodes, statuses)
        assert error is None
        assert tick.visited == tuple(answers)
        assert list(tick.changes) == [(i, NODE_STATUS[status]) for i, status in changes]
        assert [halt.node for halt in tick.halts] == halted
        assert all(statuses[halt.by] is not INVALID for halt in tick.halts if halt.by >= 0)
        assert list(probe.answers) == list(answers)
        for world in (theirs, ours):
            world.clock.sleep_until(world.clock.now_s() + 0.1)


@settings(max_examples=200, deadline=None)
@given(plans([RUNNING, RUNNING, SUCCESS, FAILURE, "raise"]))
def test_after_an_error_every_node_that_runs_is_stopped_once_and_seen(plan):
    world = World()
    root = grow(plan, world)
    probe, told = probe_of(root), {}
    for number in range(TICKS):
        tick, error = probe.tick(number, 0.0)
        told.update(tick.changes)
        if error is not None:
            break
    world.journal.clear()
    stop_running(root, probe.raised, lambda node, cause: pytest.fail(str(cause)))
    told.update(probe.record_end(TICKS, 0.0, ()).changes)
    stopped = [name for name, call, *_ in world.journal if call == "terminate"]
    assert len(stopped) == len(set(stopped))
    nodes = preorder(root)
    assert RUNNING not in {node.status for node in nodes}
    assert [told.get(i, NodeStatus.INVALID) for i in range(len(nodes))] == [
        NODE_STATUS[node.status] for node in nodes
    ]


def test_who_raised_in_terminate_is_not_stopped_again():
    world = World()
    ends = Scripted("ends", [RUNNING], world.journal)
    ends.terminate = lambda status: world.journal.append(("ends", "terminate")) or 1 / 0
    other = Scripted("other", [RUNNING], world.journal)
    first = Scripted("first", [FAILURE, SUCCESS], world.journal)
    root = Selector("ways", False, [first, Sequence("both", True, [ends]), other])
    probe = probe_of(root)
    probe.tick(0, 0.0)
    _, error = probe.tick(1, 0.0)
    assert (error.path, type(error.__cause__)) == ("ends", ZeroDivisionError)
    assert probe.raised is None
    assert stop_running(root, probe.raised, probe.error_of) == []
    assert [line for line in world.journal if line[:2] == ("ends", "terminate")] == [
        ("ends", "terminate")
    ]


def chain(depth, world, wrap):
    node = Scripted("leaf", [RUNNING, SUCCESS], world.journal)
    for level in range(depth - 1):
        node = wrap(f"level{level}", node)
    return node


@pytest.mark.parametrize(
    "wrap",
    [
        lambda name, child: Retry(name, child, times=2, delay_s=0.0, clock=ManualClock()),
        lambda name, child: Sequence(name, True, [child]),
        lambda name, child: Parallel(name, [child], succeed=1, fail=None, wait=False),
    ],
    ids=["decorators", "sequences", "parallels"],
)
def test_a_tree_of_the_greatest_depth_ticks_and_stops(wrap):
    root = chain(DEEPEST, World(), wrap)
    probe = probe_of(root)
    for number, status in enumerate([RUNNING, SUCCESS, RUNNING]):
        tick, error = probe.tick(number, 0.0)
        assert (error, root.status, len(tick.visited)) == (None, status, DEEPEST)
    root.stop(INVALID)


def test_depth_costs_no_more_than_breadth():
    """Counts function calls, not seconds: a generator would make depth * depth / 2 of them."""

    def calls(depth):
        world = World()
        probe = probe_of(chain(depth, world, lambda name, child: Inverter(name, child)))
        probe.tick(0, 0.0)
        count = 0

        def count_calls(frame, event, _):
            nonlocal count
            count += event == "call"

        sys.setprofile(count_calls)
        probe.tick(1, 0.0)
        sys.setprofile(None)
        return count

    assert calls(200) < 2.2 * calls(100)
