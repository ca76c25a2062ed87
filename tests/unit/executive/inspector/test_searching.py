"""Ticks as lists and by search, held against the statuses themselves."""

import itertools

import numpy as np
import pytest
from toy_pasts import RandomTree, act, past
from toy_runs import busy_tree, record

from executive.core.errors import InputError
from executive.engine.blackboard import Blackboard
from executive.inspector.index import INVALID, RUNNING, STATUSES, RunIndex
from executive.inspector.names import Names, shortest_suffixes, split_at
from executive.inspector.past import PastRun
from executive.inspector.search import Question, search, spans
from executive.inspector.tick_list import Stretch, TickEvents, TickFilter, tick_list


@pytest.fixture
def busy(tmp_path):
    board = Blackboard()
    return PastRun(record(tmp_path / "busy.mcap", busy_tree(board), board)[0])


def everything(run, **limits):
    nodes = frozenset(range(len(run.index.nodes)))
    return TickFilter(
        **{"nodes": nodes, "keys": None, "first": 0, "last": len(run.index) - 1} | limits
    )


def test_the_index_holds_the_statuses_of_the_recording(busy):
    for tick in range(0, len(busy.index), 37):
        statuses = [STATUSES[code] for code in busy.index.statuses[tick]]
        assert tuple(statuses) == busy.recording.statuses(tick)
        assert set(busy.index.asked(tick).tolist()) == set(busy.recording.tick(tick).visited)


def test_lives_of_a_node_cover_its_running_ticks_and_nothing_else(busy):
    for node in range(len(busy.index.nodes)):
        running = np.zeros(len(busy.index), np.bool_)
        lives = busy.index.activations(node)
        for life in lives:
            running[life.start : life.end] = True
        assert (running == (busy.index.statuses[:, node] == RUNNING)).all()
        for before, after in itertools.pairwise(lives):
            assert before.end <= after.start


def test_every_tick_is_told_once_or_stands_in_a_stretch(busy):
    told = []
    for item in tick_list(busy.index, everything(busy)):
        told += range(item.first, item.last + 1) if isinstance(item, Stretch) else [item.tick]
    assert told == list(range(len(busy.index)))


def test_what_is_told_and_repeated_is_what_happened(busy):
    """Play the list back: told ticks and repetitions give the statuses of the recording."""
    index = busy.index
    status = {node.path: "INVALID" for node in index.nodes}
    recent = []
    for item in tick_list(index, everything(busy)):
        ticks = [item]
        if isinstance(item, Stretch):
            pattern = recent[-item.period :] if item.period else [None]
            count = item.last - item.first + 1
            ticks = [pattern[i % len(pattern)] for i in range(count)]
        for number, tick in enumerate(ticks):
            at = item.first + number if isinstance(item, Stretch) else item.tick
            for event in tick.events if tick else ():
                if event.what in ("RUNNING", "SUCCESS", "FAILURE", "INVALID"):
                    status[event.name] = event.what
            for node, recorded in enumerate(index.nodes):
                put_back = (
                    index.statuses[at, node] == INVALID and status[recorded.path] != "RUNNING"
                )
                if not put_back:
                    assert status[recorded.path] == STATUSES[index.statuses[at, node]].value
        if isinstance(item, TickEvents):
            recent.append(item)


def test_ticks_in_which_nothing_happens_are_one_line(tmp_path):
    run = past(
        tmp_path, f"{{sequence: [{act('one')}, {act('two')}]}}", {"one": "R" * 40 + "S", "two": "S"}
    )
    told = list(tick_list(run.index, everything(run)))
    assert [item.tick for item in told if isinstance(item, TickEvents)] == [0, 40]
    assert [(i.first, i.last) for i in told if isinstance(i, Stretch)] == [(1, 39)]


def test_a_pattern_that_repeats_is_told_once(tmp_path):
    root = f"{{retry: {{times: 50, child: {{sequence: [{act('one')}, {act('two')}]}}}}}}"
    run = past(tmp_path, root, {"one": "RS" * 60, "two": "F"})
    stretches = [i for i in tick_list(run.index, everything(run)) if isinstance(i, Stretch)]
    assert [s.period for s in stretches] == [2]
    assert stretches[0].last >= 97


QUESTIONS = [
    "count > 100 and status('hold') == RUNNING",
    "status('guard') == FAILURE",
    "status('wait/*') != RUNNING",
    "halted('hold') or count == 84",
    "asked('work') and time_s > 30.0",
    "written(count) and not wrote('count') and tick < 20",
    "key('toy:count') >= 590",
    "status('*') in [RUNNING]",
]


@pytest.mark.parametrize("text", QUESTIONS)
def test_a_search_finds_just_the_ticks_at_which_it_is_true(busy, text):
    question, found = Question(text, busy.index), []
    for tick in range(len(busy.index)):
        try:
            found += [tick] if question.holds(tick) else []
        except InputError:
            continue
    assert search(busy.index, text) == found


def test_searches_agree_with_the_recording(busy):
    hold = busy.names.node("hold")
    expected = [t for t in range(len(busy.index)) if busy.index.statuses[t, hold] == RUNNING]
    assert search(busy.index, "status('hold') == RUNNING") == expected
    assert expected
    wrote = [t.number for t in busy.recording.ticks() if t.writes]
    assert search(busy.index, "wrote('count')") == wrote


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("cuont > 3", "did you mean 'count'"),
        ("status('gaurd') == RUNNING", "did you mean 'guard'"),
        ("status(guard) == RUNNING", "one text in quotes"),
        ("count +", "not an expression"),
        ("count", "expected true or false"),
        ("count.size > 3", "size"),
        ("__import__('os')", "unknown function"),
    ],
)
def test_a_bad_question_says_what_is_wrong(busy, text, message):
    with pytest.raises(InputError, match=message):
        search(busy.index, text)


def test_stretches_of_ticks():
    assert list(spans([3, 4, 5, 9, 11, 12])) == [(3, 5), (9, 9), (11, 12)]
    assert list(spans([])) == []


@pytest.mark.parametrize("seed", range(5))
def test_short_names_lead_back_to_their_nodes(tmp_path, seed):
    tree = RandomTree(seed)
    run = past(tmp_path, tree.root, tree.letters(tree.random_answers()))
    for node in range(len(run.index.nodes)):
        assert run.names.node(run.names.short(node)) == node
        assert run.names.node(run.index.nodes[node].path) == node


def test_names_that_fit_several_nodes_are_refused_with_all_of_them():
    assert shortest_suffixes(["a", "a/b", "a/c/b"]) == ["a", "a/b", "c/b"]


def test_ticks_can_be_named_in_several_ways(busy):
    names = Names(busy.index)
    last = busy.index.last_tick
    assert [names.tick(t) for t in ("41", "-1", "last", "first", "12.3s")] == [
        41,
        last,
        last,
        0,
        123,
    ]
    assert split_at("a/b@-1") == ("a/b", "-1")
    assert split_at("a/b") == ("a/b", None)
    for wrong in ("99999", "soon"):
        with pytest.raises(InputError, match="expected"):
            names.tick(wrong)


def test_the_index_needs_no_sources(busy):
    assert busy.trees.nodes == {}
    assert isinstance(RunIndex(busy.recording), RunIndex)
