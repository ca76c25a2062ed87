"""Documents put together at random: valid ones tick, any others give faults and no traceback."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from toy_language import toy_skills, toy_types

from benchmarks.fuzz import Bench
from benchmarks.random_documents import ANYTHING, INNER, ROOTS, WORDS, document, spoiled
from executive.core.errors import InputError
from executive.engine.language.block_models import KINDS
from executive.engine.loading.loader import load_program


def is_refused(folder, document):
    """Return whether a document is refused, and nothing but a refusal is raised."""
    file = folder / "t.yaml"
    file.write_text(json.dumps(document))
    try:
        load_program(file, skills=toy_skills(), types=toy_types())
    except InputError:
        return True
    return False


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return one folder for all examples."""
    return tmp_path_factory.mktemp("fuzz")


@pytest.fixture(scope="module")
def trial(folder):
    """Return what tries documents as the benchmark does."""
    return Bench(folder)


@settings(max_examples=100, deadline=None)
@given(root=ROOTS)
def test_valid_trees_tick_and_stop_every_skill_once(trial, root):
    trial.try_valid(root)
    assert (trial.tracebacks, trial.broken) == ([], [])


@settings(max_examples=150, deadline=None)
@given(text=spoiled())
def test_spoiled_documents_give_faults_and_no_traceback(trial, text):
    trial.try_spoiled(text)
    assert trial.tracebacks == []


@settings(max_examples=150, deadline=None)
@given(root=ANYTHING, more=st.dictionaries(WORDS, ANYTHING, max_size=2))
def test_any_document_loads_or_is_refused(folder, root, more):
    is_refused(folder, {"format": 1, "tree": "t", "root": root, **more})


def test_random_trees_are_made_of_every_kind_of_node():
    """Every kind is in the tables that the trees are drawn from."""
    drawn = set()

    @settings(max_examples=400, deadline=None, derandomize=True, database=None)
    @given(root=ROOTS)
    def draw(root):
        text = json.dumps(document(root)) + INNER
        drawn.update(kind for kind in KINDS if f'"{kind}"' in text)

    draw()
    assert set(KINDS) - drawn == set()


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
