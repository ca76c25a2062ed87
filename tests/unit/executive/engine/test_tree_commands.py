"""`check`, `tree` and `skills` on the command line."""

import json
import time

import pytest
from toy_language import toy_skills
from typer.testing import CliRunner

from executive.cli.main import app
from executive.engine.language.block_models import KINDS
from executive.engine.loading.library import packaged_trees
from executive.engine.schema import SCHEMA_FILE, schema_text

SKILLS = {"cmd_check": "skills", "cmd_tree": "skills", "cmd_skills": "shipped_skills"}
OUTER = """
format: 1
tree: outer
about: Weigh.
in: {factor: {type: float, default: 2, unit: m, about: scale}}
out: {mass: {type: float, unit: kg}}
root:
  sequence:
    - {skill: find, out: {part: $p}}
    - retry:
        name: again
        times: 3
        delay_s: 0.5
        child: {subtree: inner, in: {part: $p, factor: $factor}, out: {mass: $mass}}
    - {when: mass > 1, unless: factor > 9, checkpoint: true}
"""
INNER = """
format: 1
tree: inner
in: {part: {type: any}, factor: {type: float}}
out: {mass: {type: float}}
root:
  sequence:
    - {skill: weigh, name: reading, in: {part: $part, factor: $factor}, out: {mass: $mass}}
"""
BROKEN = "format: 1\ntree: broken\nroot: {skill: find_knot}\n"


@pytest.fixture
def cellwright():
    """Run the command line in this process."""
    return lambda *arguments: CliRunner().invoke(app, [str(one) for one in arguments])


def test_every_tree_that_ships_is_without_faults(cellwright):
    result = cellwright("check", packaged_trees())
    assert result.exit_code == 0, result.stdout
    assert "ok: mission untangle" in result.stdout


def test_check_prints_faults_that_editors_can_jump_to_and_exits_2(cellwright, tmp_path):
    file = tmp_path / "broken.yaml"
    file.write_text(BROKEN)
    result = cellwright("check", file)
    assert result.exit_code == 2
    first = result.stdout.splitlines()[0]
    assert first.startswith(f"{file}:3:15: broken: unknown skill 'find_knot'; did you mean")


def test_check_speaks_json(cellwright, tmp_path):
    file = tmp_path / "broken.yaml"
    file.write_text(BROKEN)
    report = json.loads(cellwright("check", "--json", file).stdout)
    assert report["ok"] is False
    (fault,) = report["faults"]
    assert (fault["line"], fault["column"], fault["node"]) == (3, 15, "broken")


@pytest.fixture
def toy_file(tmp_path, monkeypatch):
    """Return a tree with a subtree, for a command line that knows the toy skills alone."""
    for module in ("cmd_check", "cmd_tree", "cmd_skills"):
        monkeypatch.setattr(f"executive.cli.{module}.{SKILLS[module]}", toy_skills)
    (tmp_path / "inner.yaml").write_text(INNER)
    (tmp_path / "outer.yaml").write_text(OUTER)
    return tmp_path / "outer.yaml"


def test_tree_show_puts_subtrees_in(cellwright, toy_file):
    assert cellwright("tree", "show", toy_file).stdout.splitlines() == [
        "outer: Weigh.",
        "  in  factor: float [m] = 2.0  scale",
        "  out mass: float [kg]",
        "sequence outer",
        "├── find  out part: $p",
        "├── retry again  times 3; delay_s 0.5",
        "│   └── sequence inner  subtree inner; in part: $p, $factor; out $mass",
        "│       └── reading  skill weigh; in $part, $factor; out $mass",
        "└── when  mass > 1; checkpoint; unless factor > 9",
    ]


def test_tree_dot_has_a_node_and_an_edge_for_each_but_the_root(cellwright, toy_file):
    text = cellwright("tree", "dot", toy_file).stdout
    assert text.startswith("digraph outer {")
    assert text.count("[label=") == 6
    assert text.count(" -> n") == 5


def test_check_counts_the_nodes_with_those_of_subtrees(cellwright, toy_file):
    result = cellwright("check", toy_file)
    assert result.stdout == f"{toy_file}: ok: tree outer, 6 nodes\n"


def test_skills_are_listed_with_ports_units_and_reasons(cellwright, toy_file):
    assert cellwright("skills", "work").stdout.splitlines() == [
        "work (acts): Answer after some ticks, and note start, end and stop.",
        "  in  label: str",
        "  in  ticks: int = 1",
        "  in  fails: int = 0",
        "  in  raises: bool = False",
        "  out label: str",
        "  fails with work.failed",
        "  needs journal: Journal",
    ]
    assert "  in  factor: float [m] = 1.0  scale" in cellwright("skills").stdout


def test_skills_speak_json(cellwright):
    described = json.loads(cellwright("skills", "--json").stdout)
    names = [skill["skill"] for skill in described]
    assert names == sorted(names)
    assert all(skill["about"] for skill in described)
    assert all(set(port) >= {"name", "type", "unit"} for s in described for port in s["in"])


def test_unknown_skill_is_answered(cellwright):
    result = cellwright("skills", "go_hom")
    assert "did you mean 'go_home'?" in str(result.exception)


def test_schema_file_is_that_of_the_models():
    file = packaged_trees() / SCHEMA_FILE
    again = "run python -m executive.engine.schema"
    assert file.read_text(encoding="utf-8") == schema_text(), again


def test_schema_knows_every_kind_of_node():
    assert len(json.loads(schema_text())["$defs"]["Node"]["oneOf"]) == len(KINDS)


def test_a_file_that_is_no_text_is_one_fault_among_the_others(cellwright, tmp_path):
    (tmp_path / "broken.yaml").write_text(BROKEN)
    (tmp_path / "latin.yaml").write_bytes(b"format: 1\nabout: caf\xe9\n")
    result = cellwright("check", "--json", tmp_path)
    faults = json.loads(result.stdout)["faults"]
    assert result.exit_code == 2
    assert [(fault["line"], fault["column"]) for fault in faults] == [(3, 15), (2, 11)]
    assert faults[1]["message"] == "not UTF-8 text: byte 0xe9; try to save it as UTF-8"


def test_a_tree_that_uses_what_has_faults_is_not_ok(cellwright, tmp_path):
    (tmp_path / "broken.yaml").write_text(BROKEN)
    (tmp_path / "outer.yaml").write_text("format: 1\ntree: outer\nroot: {subtree: broken}\n")
    result = cellwright("check", tmp_path / "outer.yaml")
    assert "outer.yaml: not ok: tree outer uses what has faults" in result.stdout


def test_a_long_sequence_is_checked_in_little_time(cellwright, tmp_path):
    file = tmp_path / "long.yaml"
    writes = "".join(f"    - {{set: {{k{i}: 1}}}}\n" for i in range(3000))
    file.write_text(f"format: 1\ntree: long\nroot:\n  sequence:\n{writes}")
    begun_s = time.process_time()
    assert "3001 nodes" in cellwright("check", file).stdout
    assert time.process_time() - begun_s < 15.0
