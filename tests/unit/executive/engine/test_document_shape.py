"""What a document may hold, and how a fault in its shape is told."""

import pytest
from toy_language import toy_skills, toy_types

from executive.core.errors import DocumentError, InputError
from executive.engine.language.sources import read_source
from executive.engine.loading.library import Library, Shelf
from executive.engine.loading.loader import check_files, load_mission
from executive.engine.loading.validation import validate

HEAD = "format: 1\ntree: t\n"


def faults_of(text):
    return [str(fault) for fault in validate(read_source("t.yaml", text))[1]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[1]", "t.yaml:1:1: expected a mapping with one of the keys tree, mission, cell"),
        ("# nothing", "stubs; got nothing"),
        ("words", "stubs; got 'words'"),
        ("format: 1\nmisson: m\n", "'misson' is none, did you mean 'mission'?"),
        ("tree: t\ncell: c\n", "more than one kind of document: tree, cell"),
        ("format: 2\ntree: t\nroot: {when: true}", "t.yaml:1:9: format: expected 1; got 2"),
        ("tree: t\nroot: {when: true}", "t.yaml:1:1: missing key 'format'"),
        (HEAD + "rot: {when: true}", "t.yaml:3:1: unknown key 'rot'; did you mean 'root'?"),
        ("format: 1\ntree: T x\nroot: {when: true}", "tree: expected a name of lower-case"),
        (HEAD + "in: {a: {typ: int}}\nroot: {when: true}", "t.yaml:3:10: unknown key 'typ'"),
        (HEAD + "in: {A: {type: int}}\nroot: {when: true}", "t.yaml:3:6: expected a name"),
    ],
)
def test_faults_of_a_document(text, message):
    assert any(message in fault for fault in faults_of(text)), faults_of(text)


@pytest.mark.parametrize(
    ("node", "message"),
    [
        ("{sequnce: []}", "t: unknown kind of node 'sequnce'; did you mean 'sequence'?"),
        (
            "{name: a, if: b}",
            "t: a node needs a kind, such as skill or sequence; got only name, if",
        ),
        ("{name: a, sklil: b}", "t: unknown kind of node 'sklil'; did you mean 'skill'?"),
        ("{<<: {skill: a}}", "merge keys (<<) are not read; try a subtree"),
        ("\n  sequence:\n    -{skill: a}\n", "an entry of a list begins with a dash and a blank"),
        ("{skill: a, when: b}", "t: a node has one kind; got skill and when"),
        ("hello", "t: expected a node such as {skill: NAME}; got 'hello'"),
        ("{skill: a, nmae: b}", "t: unknown key 'nmae'; did you mean 'name'?"),
        ("{sequence: [], name: s}", "'name' stands beside 'sequence'; try it under 'sequence'"),
        ("{sequence: {childs: []}}", "missing key 'children'"),
        ("{sequence: []}", "sequence: expected at least 1 of them; got a list of 0"),
        ("{sequence: }", "sequence: expected a mapping; got nothing"),
        (
            "{sequence: {memory: false, children: [{when: true}]}}",
            "memory: expected true; got false",
        ),
        (
            "{reactive_sequence: {memory: true, children: [{when: true}]}}",
            "expected false; got true",
        ),
        (
            "{retry: {times: three, child: {when: true}}}",
            "times: expected an integer, or 'forever', or an",
        ),
        ("{retry: {times: 0, child: {when: true}}}", "times: expected at least 1; got 0"),
        ("{retry: {child: {when: true}}}", "t: missing key 'times'"),
        ("{retry: {times: 2, child: {whn: true}}}", "t/?: unknown kind of node 'whn'"),
        ("{timeout: {seconds: .inf, child: {when: a}}}", "seconds: expected a finite number"),
        ("{timeout: {seconds: 0, child: {when: true}}}", "seconds: expected a number above 0"),
        ("{skill: a, out: {x: y}}", "x: expected a key of the blackboard such as $image; got 'y'"),
        (
            "{parallel: {succeed: most, children: [{when: a}]}}",
            "succeed: expected 'all' or 'any', or an integer, or a list; got 'most'",
        ),
        ("{set: {}}", "set: expected at least 1 of them; got a mapping"),
    ],
)
def test_faults_of_a_node(node, message):
    found = faults_of(f"{HEAD}root: {node}")
    assert any(message in fault for fault in found), found


