"""`check`, `tree` and `skills` on the command line."""

import json

import pytest
from typer.testing import CliRunner

from executive.cli.main import app
from executive.engine.document import KINDS
from executive.engine.library import packaged_trees
from executive.engine.schema import SCHEMA_FILE, schema_text

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


def test_tree_show_puts_subtrees_in(cellwright):
    lines = cellwright("tree", "show", "untangle").stdout.splitlines()
    assert lines[1].startswith("  in  confidence: float = 0.95")
    assert any("subtree look_and_act; in $confidence; out $claim" in line for line in lines)
    assert any("trace_cable  in $frame" in line for line in lines)


def test_tree_dot_has_a_node_and_an_edge_for_each_but_the_root(cellwright):
    text = cellwright("tree", "dot", "untangle").stdout
    assert text.startswith("digraph untangle {")
    assert text.count("[label=") == text.count(" -> n") + 1


def test_skills_are_listed_with_ports_units_and_reasons(cellwright):
    text = cellwright("skills", "dilate_knot").stdout
    assert text.startswith("dilate_knot (acts): ")
    assert "separation_m: float [m] = " in text
    assert "fails with " in text


def test_skills_speak_json(cellwright):
    described = json.loads(cellwright("skills", "--json").stdout)
    names = [skill["skill"] for skill in described]
    assert names == sorted(names)
    assert all(skill["about"] for skill in described)
    assert all(set(port) >= {"name", "type", "unit"} for s in described for port in s["in"])


def test_unknown_skill_is_answered(cellwright):
    result = cellwright("skills", "dilate_not")
    assert "did you mean 'dilate_knot'?" in str(result.exception)


def test_schema_file_is_that_of_the_models():
    file = packaged_trees() / SCHEMA_FILE
    again = "run python -m executive.engine.schema"
    assert file.read_text(encoding="utf-8") == schema_text(), again


def test_schema_knows_every_kind_of_node():
    assert len(json.loads(schema_text())["$defs"]["Node"]["oneOf"]) == len(KINDS)
