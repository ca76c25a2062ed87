"""The trees that are timed against py_trees do the same there and here, status for status."""

import pytest
from py_trees.blackboard import Blackboard

from benchmarks.tick_trees import Scripts, blocks, cell, chain, our_tree, their_tree
from executive.engine.running.probe import TreeProbe


@pytest.fixture(autouse=True)
def _clean_blackboard():
    Blackboard.clear()
    yield
    Blackboard.clear()


@pytest.mark.parametrize(
    ("shape", "size"),
    [(cell(8), 177), (blocks(100), 100), (chain(10), 10), (chain(200), 200)],
    ids=["cell", "blocks", "chain", "deep chain"],
)
def test_both_trees_do_the_same(shape, size):
    scripts = Scripts(shape, 3), Scripts(shape, 3)
    ours, theirs = our_tree(shape, scripts[0]), their_tree(shape, scripts[1])
    probe = TreeProbe(ours)
    assert len(ours.nodes) == shape.size == size == len(list(theirs.iterate()))
    for number in range(120):
        tick, error = probe.tick(number, number / 10)
        answers = [node.name for node in theirs.tick()]
        assert error is None
        assert [ours.nodes[node].behaviour.name for node in tick.visited][:-1] == answers[:-1]
        assert probe.answer == theirs.status.value
        assert scripts[0].updates == scripts[1].updates


def test_stations_work_fail_and_recover():
    shape = cell(8)
    scripts = Scripts(shape, 0)
    ours, ended = our_tree(shape, scripts), set()
    probe = TreeProbe(ours)
    for number in range(600):
        tick, _ = probe.tick(number, number / 10)
        ended |= {
            (ours.nodes[end.node].name.partition("_")[2], end.status) for end in tick.outcomes
        }
    assert {name for name, status in ended if status == "FAILURE"} >= {"grasp", "place", "blocked"}
    assert {"report", "home"} <= {name for name, status in ended if status == "SUCCESS"}
