"""Nodes that pick a branch."""

import pytest

GO = "in: {go: {type: bool}}"
WORD = "in: {word: {type: str}}"


def branches(kind):
    return f"""
    {kind}:
      - {{when: go}}
      - {{skill: work, in: {{label: yes, ticks: 3}}}}
      - {{skill: work, in: {{label: no, ticks: 3}}}}
    """


@pytest.mark.parametrize("kind", ["if_then_else", "while_do_else"])
@pytest.mark.parametrize(("go", "label"), [(True, "yes"), (False, "no")])
def test_the_condition_picks_the_branch(bench, kind, go, label):
    answer, lines = bench.run(branches(kind), GO, go=go)
    assert (answer, lines) == ("SUCCESS", [f"{label} starts", f"{label} ends"])


def test_if_then_else_stays_with_its_branch(bench):
    tree = bench.build(branches("if_then_else"), GO, go=True)
    bench.tick()
    tree.scope.write("go", False, "test")
    assert bench.tick(2) == ["RUNNING", "SUCCESS"]
    assert bench.journal.lines == ["yes starts", "yes ends"]


def test_while_do_else_changes_branches_and_halts_the_other(bench):
    tree = bench.build(branches("while_do_else"), GO, go=True)
    bench.tick()
    tree.scope.write("go", False, "test")
    bench.tick()
    tree.scope.write("go", True, "test")
    assert bench.tick(3) == ["RUNNING", "RUNNING", "SUCCESS"]
    assert bench.journal.lines == [
        *("yes starts", "yes stops", "no starts", "no stops", "yes starts", "yes ends"),
    ]


def test_a_branch_that_fails_is_not_replaced_by_the_other(bench):
    answer, _ = bench.run("if_then_else: [{when: true}, {when: false}, {when: true}]")
    assert answer == "FAILURE"


def test_without_a_third_child_a_false_condition_fails(bench):
    assert bench.run("if_then_else: [{when: false}, {when: true}]")[0] == "FAILURE"
    assert bench.run("while_do_else: [{when: true}, {when: true}]")[0] == "SUCCESS"


def test_neither_branch_runs_while_the_condition_does(bench):
    bench.build(
        "while_do_else: [{sequence: [{wait: 0.15}, {when: true}]}, "
        "{skill: work, in: {label: a, ticks: 2}}]"
    )
    assert bench.tick(2) == ["RUNNING", "RUNNING"]
    assert bench.journal.lines == []
    bench.tick()
    assert bench.journal.lines == ["a starts"]


def switch(kind="switch", default=", default: {skill: work, in: {label: other}}"):
    cases = ", ".join(f"{case}: {{skill: work, in: {{label: {case}, ticks: 2}}}}" for case in "ab")
    return f"{kind}: {{on: word, cases: {{{cases}}}{default}}}"


@pytest.mark.parametrize("kind", ["switch", "reactive_switch"])
@pytest.mark.parametrize(("word", "label"), [("a", "a"), ("b", "b"), ("c", "other")])
def test_switch_runs_the_case_of_the_value(bench, kind, word, label):
    answer, lines = bench.run(switch(kind), WORD, word=word)
    assert (answer, lines) == ("SUCCESS", [f"{label} starts", f"{label} ends"])


def test_switch_without_a_fitting_case_fails_and_says_so(bench):
    tree = bench.build(switch(default=""), WORD, word="c")
    assert bench.tick() == ["FAILURE"]
    assert str(tree.root.outcome.reason) == "switch.no_case: word is 'c'"


def test_switch_stays_with_its_case_and_reactive_switch_does_not(bench):
    for kind, lines in (
        ("switch", ["a starts", "a ends"]),
        ("reactive_switch", ["a starts", "a stops", "b starts", "b ends"]),
    ):
        bench.journal.lines.clear()
        tree = bench.build(switch(kind), WORD, word="a")
        bench.tick()
        tree.scope.write("word", "b", "test")
        bench.tick(2 if kind == "reactive_switch" else 1)
        assert bench.journal.lines == lines


def test_a_branch_is_halted_with_its_node(bench):
    tree = bench.build(switch(), WORD, word="a")
    bench.tick()
    tree.root.stop(tree.root.status.INVALID)
    assert bench.journal.lines == ["a starts", "a stops"]


@pytest.mark.parametrize(
    ("value", "kind", "case"),
    [(3, "int", "3"), (3.0, "float", "3"), (True, "bool", "true"), (None, "int | None", "none")],
)
def test_cases_are_written_as_in_yaml(bench, value, kind, case):
    root = f'switch: {{on: x, cases: {{"{case}": {{when: true}}}}, default: {{when: false}}}}'
    assert bench.run(root, f"in: {{x: {{type: '{kind}'}}}}", x=value)[0] == "SUCCESS"


@pytest.mark.parametrize(
    ("kind", "cases", "fault"),
    [
        ("Colour", "{rd: {when: true}}", "Colour has no value 'rd'; did you mean 'red'?"),
        ("Colour", "{red: {when: true}, green: {when: true}}", None),
        ("bool", "{yes: {when: true}}", "bool has no value 'yes'"),
        ("int", "{two: {when: true}}", "expected a number, got 'two'"),
        ("'a' | 'b'", "{c: {when: true}}", "has no value 'c'"),
        ("int", "{}", "cases: expected at least 1 of them"),
        ("int", "{'1': {whn: true}}", "unknown kind of node 'whn'"),
        ("int", "{'1': {when: true, nme: b}}", "unknown key 'nme'; did you mean 'name'?"),
    ],
)
def test_cases_are_checked_against_the_type(bench, kind, cases, fault):
    found = bench.faults(
        f"switch: {{on: x, cases: {cases}, default: {{when: true}}}}",
        f'in: {{x: {{type: "{kind}"}}}}',
    )
    assert found == [] if fault is None else any(fault in one for one in found), found


def test_nodes_in_cases_have_paths_and_places(bench):
    tree = bench.build(switch(), WORD, word="a")
    assert [node.path for node in tree.nodes] == ["t", "t/work", "t/work_2", "t/work_3"]
    assert len({node.column for node in tree.nodes}) == 4
