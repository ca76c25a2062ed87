"""The questions on the command line: first line the answer, bad questions answered too."""

import json

import pytest
from toy_pasts import act, past
from typer.testing import CliRunner

from executive.cli import main

ROOT = f"""
retry:
  times: 2
  child:
    sequence:
      name: pick
      children:
        - {act("look", value=2.5)[:-1]}, out: {{value: $seen}}}}
        - {{when: seen > 2, name: near}}
        - {act("grasp")}
"""


@pytest.fixture
def run_file(tmp_path):
    return past(tmp_path, ROOT, {"look": "RS", "grasp": "RRF"}).recording.path


@pytest.fixture
def other_file(tmp_path):
    return past(tmp_path, ROOT, {"look": "RS", "grasp": "RRS"}, name="b").recording.path


def ask(*arguments):
    return CliRunner().invoke(main.app, [*map(str, arguments)])


def answered(*arguments):
    result = ask(*arguments)
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.mark.parametrize(
    ("command", "question", "first_line"),
    [
        ("why", (), "t ended in failure: t/pick/grasp: act.failed: grasp was told to"),
        ("why", ("near",), "near succeeded: seen > 2 was true; seen is 2.5 (look wrote it at @4)"),
        ("why", ("grasp@0.1s",), "grasp was running, at tick 1 (0.1 s)"),
        (
            "why-not",
            ("grasp@0",),
            "grasp was not asked at tick 0 (0.0 s): look, before it, is still",
        ),
        ("why-halted", ("grasp",), "grasp was not halted at tick 4 (0.4 s)"),
        ("who", ("seen",), "seen (of t) = 2.5"),
        ("who", ("seen@0",), "t:seen had no value at tick 0; look wrote it first, at tick 1"),
        ("history", ("seen",), "tick     1       0.1 s  2.5  by look"),
        ("ticks", (), "tick 0  0.00 s"),
        ("ticks", ("--where", "status('grasp') == RUNNING"), "2 ticks of 5 with status('grasp')"),
        ("ticks", ("--key", "seen", "--from", "1", "--to", "2"), "tick 1  0.10 s"),
        ("report", (), "t ended in failure: t/pick/grasp: act.failed"),
        ("cover", (), "38 % covered: 5 of 13 branches of t, in 1 run"),
    ],
)
def test_the_first_line_is_the_answer(run_file, command, question, first_line):
    assert answered(command, run_file, *question).splitlines()[0].startswith(first_line)


@pytest.mark.parametrize(
    "question",
    [
        *(("why",), ("why", "grasp"), ("why-not", "grasp@0"), ("why-halted", "grasp")),
        *(("who", "seen"), ("history", "seen"), ("cover",)),
    ],
)
def test_programs_get_json(run_file, question):
    command, *rest = question
    assert json.loads(answered(command, run_file, *rest, "--json"))


def test_programs_get_ticks_line_by_line(run_file):
    lines = [json.loads(line) for line in answered("ticks", run_file, "--json").splitlines()]
    assert lines[0]["events"][0] == {"what": "RUNNING", "name": "t", "text": "", "writer": None}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("why", "grsp"), "did you mean 'grasp'"),
        (("why", "grasp@99"), "expected 0 to"),
        (("why", "*p*"), "names 4 nodes: pick, look, near, grasp"),
        (("who", "sen"), "did you mean 'seen'"),
        (("ticks", "--from", "4", "--to", "2"), "comes after"),
        (("ticks", "--where", "seen >"), "not an expression"),
        (("report", "-o", "no/such/folder/x.md"), "cannot be written"),
    ],
)
def test_bad_questions_say_what_there_is(run_file, arguments, message, monkeypatch, capsys):
    command, *rest = arguments
    monkeypatch.setattr("sys.argv", ["cellwright", command, str(run_file), *rest])
    with pytest.raises(SystemExit) as end:
        main.main()
    assert end.value.code == 2
    assert message in capsys.readouterr().err


def test_diff_is_a_gate(run_file, other_file):
    assert ask("diff", run_file, run_file).exit_code == 0
    result = ask("diff", run_file, other_file)
    assert result.exit_code == 1
    assert result.stdout.startswith("they differ first in the outcome of grasp, at tick 3 of A")
    assert json.loads(ask("diff", run_file, other_file, "--json").stdout)["differ"] is True


def test_cover_is_a_gate(run_file, other_file, tmp_path):
    assert ask("cover", run_file, "--fail-under", "90").exit_code == 1
    page = tmp_path / "cover.html"
    assert ask("cover", run_file, other_file, "--fail-under", "60", "--html", page).exit_code == 0
    assert page.read_text().startswith("<!doctype html>")


@pytest.mark.parametrize("form", ["text", "md", "json", "junit"])
def test_reports_go_to_a_file(run_file, other_file, tmp_path, form):
    output = tmp_path / "report"
    assert answered("report", run_file, other_file, "--format", form, "-o", output) == ""
    assert "grasp" in output.read_text()


def test_values_are_whole_for_programs(run_file):
    who = json.loads(answered("who", run_file, "seen@last", "--json"))
    assert who["value"] == 2.5
    assert who["writer"] == "t/pick/look"
    assert {reader["path"]: reader["ticks"] for reader in who["readers"]} == {"t/pick/near": [4]}
