"""Documents put together at random: valid ones tick, any others give faults and no traceback."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from toy_language import Journal, toy_skills, toy_types

from executive.core.clock import ManualClock
from executive.core.errors import InputError
from executive.engine.builder import build
from executive.engine.document import KINDS
from executive.engine.loader import load_program

WORDS = st.sampled_from(
    [
        *(*KINDS, "name", "in", "out", "child", "children", "times", "seconds", "item"),
        *("if", "while", "unless", "on_success", "part", "label", "find", "weigh", "work"),
        *("root", "format", "tree", "type", "float", "x > 1", "written(p)", "$p.mass_kg"),
        *("succeed", "all", "3", "$p", "p"),
    ]
)
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers(-2, 3) | st.floats(allow_nan=False) | WORDS,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(WORDS, inner, min_size=1, max_size=3)
    ),
    max_leaves=8,
)

LEAVES = st.sampled_from(
    [
        {"when": "1 < 2"},
        {"when": "n > 1"},
        {"set": {"k": "n + 1"}},
        {"skill": "find"},
        {"skill": "work", "in": {"label": "a"}},
        {"skill": "work", "in": {"label": "b", "ticks": 2, "fails": 1}, "if": "n < 3"},
        {"skill": "work", "in": {"label": "c", "ticks": 3}, "while": "n > 0"},
    ]
)


def blocks(inner):
    children = st.lists(inner, min_size=1, max_size=3)
    kinds = ["sequence", "reactive_sequence", "selector", "reactive_selector", "parallel"]
    plain = st.tuples(st.sampled_from(kinds), children).map(lambda kind: {kind[0]: kind[1]})
    wrapped = st.tuples(
        st.sampled_from(
            [
                ("retry", {"times": 2, "delay_s": 0.1}),
                ("repeat", {"times": 2}),
                ("timeout", {"seconds": 0.3}),
                ("cooldown", {"seconds": 0.3}),
                ("for_each", {"item": "$i", "in": [1, 2]}),
                *((kind, {}) for kind in ("run_once", "inverter", "force_success")),
            ]
        ),
        inner,
    ).map(lambda pair: {pair[0][0]: {**pair[0][1], "child": pair[1]}})
    return plain | wrapped


VALID = st.recursive(LEAVES, blocks, max_leaves=8)


def load(folder, document):
    file = folder / "t.yaml"
    file.write_text(json.dumps(document))
    return load_program(file, skills=toy_skills(), types=toy_types())


def is_refused(folder, document):
    """Return whether a document is refused, and nothing but a refusal is raised."""
    try:
        load(folder, document)
    except InputError:
        return True
    return False


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return one folder for all examples."""
    return tmp_path_factory.mktemp("fuzz")


@settings(max_examples=150, deadline=None)
@given(root=VALID)
def test_valid_trees_tick_and_stop_every_skill_once(folder, root):
    ports = {"n": {"type": "int", "default": 2}}
    program = load(folder, {"format": 1, "tree": "t", "in": ports, "root": root})
    journal, clock = Journal(), ManualClock()
    tree = build(program, devices={"journal": journal}, clock=clock)
    for _ in range(6):
        tree.root.tick_once()
        clock.sleep_until(clock.now_s() + 0.1)
    tree.root.stop(tree.root.status.INVALID)
    ended = [line for line in journal.lines if not line.endswith("starts")]
    assert len(ended) == len(journal.lines) - len(ended)
    assert len({node.path for node in tree.nodes}) == len(tree.nodes)


@settings(max_examples=300, deadline=None)
@given(root=ANYTHING, more=st.dictionaries(WORDS, ANYTHING, max_size=2))
def test_any_document_loads_or_is_refused(folder, root, more):
    is_refused(folder, {"format": 1, "tree": "t", "root": root, **more})


@pytest.mark.parametrize("depth", [20, 100, 150, 400])
def test_a_file_is_refused_when_it_is_nested_too_deeply(folder, depth):
    root = {"when": "true"}
    for _ in range(depth):
        root = {"inverter": {"child": root}}
    assert is_refused(folder, {"format": 1, "tree": "t", "root": root}) is (depth > 100)


def test_subtrees_may_not_make_a_tree_deeper_than_ticks_can_go(bench):
    root = "{when: true}"
    for i in range(3):
        root = "{inverter: {child: " * 80 + root + "}}" * 80
        bench.write_root(root, name=f"deep_{i}")
        root = f"{{subtree: deep_{i}}}"
    assert bench.faults(root) == ["t: 241 nodes deep; expected 200 at most"]
