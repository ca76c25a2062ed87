"""Trees inside trees: ports, scopes and names."""

import pytest
from toy_language import toy_skills, toy_types

from executive.core.errors import InputError
from executive.engine.loading.loader import load_program

INNER = """
format: 1
tree: inner
in:
  factor: {type: float, default: 3}
  part: {type: Part}
out:
  mass: {type: float}
root:
  sequence:
    - {skill: weigh, in: {part: $part, factor: $factor}, out: {mass: $local}}
    - {set: {mass: local}}
"""
FIND = "{skill: find, out: {part: $p, distance: $d}}"


@pytest.fixture
def inner(bench):
    """Return a bench with a subtree in the same folder."""
    bench.write("inner", INNER)
    return bench


def test_values_go_in_and_out_by_the_declared_ports(inner):
    tree = inner.build(
        f"sequence: [{FIND}, {{subtree: inner, in: {{part: $p, factor: $d}}, out: {{mass: $m}}}}]"
    )
    assert inner.tick() == ["SUCCESS"]
    assert tree.scope["m"] == 1.0


def test_input_that_is_not_wired_has_its_default(inner):
    tree = inner.build(
        f"sequence: [{FIND}, {{subtree: inner, in: {{part: $p}}, out: {{mass: $m}}}}]"
    )
    inner.tick()
    assert tree.scope["m"] == 1.5


def test_inputs_take_literals_and_expressions(inner):
    tree = inner.build(
        f"sequence: [{FIND}, {{subtree: inner, out: {{mass: $m}}, "
        "in: {part: {mass_kg: 2, colour: red}, factor: $d * 2}}]"
    )
    inner.tick()
    assert tree.scope["m"] == 8.0


def test_keys_of_a_subtree_are_its_own(inner):
    tree = inner.build(
        f"sequence: [{FIND}, {{subtree: inner, name: one, in: {{part: $p}}}}, "
        "{subtree: inner, name: two, in: {part: $p, factor: 5}}]"
    )
    inner.tick()
    assert "local" not in tree.scope
    assert tree.blackboard.read("t/one:local") == 1.5
    assert tree.blackboard.read("t/two:local") == 2.5


def test_a_subtree_sees_only_its_ports(bench):
    bench.write("peek", "format: 1\ntree: peek\nroot: {when: secret > 1}\n")
    assert bench.faults("sequence: [{set: {secret: 2}}, {subtree: peek}]") == [
        "peek: when: nothing in this tree writes 'secret'; known: none"
    ]


@pytest.mark.parametrize(
    ("node", "fault"),
    [
        ("{subtree: inner}", "subtree 'inner' needs the input 'part', which is not given"),
        ("{subtree: inner, in: {part: $d}}", "input 'part': expected Part, but $d is float"),
        ("{subtree: inner, in: {prt: $p}}", "subtree 'inner' has no input 'prt'; did you mean"),
        ("{subtree: inner, in: {part: $p}, out: {m: $m}}", "subtree 'inner' has no output 'm'"),
        ("{subtree: inner, in: {part: $p, factor: x}}", "input 'factor': expected float, got 'x'"),
    ],
)
def test_ports_of_a_subtree_are_checked_where_it_is_used(inner, node, fault):
    found = inner.faults(f"sequence: [{FIND}, {node}]")
    assert any(fault in one for one in found), found


def test_root_of_a_subtree_stands_in_its_place_under_the_name_that_uses_it(inner):
    tree = inner.build(f"sequence: [{FIND}, {{subtree: inner, name: scale, in: {{part: $p}}}}]")
    found = [(node.path, node.kind, node.tree, node.parent, node.line) for node in tree.nodes]
    assert found == [
        ("t", "sequence", "t", None, 5),
        ("t/find", "skill", "t", 0, 5),
        ("t/scale", "sequence", "inner", 0, 10),
        ("t/scale/weigh", "skill", "inner", 2, 11),
        ("t/scale/set", "set", "inner", 2, 12),
    ]


def test_guards_of_a_subtree_and_of_its_root_are_two_nodes(bench):
    bench.write_root("{skill: find, if: 1 < 2}", name="u")
    tree = bench.build("sequence: [{subtree: u, unless: 1 > 2}]")
    assert [node.path for node in tree.nodes] == ["t", "t/u.guard.guard", "t/u.guard", "t/u"]
    assert [node.parent for node in tree.nodes] == [None, 0, 1, 2]
    assert bench.tick() == ["SUCCESS"]


def test_a_tree_that_contains_itself_is_refused(bench):
    bench.write_root("{subtree: b}", name="a")
    bench.write_root("{subtree: a}", name="b")
    assert bench.faults("{subtree: a}") == ["b: tree 'a' would contain itself: a > b > a"]


def test_faults_of_subtrees_come_with_their_own_file(bench):
    bench.write_root("{skill: fnd}", name="broken")
    with pytest.raises(InputError, match=r"broken\.yaml:5:11: broken: unknown skill 'fnd'"):
        bench.load("{subtree: broken}")


def test_default_of_an_outer_input_reaches_a_subtree(inner):
    tree = inner.build(
        "{subtree: inner, in: {part: $part, factor: $f}, out: {mass: $m}}",
        """
        in: {part: {type: Part, default: {mass_kg: 1, colour: red}}, f: {type: float, default: 4}}
        out: {m: {type: float}}
        """,
    )
    inner.tick()
    assert tree.outputs() == {"m": 4.0}


def test_subtrees_are_found_beside_in_sibling_folders_and_in_search_paths(tmp_path, bench):

    for folder in ("cell/missions", "cell/subtrees", "more"):
        (tmp_path / folder).mkdir(parents=True)
    text = "format: 1\ntree: {}\nroot: {}\n"
    top = tmp_path / "cell/missions/top.yaml"
    top.write_text(text.format("top", "{sequence: [{subtree: one}, {subtree: two}]}"))
    (tmp_path / "cell/subtrees/one.yaml").write_text(text.format("one", "{when: true}"))
    (tmp_path / "more/two.yaml").write_text(text.format("two", "{when: true}"))
    program = load_program(
        top, skills=toy_skills(), types=toy_types(), search_paths=[tmp_path / "more"]
    )
    assert set(program.subtrees) == {"one", "two"}
