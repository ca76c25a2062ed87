"""Two runs compared: nothing where they are equal, the planted difference first where not."""

import pytest
from toy_pasts import RandomTree, act, past

from executive.inspector.diff import DiffKind, diff_runs, first_difference
from executive.inspector.diff_text import diff_lines


@pytest.mark.parametrize("seed", range(8))
def test_a_run_does_not_differ_from_itself(tmp_path, seed):
    tree = RandomTree(seed)
    letters = tree.letters(tree.random_answers())
    one = past(tmp_path, tree.root, letters)
    again = past(tmp_path, tree.root, letters, name="again")
    for other in (one, again):
        diff = diff_runs(one, other)
        assert diff.first == ()
        assert diff.consequences == ()
        assert not diff.differs(DiffKind.TIMING)


@pytest.mark.parametrize("seed", range(25))
def test_the_first_outcome_that_differs_is_the_planted_one(tmp_path, seed):
    tree = RandomTree(seed)
    says = tree.random_answers()
    one = past(tmp_path, tree.root, tree.letters(says))
    ran = [name for name in tree.leaves if one.index.activations(one.names.node(name))]
    planted = ran[seed % len(ran)]
    # Every leaf also takes another while: what is later is not therefore different.
    other = past(tmp_path, tree.root, tree.letters(says | {planted: not says[planted]}), name="b")
    diff = diff_runs(one, other)
    first = next(d for d in diff.first if d.kind is DiffKind.OUTCOME)
    assert first.name.endswith(f"/{planted}")
    assert planted in {c.path.rpartition("/")[2] for c in diff.consequences}


PIPE = f"""
sequence:
  - {act("look", value="$size_m")[:-1]}, out: {{value: $seen}}}}
  - {{set: {{twice: seen * 2}}, name: double}}
  - {act("work", value="$twice")}
"""
PORTS = "in: {size_m: {type: float, default: 1.0}}"


def test_a_value_is_named_with_its_key_and_its_origin(tmp_path):
    letters = {"look": "S", "work": "RRS"}
    one = past(tmp_path, PIPE, letters, PORTS)
    other = past(tmp_path, PIPE, letters, PORTS, name="b", inputs={"size_m": 1.5})
    diff = diff_runs(one, other)
    assert "inputs" in diff.before[0]
    assert [(d.kind, d.name) for d in diff.first] == [(DiffKind.VALUE, "t:size_m")]
    assert diff.first[0].detail == "the value is 1.0 in A, 1.5 in B"
    later = diff_runs(one, other, ignored=["t:size_m"])
    assert later.first[0].name == "t:seen"
    assert "written by look" in later.first[0].a.what
    assert diff_runs(one, other, ignored=["t:*"]).first == ()
    assert diff.differs(DiffKind.VALUE)
    assert not diff.differs(DiffKind.OUTCOME)


def test_an_outcome_names_the_values_that_it_had_read(tmp_path):
    one = past(tmp_path, PIPE, {"look": "S", "work": "RS"}, PORTS)
    other = past(
        tmp_path, PIPE, {"look": "S", "work": "RF"}, PORTS, name="b", inputs={"size_m": 3.0}
    )
    diff = diff_runs(one, other, ignored=["size_m", "t:size_m"])
    (outcome,) = [d for d in diff.first if d.kind is DiffKind.OUTCOME]
    assert outcome.name == "t/work"
    assert outcome.inputs == ("t:twice",)
    same = diff_runs(one, past(tmp_path, PIPE, {"look": "S", "work": "RF"}, PORTS, name="c"))
    (outcome,) = same.first
    assert outcome.inputs == ()
    text = "\n".join(line.plain for line in diff_lines(same, one))
    assert text.startswith(
        "they differ first in the outcome of work, at tick 1 of A and tick 1 of B"
    )
    assert "the same recorded inputs" in text


def test_timing_alone_is_the_least_of_differences(tmp_path):
    one = past(tmp_path, PIPE, {"look": "RS", "work": "RS"}, PORTS)
    other = past(tmp_path, PIPE, {"look": "RRRS", "work": "RS"}, PORTS, name="b")
    diff = diff_runs(one, other)
    assert [(d.kind, d.name) for d in diff.first] == [(DiffKind.TIMING, "t/look")]
    assert diff.first[0].detail == "took 0.10 s in A, 0.30 s in B"
    assert diff.differs(DiffKind.TIMING)
    assert not diff.differs(DiffKind.VALUE)


def test_a_changed_tree_is_shown_with_its_line(tmp_path):
    one = past(tmp_path, PIPE, {"look": "S", "work": "S"}, PORTS)
    changed = PIPE.replace("seen * 2", "seen * 3")
    other = past(tmp_path, changed, {"look": "S", "work": "S"}, PORTS, name="b")
    diff = diff_runs(one, other)
    assert any("t.yaml was changed: line 7" in line and "seen * 3" in line for line in diff.before)
    assert diff.first[0].name == "t:twice"


def test_how_often_a_reactive_condition_is_asked_is_no_outcome(tmp_path):
    root = f"""
    reactive_sequence:
      - {{when: true, name: open}}
      - {act("work")}
    """
    one = past(tmp_path, root, {"work": "RRS"})
    other = past(tmp_path, root, {"work": "RRRRRS"}, name="b")
    assert [d.kind for d in diff_runs(one, other).first] == [DiffKind.TIMING]


def test_first_difference_names_the_field():
    a = {"$type": "x.Trace", "points": [[1, 2], [3, 4]], "end": "edge"}
    b = {"$type": "x.Trace", "points": [[1, 2], [3, 5]], "end": "edge"}
    assert first_difference(a, b) == ".points[1][1] is 4 in A, 5 in B"
    assert first_difference(a, a) == ""
    assert first_difference([1], [1, 2]) == "the value has 1 items in A, 2 in B"
