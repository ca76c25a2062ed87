"""A run that is ticked again decides as it did, on any tree; a flip changes what it must."""

import json

import pytest
from hypothesis import given, settings
from toy_language import toy_types
from toy_reticks import KEEP, TICK_HZ, MoodyTrees, recorded

from benchmarks.random_documents import ROOTS
from executive.core.outcome import Status, failure, success
from executive.engine.ticks import NodeStatus
from executive.inspector.retick.retick import retick
from executive.inspector.retick.standins import WhatIf


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return one folder for all examples."""
    return tmp_path_factory.mktemp("retick")


@settings(max_examples=50, deadline=None)
@given(root=ROOTS)
def test_random_trees_of_every_kind_decide_as_they_did(folder, root):
    run = recorded(folder, root, seed=len(json.dumps(root)))
    found = retick(run, toy_types())
    assert found.first is None
    assert found.identical
    assert found.ticks == run.index.last_tick + 1


@pytest.mark.parametrize("seed", range(10))
def test_forcing_what_a_node_answered_anyway_changes_nothing(tmp_path, seed):
    run = recorded(tmp_path, MoodyTrees(seed).root(), ports=KEEP)
    for tick in range(run.index.last_tick + 1):
        for node in run.index.asked(tick).tolist():
            answered = Status[run.index.answer(node, tick).name]
            assert retick(run, toy_types(), what_if=WhatIf(tick, {node: answered})).identical


def forcing(tick, node, status):
    """Return what makes an interceptor that answers for a node in one tick of a live run."""

    def make(tree):
        def intercept(junction):
            def answer():
                now = round(tree.clock.now_s() * TICK_HZ)
                return junction.answer(OUTCOMES[status]) if now == tick else junction.tick()

            return answer if junction.index == node else junction.tick

        return intercept

    return make


def differing(one, other, tick):
    """Return the nodes that do something else in a tick of another run, one by one."""
    found = set()
    for node, info in enumerate(one.index.nodes):
        a, b = (run.index.answers[tick, node] for run in (one, other))
        halted = [run.index.halted_by(node, tick) for run in (one, other)]
        after = [run.index.statuses[tick, node] for run in (one, other)]
        if a != b or halted[0] != halted[1] or (b and after[0] != after[1]):
            found.add(info.path)
    return found


FLIPPED = {NodeStatus.SUCCESS: Status.FAILURE, NodeStatus.FAILURE: Status.SUCCESS}
OUTCOMES = {Status.SUCCESS: success(), Status.FAILURE: failure("flipped")}


@pytest.mark.parametrize("seed", range(15))
def test_one_flipped_condition_changes_what_it_changes_in_a_live_run(tmp_path, seed):
    root = MoodyTrees(seed).root()
    run = recorded(tmp_path, root, ports=KEEP)
    flips = [
        (tick, node)
        for tick in range(run.index.last_tick + 1)
        for node in run.index.asked(tick).tolist()
        if run.index.nodes[node].kind in ("when", "guard")
        and run.index.answer(node, tick) in FLIPPED
    ]
    for tick, node in flips[:: max(1, len(flips) // 6)]:
        flipped = FLIPPED[run.index.answer(node, tick)]
        live = recorded(
            tmp_path, root, ports=KEEP, name="live", interceptors=[forcing(tick, node, flipped)]
        )
        found = retick(run, toy_types(), what_if=WhatIf(tick, {node: flipped}))
        assert found.first.tick == tick
        names = {each.path for each in found.first.nodes}
        outside = found.outside[0] if found.outside else None
        if outside is None or outside.tick > tick:
            assert names == differing(run, live, tick)
        else:
            assert names <= differing(run, live, tick)
            asked = run.index.indices[outside.path]
            assert live.index.answers[tick, asked]
            assert not run.index.answers[tick, asked]
        assert found.causes == (f"{run.names.short(node)} was forced",)
