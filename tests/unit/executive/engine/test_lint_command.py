"""`cellwright lint` on the command line."""

import json

import pytest
from typer.testing import CliRunner

from executive.cli.main import app
from executive.engine.lint.rules import RULES
from executive.engine.loading.library import packaged_trees

LOOSE = """\
format: 1
tree: loose
root:
  # lint: allow L106 because it is a test
  sequence:
    - {when: 1 < 2}
"""


@pytest.fixture
def cellwright():
    """Run the command line in this process."""
    return lambda *arguments: CliRunner().invoke(app, [str(one) for one in arguments])


@pytest.fixture
def loose(tmp_path):
    """Return a file with a finding and a waiver."""
    file = tmp_path / "loose.yaml"
    file.write_text(LOOSE)
    return file


def test_every_tree_that_ships_is_without_findings(cellwright):
    result = cellwright("lint", packaged_trees())
    assert result.exit_code == 0, result.stdout


def test_findings_exit_1_and_can_be_jumped_to(cellwright, loose):
    result = cellwright("lint", loose)
    assert result.exit_code == 1
    assert result.stdout == (
        f"{loose}:6:14: L102 constant condition: loose/when: "
        "when: always true, it asks nothing; drop it, or ask about a key\n"
    )
    assert result.stderr == "1 tree, 1 finding, 1 waived\n"


def test_strict_shows_what_is_waived(cellwright, loose):
    codes = [line.split()[1] for line in cellwright("lint", "--strict", loose).stdout.splitlines()]
    assert codes == ["L106", "L102"]


def test_findings_in_json(cellwright, loose):
    document = json.loads(cellwright("lint", "--json", loose).stdout)
    assert (document["ok"], document["files"], document["faults"]) == (False, 1, [])
    (finding,) = document["findings"]
    assert (finding["code"], finding["line"], finding["node"]) == ("L102", 6, "loose/when")
    assert [one["reason"] for one in document["waived"]] == ["it is a test"]


def test_faults_exit_2_and_other_files_are_looked_at(cellwright, loose):
    (loose.parent / "bad.yaml").write_text("format: 1\ntree: bad\nroot: {skill: nowhere}\n")
    result = cellwright("lint", loose.parent)
    assert result.exit_code == 2
    assert "unknown skill 'nowhere'" in result.stdout
    assert "L102" in result.stdout


def test_rules_are_listed(cellwright):
    listed = cellwright("lint", "--rules").stdout
    assert all(f"{rule.code} {rule.name}: {rule.about}" in listed for rule in RULES)


def test_halts_are_listed(cellwright):
    mission = packaged_trees() / "missions" / "untangle.yaml"
    assert "\n  the mission after 900 s\n" in cellwright("lint", "--halts", mission).stdout
    leaves = json.loads(cellwright("lint", "--halts", "--json", mission).stdout)["untangle"]
    round_over = "untangle/in_time: timeout after 60 s"
    assert all(leaf["by"] == ["the mission after 900 s", round_over] for leaf in leaves)


@pytest.mark.parametrize("command", ["check", "lint", "fmt"])
def test_trees_are_meant_where_no_file_is_named(cellwright, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    missing = cellwright(command)
    assert str(missing.exception) == (
        "trees: no such file or folder; try the name of a YAML file, or of a mission"
    )
    (tmp_path / "trees").mkdir()
    assert str(cellwright(command).exception) == (
        "no YAML files in trees; expected some that end with .yaml"
    )
    (tmp_path / "trees" / "t.yaml").write_text("format: 1\ntree: t\nroot: {set: {a: 1, b: a}}\n")
    assert "t.yaml" in cellwright(command).stdout or command != "check"
