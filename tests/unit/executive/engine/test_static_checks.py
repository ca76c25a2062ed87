"""What is known to be wrong with a tree before its first tick."""

import pytest
from toy_language import toy_skills, toy_types

from executive.core.errors import DocumentError
from executive.engine.loading.loader import load_program

FIND = "{skill: find, out: {part: $p, distance: $d}}"


def sequence(*nodes):
    return "sequence:\n" + "\n".join(f"  - {node}" for node in nodes)


@pytest.mark.parametrize(
    ("root", "fault"),
    [
        ("{skill: fnd}", "t: unknown skill 'fnd'; did you mean 'find'?"),
        ("{subtree: nothing}", "t: unknown tree 'nothing'"),
        (
            "{skill: find, out: {prt: $p}}",
            "t: skill 'find' has no output 'prt'; did you mean 'part'?",
        ),
        ("{skill: work, in: {lable: x}}", "t: skill 'work' has no input 'lable'; did you mean"),
        ("{skill: work}", "t: skill 'work' needs the input 'label', which is not given"),
        ("{skill: work, in: {label: 3}}", "t: input 'label': expected str, got 3"),
        ("{skill: sort, in: {colour: gren}}", "t: input 'colour': Colour has no value 'gren'"),
        ("{skill: sort, in: {limit: yes}}", "input 'limit': expected float | None, got 'yes'"),
        (
            "{skill: weigh, in: {part: p}}",
            "expected Part, got 'p'; try $p for the key of that name",
        ),
        ("{skill: sort, in: {parts: [$p]}}", "'$p' inside a literal is plain text; try"),
        ("{skill: work, in: {label: $a b}}", "in/label: 'a b' is not an expression"),
        ("{when: part.mass > 1}", "t: when: nothing in this tree writes 'part'"),
        ("{when: 1 + 2}", "t: when: expected true or false, got int; try a comparison"),
        ("{skill: find, if: 3}", "t: if: expected true or false, got int"),
        ("{set: {mass: mas + 1}}", "set/mass: nothing in this tree writes 'mas'; did you mean"),
        ("{for_each: {item: $i, in: 3, child: {when: true}}}", "t: in: expected a list, got 3"),
        (
            "{for_each: {item: $i, in: $4, child: {when: true}}}",
            "expected list[any], but $4 is int",
        ),
        (
            "{sequence: {name: other, children: [{when: true}]}}",
            "t: the root is named after its tree, 't'; drop the name",
        ),
    ],
)
def test_faults_of_one_node(bench, root, fault):
    assert any(fault in found for found in bench.faults(root)), bench.faults(root)


@pytest.mark.parametrize(
    ("nodes", "fault"),
    [
        (
            [FIND, "{skill: work, in: {label: $p}}"],
            "t/work: input 'label': expected str, but $p is Part, written by t/find",
        ),
        (
            [FIND, '{skill: work, in: {label: "$p.holes[0]"}}'],
            "t/work: input 'label': expected str, but $p.holes[0] is int",
        ),
        (
            [FIND, "{skill: weigh, in: {part: $p, factor: $m}, out: {mass: $m}}"],
            "t/weigh: input 'factor': expected the unit m, but $m is in kg",
        ),
        (
            [FIND, "{when: p.mas_kg > 1}"],
            "t/when: when: 'p.mas_kg > 1': Part has no field 'mas_kg'",
        ),
        ([FIND, '{when: p.colour == "rd"}'], "Colour has no value 'rd'; did you mean 'red'?"),
        ([FIND, "{when: p.holes}"], "expected true or false, got list[int]; try size(...) > 0"),
        (
            [FIND, "{set: {n: size(p.holes)}}", "{skill: work, in: {label: $n}}"],
            "t/work: input 'label': expected str, but $n is int, written by t/set",
        ),
        (
            [FIND, "{for_each: {item: $h, in: $p.holes, child: {skill: work, in: {label: $h}}}}"],
            "t/for_each/work: input 'label': expected str, but $h is int, written by t/for_each",
        ),
        (
            ["{skill: find, name: a}", "{skill: find, name: a}"],
            "t/a: another child of 't' is named 'a' too",
        ),
        (["{skill: find, name: find_2}", "{skill: find}", "{skill: find}"], None),
    ],
)
def test_faults_between_nodes(bench, nodes, fault):
    found = bench.faults(sequence(*nodes))
    assert found == [] if fault is None else any(fault in one for one in found), found


@pytest.mark.parametrize(
    ("ports", "root", "fault"),
    [
        ("out: {x: {type: int}}", "{when: true}", "t: output 'x' is never written"),
        (
            "out: {x: {type: str}}",
            "{skill: find, out: {part: $x}}",
            "t: output 'x' of the tree is str, but this writes Part",
        ),
        (
            "out: {x: {type: float, unit: mm}}",
            "{skill: find, out: {distance: $x}}",
            "t: output 'x' of the tree is in mm, this in m",
        ),
        (
            "in: {x: {type: int, default: 1}}",
            "{set: {x: 2}}",
            "t: 'x' is an input of the tree, which is not written; try another key",
        ),
        ("in: {x: {type: nit}}", "{when: x > 1}", "in/x: unknown type 'nit'; did you mean 'int'?"),
        ("in: {x: {type: int, default: a}}", "{when: x > 1}", "in/x: expected int, got 'a'"),
        (
            "in: {x: {type: int}}\nout: {x: {type: int}}",
            "{when: x > 1}",
            "'x' is an input and an output; try a second name",
        ),
    ],
)
def test_faults_of_declared_ports(bench, ports, root, fault):
    assert any(fault in found for found in bench.faults(root, ports)), bench.faults(root, ports)


def test_a_key_with_writers_of_several_types_fits_none_of_them(bench):
    found = bench.faults(
        sequence(
            "{selector: [{skill: find, out: {distance: $v}}, {set: {v: '\"far\"'}}]}",
            "{skill: weigh, in: {part: {mass_kg: 1, colour: red}, factor: $v}}",
        )
    )
    assert found == [
        "t/weigh: input 'factor': expected float, but $v is float | str, written by t/selector/set"
    ]


def test_all_faults_of_a_tree_come_in_one_pass_with_line_and_column(bench):
    file = bench.write_root(
        """
        sequence:
          - {skill: fnd}
          - {skill: work}
          - {when: nothing > 1}
          - {skill: sort, in: {colour: gren}}
        """
    )

    with pytest.raises(DocumentError) as found:
        load_program(file, skills=toy_skills(), types=toy_types())
    places = [(fault.line, fault.column) for fault in found.value.faults]
    assert places == [(6, 15), (7, 7), (8, 14), (9, 34)]


def test_unnamed_siblings_are_numbered(bench):
    tree = bench.build(sequence("{when: true}", "{when: true}", "{when: true, name: when_2}"))
    assert [node.path for node in tree.nodes] == ["t", "t/when", "t/when_3", "t/when_2"]