def test_faults_of_all_nodes_come_in_one_pass_with_their_places():
    text = HEAD + (
        "root:\n"
        "  sequence:\n"
        "    - {skill: a, nmae: b}\n"
        "    - retry: {times: x, child: {skil: c}}\n"
        "    - {skill: d, out: {y: z}}\n"
    )
    assert [fault.partition(" (known")[0] for fault in sorted(faults_of(text))] == [
        "t.yaml:5:18: t/a: unknown key 'nmae'; did you mean 'name'?",
        "t.yaml:6:22: t/retry: times: expected an integer, or 'forever', "
        "or an expression such as $2 * pause_s; got 'x'",
        "t.yaml:6:32: t/retry/?: unknown kind of node 'skil'; did you mean 'skill'?",
        "t.yaml:7:27: t/d: y: expected a key of the blackboard such as $image; got 'z'",
    ]


def test_children_may_stand_in_a_plain_list():
    short, faults = validate(read_source("t.yaml", HEAD + "root: {sequence: [{when: true}]}"))
    long, _ = validate(read_source("t.yaml", HEAD + "root: {sequence: {children: [{when: true}]}}"))
    assert faults == []
    assert short == long


def test_file_is_named_like_what_is_in_it(tmp_path):
    file = tmp_path / "other.yaml"
    file.write_text(HEAD + "root: {when: true}")
    library = Library(Shelf(toy_types()), [tmp_path])
    library.document(file)
    assert "tree 't' is in a file named 'other'" in str(library.faults[0])


MISSION = """
format: 1
mission: tidy
cell: bench
scenario: {parts: {count: 3}}
timeout_s: 20
in: {limit: {type: float, default: 2}}
root: {when: limit > 1}
"""
CELL = "format: 1\ncell: bench\nworld: toy\nconfig: {table: 1}\n"


@pytest.fixture
def mission_folder(tmp_path):
    (tmp_path / "missions").mkdir()
    (tmp_path / "cells").mkdir()
    (tmp_path / "missions" / "tidy.yaml").write_text(MISSION)
    (tmp_path / "cells" / "bench.yaml").write_text(CELL)
    return tmp_path


def load(what, folder, **options):
    return load_mission(
        what, skills=toy_skills(), types=toy_types(), search_paths=[folder], **options
    )


def test_mission_is_a_tree_with_a_cell_a_scenario_and_limits(mission_folder):
    mission = load("tidy", mission_folder)
    assert mission.document.scenario == {"parts": {"count": 3}}
    assert (mission.document.timeout_s, mission.document.tick_hz) == (20.0, 10.0)
    assert (mission.cell.world, mission.cell.config) == ("toy", {"table": 1})
    assert [source.file.rpartition("/")[2] for source in mission.sources] == [
        "tidy.yaml",
        "bench.yaml",
    ]


def test_mission_is_found_by_name_and_by_path(mission_folder):
    by_path = load(mission_folder / "missions" / "tidy.yaml", mission_folder)
    assert by_path.document == load("tidy", mission_folder).document


def test_unknown_cell_is_answered_with_the_closest(mission_folder):
    file = mission_folder / "missions" / "tidy.yaml"
    file.write_text(MISSION.replace("cell: bench", "cell: bnch"))
    with pytest.raises(DocumentError, match=r"tidy.yaml:4:7: unknown cell 'bnch'.*'bench'"):
        load(file, mission_folder)


def test_campaigns_are_not_named_as_missions(mission_folder):
    missions = mission_folder / "missions"
    (missions / "often.yaml").write_text("campaign: often\nformat: 1\nmission: tidy\n")
    with pytest.raises(InputError, match=r"unknown mission 'oftn'.*tidy") as refused:
        load("oftn", mission_folder)
    assert "often" not in str(refused.value)


def test_check_takes_files_of_every_kind_and_reports_all_faults_once(mission_folder):
    (mission_folder / "t.yaml").write_text(HEAD + "root: {subtree: u}")
    (mission_folder / "u.yaml").write_text("format: 1\ntree: u\nroot: {skill: fnd}")
    files = sorted(mission_folder.rglob("*.yaml"))
    checked, faults = check_files(files, skills=toy_skills(), types=toy_types())
    assert [(one.kind, one.name) for one in checked] == [
        ("cell", "bench"),
        ("mission", "tidy"),
        ("tree", "t"),
        ("tree", "u"),
    ]
    assert len(faults) == 1
    assert "u: unknown skill 'fnd'; did you mean 'find'?" in str(faults[0])
