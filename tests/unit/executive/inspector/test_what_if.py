"""Questions to a run: what they change, what they refuse, and never anything before their tick."""

import json

import pytest
from toy_language import toy_types
from toy_pasts import act, past
from toy_reticks import KEEP, MoodyTrees, recorded
from typer.testing import CliRunner

from executive.cli import main
from executive.core.errors import DocumentError, InputError
from executive.core.outcome import Status
from executive.core.registry import Registry
from executive.inspector.retick.question import what_if
from executive.inspector.retick.retick import retick

ROOT = f"""
sequence:
  - {act("look", value=2.5)[:-1]}, out: {{value: $width}}}}
  - {act("wait")}
  - selector:
      name: get
      children:
        - {{when: width > 3, name: wide}}
        - {act("grasp")}
  - {act("lift")}
"""
LETTERS = {"look": "S", "wait": "RS", "grasp": "RF", "lift": "RS"}


def asked(run, at, values=(), forced=(), **options):
    """Return what comes of a question."""
    question = what_if(run, at, values, forced)
    return retick(run, Registry("port type"), what_if=question, **options)


def command(*words):
    """Return exit code and output of a command."""
    result = CliRunner().invoke(main.app, [str(word) for word in words])
    if isinstance(result.exception, InputError):
        return 2, str(result.exception)
    return result.exit_code, result.output


@pytest.fixture
def run(tmp_path):
    """Return a run in which the part is not wide and the grasp fails."""
    return past(tmp_path, ROOT, LETTERS)


@pytest.mark.parametrize("at", ["0", "1", "last", "0.1s"])
def test_a_question_that_changes_nothing_finds_nothing(run, at):
    assert asked(run, at).identical


@pytest.mark.parametrize("seed", range(6))
def test_nothing_differs_before_the_tick_of_the_question(tmp_path, seed):
    run = recorded(tmp_path, MoodyTrees(seed).root(), ports=KEEP)
    for tick in range(run.index.last_tick + 1):
        for node in run.index.asked(tick).tolist():
            for status in Status:
                path = run.index.nodes[node].path
                question = what_if(run, str(tick), (), [f"{path}={status.lower()}"])
                found = retick(run, toy_types(), what_if=question, beyond="running")
                assert found.first is None or found.first.tick == tick
                assert all(outside.tick >= tick for outside in found.outside)


def test_a_value_that_was_set_decides_and_is_named(run):
    found = asked(run, "1", ["width=4"])
    assert found.first.tick == 1
    assert found.causes == ("wide: width > 3 was false, is true; width is 4",)
    assert [node.path for node in found.first.nodes] == ["t/get/wide", "t/get"]
    assert found.outside[0].path == "t/lift"
    assert found.outside[0].why == "it was never asked in the run"
    assert (found.recorded_end, found.end) == (
        "failure at tick 2",
        "outside the recording at tick 1",
    )


def test_a_value_that_it_had_anyway_changes_nothing_and_that_is_said(run):
    found = asked(run, "1", ["width=2.5"])
    assert found.identical
    assert found.notes == ("width had that value already",)


def test_a_value_that_is_written_in_the_same_tick_is_said_to_be(run):
    found = asked(run, "0", ["width=9"])
    assert found.identical
    assert "width was written by look in tick 0 itself" in found.notes[0]


@pytest.mark.parametrize(
    ("at", "values", "forced", "says"),
    [
        ("1", ["widht=3"], [], "did you mean 'width'"),
        ("1", ["width=wide"], [], "expected float, got 'wide'"),
        ("1", ["width.x=3"], [], "no field 'x' in float"),
        ("1", ["width"], [], "expected KEY=VALUE"),
        ("1", [], ["grab=failure"], "no node 'grab'; did you mean 'grasp'"),
        ("1", [], ["grasp=maybe"], "unknown status 'maybe'; known: failure, running, success"),
        ("1", [], ["grasp"], "expected NODE=STATUS"),
        ("1", [], ["lift=failure"], "lift was not asked in tick 1"),
        ("99", [], [], "no tick 99"),
    ],
)
def test_questions_that_cannot_be_asked_are_refused(run, at, values, forced, says):
    with pytest.raises(InputError, match=says):
        asked(run, at, values, forced)


def test_fields_of_recorded_objects_can_be_set(tmp_path):
    root = {
        "sequence": [
            {"skill": "find", "out": {"part": "$part"}},
            {"wait": 0.15},
            {"when": "part.mass_kg > 1", "name": "heavy"},
        ]
    }
    run = recorded(tmp_path, root)
    question = what_if(run, "1", ["part.mass_kg=2.5"], ())
    found = retick(run, toy_types(), what_if=question)
    assert found.causes == ("heavy: part.mass_kg > 1 was false, is true; part.mass_kg is 2.5",)
    assert found.end == "success at tick 2"
    with pytest.raises(InputError, match="no field 'mass' in Part; did you mean 'mass_kg'"):
        retick(run, toy_types(), what_if=what_if(run, "1", ["part.mass=2.5"], ()))


def edited(folder, run, old, new):
    """Write the tree of a run with some words changed; return the file."""
    text = run.recording.header.sources[0].text
    assert old in text
    file = folder / "edited.yaml"
    file.write_text(text.replace(old, new))
    return file


def test_an_edited_condition_is_named_with_both_texts(tmp_path, run):
    found = retick(run, Registry("t"), edited=[edited(tmp_path, run, "width > 3", "width > 2")])
    assert found.causes == ("wide: width > 3 was false, width > 2 is true; width is 2.5",)


def test_a_renamed_leaf_takes_over_the_answers_of_the_old_one(tmp_path, run):
    file = edited(tmp_path, run, "name: grasp,", "name: grab,")
    found = retick(run, Registry("t"), edited=[file])
    assert found.identical
    assert found.moved == (("t/get/grasp", "t/get/grab"),)


def test_a_skill_that_is_only_in_the_edited_tree_is_outside_the_recording(tmp_path, run):
    file = edited(tmp_path, run, "skill: act, name: grasp", "skill: pinch, name: pinch")
    found = retick(run, Registry("t"), edited=[file])
    assert not found.identical
    assert found.outside[0].why == "it is only in the edited tree"
    assert found.removed == ("t/get/grasp",)
    assert retick(run, Registry("t"), edited=[file], beyond="failure").end.startswith("failure")


def test_edited_files_that_do_not_fit_are_refused(tmp_path, run):
    other = tmp_path / "other.yaml"
    other.write_text("format: 1\ntree: other\nroot: {when: true}\n")
    with pytest.raises(InputError, match=r"other.yaml: nothing that was recorded uses it"):
        retick(run, Registry("t"), edited=[other])
    with pytest.raises(InputError, match=r"none.yaml: cannot be read"):
        retick(run, Registry("t"), edited=[tmp_path / "none.yaml"])
    faulty = edited(tmp_path, run, "selector:", "selektor:")
    with pytest.raises(DocumentError, match=r"edited.yaml:\d+.*selektor"):
        retick(run, Registry("t"), edited=[faulty])


def test_the_commands_exit_with_what_they_found(tmp_path, run):
    file = run.recording.path
    assert command("retick", file)[0] == 0
    assert command("whatif", file, "--at", 1)[0] == 0
    code, text = command("whatif", file, "--at", 1, "--force", "wait=failure")
    assert code == 1
    assert "because wait was forced" in text
    assert command("retick", tmp_path / "none.mcap")[0] == 2
    code, text = command("whatif", file, "--at", 1, "--set", "width=4", "--json")
    document = json.loads(text)
    assert code == 1
    assert document["identical"] is False
    assert document["first"]["tick"] == 1
