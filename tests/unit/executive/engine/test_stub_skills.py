"""Stubs: declared ports, scripted outcomes, and what is wrong with them."""

import json

import pytest
from toy_language import toy_skills, toy_types
from typer.testing import CliRunner

from executive.app.dry_cell import DryCell
from executive.cli.main import app
from executive.core.clock import ManualClock
from executive.core.errors import DocumentError, InputError
from executive.engine.loading.loader import check_files, load_program
from executive.engine.nodes.builder import build

HANDS = {
    "format": 1,
    "stubs": "hands",
    "skills": {
        "grasp": {
            "in": {"width": {"type": "float", "default": 0.1}},
            "out": {"force": {"type": "float"}},
            "acts": True,
            "outcomes": [
                {"ticks": 2, "outcome": "failure", "reason": "grasp.missed"},
                {"outcome": "success", "out": {"force": 2}},
            ],
        }
    },
}
GRASP = {"skill": "grasp", "out": {"force": "$force"}}


def write(folder, *, stubs=HANDS, root=GRASP, uses=("hands",), name="t"):
    tree = {"format": 1, "tree": name, "uses": list(uses), "root": root}
    (folder / f"{name}.yaml").write_text(json.dumps(tree))
    (folder / f"{stubs['stubs']}.yaml").write_text(json.dumps(stubs))
    return folder / f"{name}.yaml"


def load(file):
    return load_program(file, skills=toy_skills(), types=toy_types())


def faults(file):
    with pytest.raises(DocumentError) as caught:
        load(file)
    return str(caught.value)


def with_grasp(**changes):
    grasp = {**HANDS["skills"]["grasp"], **changes}
    return {**HANDS, "skills": {"grasp": grasp}}


@pytest.mark.parametrize(("after", "answers"), [("last", "RFSSS"), ("first", "RFSRF")])
def test_a_stub_answers_what_its_script_says(tmp_path, after, answers):
    program = load(write(tmp_path, stubs=with_grasp(after=after)))
    tree = build(program, devices={}, clock=ManualClock())
    seen = ""
    for _ in answers:
        tree.root.tick_once()
        seen += tree.root.status.name[0]
    assert seen == answers
    assert tree.scope["force"] == 2.0


def test_every_node_that_runs_a_stub_has_its_own_script(tmp_path):
    root = {"selector": [GRASP, {**GRASP, "name": "again"}]}
    tree = build(load(write(tmp_path, root=root)), devices={}, clock=ManualClock())
    for _ in range(3):
        tree.root.tick_once()
    assert tree.root.status.name == "FAILURE"


def test_wiring_to_a_stub_is_checked_like_that_of_any_skill(tmp_path):
    root = {"skill": "grasp", "in": {"width": "wide", "depth": 1}}
    told = faults(write(tmp_path, root=root))
    assert "input 'width': expected float, got 'wide'" in told
    assert "no input 'depth'" in told


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"outcomes": [{"outcome": "success"}]}, "a success gives every output"),
        ({"outcomes": [{"outcome": "failure", "out": {"force": 1.0}}]}, "a failure has no outputs"),
        ({"outcomes": [{"outcome": "success", "out": {"force": "x"}}]}, "expected float, got 'x'"),
        (
            {"outcomes": [{"outcome": "success", "out": {"force": 1.0}, "reason": "a.b"}]},
            "a success has no reason",
        ),
        (
            {"outcomes": [{"outcome": "success", "out": {"force": 1.0, "forse": 1}}]},
            "did you mean 'force'",
        ),
        ({"in": {"force": {"type": "float"}}}, "'force' is an input and an output"),
        ({"in": {"width": {"type": "flout"}}}, "did you mean 'float'"),
        ({"in": {"width": {"type": "int", "default": "x"}}}, "expected int"),
    ],
)
def test_faults_of_a_stub(tmp_path, changes, said):
    assert said in faults(write(tmp_path, stubs=with_grasp(**changes)))


def test_a_tree_sees_only_the_stubs_that_it_names(tmp_path):
    inner = write(tmp_path, name="inner", uses=())
    outer = write(tmp_path, name="outer", root={"sequence": [{"subtree": "inner"}, GRASP]})
    told = faults(outer)
    assert told.count("unknown skill 'grasp'") == 1
    assert str(inner) in told


def test_stubs_that_are_unknown_or_take_a_name_are_refused(tmp_path):
    assert "unknown stubs 'hand'" in faults(write(tmp_path, uses=("hand",)))
    taken = {**HANDS, "skills": {"find": {"about": "Look."}}}
    told = faults(write(tmp_path, stubs=taken, root={"when": True}))
    assert "stub 'find' of 'hands' has the name of a skill at hand" in told


def test_a_file_of_stubs_is_checked_by_itself(tmp_path):
    write(tmp_path, stubs=with_grasp(outcomes=[{"outcome": "success"}]))
    checked, found = check_files([tmp_path / "hands.yaml"], skills=toy_skills(), types=toy_types())
    assert [one.kind for one in checked] == ["stubs"]
    assert len(found) == 1


def test_a_mission_of_stubs_runs_on_the_dry_cell(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write(tmp_path)
    mission = {
        "format": 1,
        "mission": "go",
        "cell": "dry",
        "uses": ["hands"],
        "root": {"sequence": [{"wait": 3600}, {"retry": {"times": 2, "child": GRASP}}]},
    }
    (tmp_path / "go.yaml").write_text(json.dumps(mission))
    result = CliRunner().invoke(app, ["run", "go.yaml", "--json"])
    report = json.loads(result.stdout)
    assert (result.exit_code, report["outcome"]) == (0, "success"), result.output
    assert report["sim_s"] >= 3600.0


@pytest.mark.parametrize("given", ["config", "scenario"])
def test_the_dry_cell_takes_nothing(given):
    with pytest.raises(InputError, match=f"takes no {given}; got 'arm'"):
        DryCell(**{"config": {}, "scenario": {}, given: {"arm": 1}})


def test_a_stub_that_acts_need_not_say_how_it_stops(tmp_path):
    linted = CliRunner().invoke(app, ["lint", str(write(tmp_path))])
    assert "L301" not in linted.stdout


def test_a_word_that_does_not_fit_is_answered_with_the_closest(tmp_path):
    sides = with_grasp(**{"in": {"side": {"type": '"left" | "right"'}}})
    file = write(tmp_path, stubs=sides, root={"skill": "grasp", "in": {"side": "rigth"}})
    assert "got 'rigth'; did you mean 'right'? (known: left, right)" in faults(file)


def test_a_mission_whose_time_is_up_between_two_leaves_says_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    slow = with_grasp(outcomes=[{"ticks": 2, "outcome": "success", "out": {"force": 2}}])
    file = write(tmp_path, stubs=slow, root={"repeat": {"times": 9, "child": GRASP}}, name="t")
    mission = json.loads(file.read_text()) | {"mission": "t", "cell": "dry", "timeout_s": 0.2}
    file.write_text(json.dumps({key: value for key, value in mission.items() if key != "tree"}))
    result = CliRunner().invoke(app, ["run", str(file), "--record", "run"])
    assert result.exit_code == 1
    assert "mission timeout of 0.2 s passed while no leaf was running" in result.stdout
