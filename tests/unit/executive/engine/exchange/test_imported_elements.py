"""What each element becomes, what is refused and where, and trees in the style of real robots."""

import pytest
from foreign_runs import NOTHING, TYPES, data_of, document, imported, root_of, tree_of
from typer.testing import CliRunner

from executive.cli.main import app
from executive.core.errors import DocumentError
from executive.core.registry import Registry
from executive.core.skill import Port, Skill, SkillRun
from executive.engine.exchange.importing import ImportOptions, import_file, import_text
from executive.engine.exchange.vocabulary import REFUSED
from executive.engine.loading.loader import load_program

TWO = "<AlwaysSuccess/><AlwaysFailure/>"


def refusals(xml, **options):
    with pytest.raises(DocumentError) as caught:
        imported(xml, **options)
    return [str(fault) for fault in caught.value.faults]


@pytest.mark.parametrize(
    ("xml", "node"),
    [
        ("<AlwaysSuccess/>", {"when": True}),
        ("<AlwaysFailure/>", {"when": False}),
        ('<Sleep msec="1500"/>', {"wait": 1.5}),
        ("<Script code=\"x := 1; y := 'a'\"/>", {"set": {"x": 1, "y": "'a'"}}),
        ('<SetBlackboard value="1;2" output_key="goal"/>', {"set": {"goal": "'1;2'"}}),
        ('<SetBlackboard value="5" output_key="{n}"/>', {"set": {"n": 5}}),
        ('<UnsetBlackboard key="goal"/>', {"unset": "goal"}),
        ('<Repeat num_cycles="-1"><AlwaysSuccess/></Repeat>', {"times": "forever"}),
        (f'<Parallel failure_count="2">{TWO}</Parallel>', {"children": 2}),
        (f'<Parallel success_count="1" failure_count="2">{TWO}</Parallel>', {"succeed": "any"}),
        (f"<ParallelAll>{TWO}</ParallelAll>", {"on_done": "wait"}),
        ('<Timeout msec="250"><AlwaysSuccess/></Timeout>', {"seconds": 0.25}),
    ],
)
def test_elements_become_nodes(xml, node):
    root = root_of(xml)
    body = root if set(node) & set(root) else next(iter(root.values()))
    for key, value in node.items():
        assert body[key] == value or len(body[key]) == value


@pytest.mark.parametrize("name", REFUSED)
def test_known_nodes_that_cannot_be_said_are_refused_with_advice(name):
    (told,) = refusals(f"<Sequence><{name}/></Sequence>")
    assert told.startswith("t.xml:1:")
    assert f"<{name}>: {REFUSED[name]}" in told


@pytest.mark.parametrize(
    ("xml", "said"),
    [
        ("<Sequence/>", "expected one children, got 0"),
        ("<Inverter/>", "expected 1 children, got 0"),
        (f"<Inverter>{TWO}</Inverter>", "expected 1 children, got 2"),
        ("<IfThenElse><AlwaysSuccess/></IfThenElse>", "expected 2 or 3 children"),
        ('<Repeat num_cycle="2"><AlwaysSuccess/></Repeat>', "did you mean 'num_cycles'"),
        ('<Repeat num_cycles="x"><AlwaysSuccess/></Repeat>', "expected int, got 'x'"),
        ('<Repeat num_cycles="0"><AlwaysSuccess/></Repeat>', "never runs its child"),
        ('<RetryUntilSuccessful num_attempts="-2"><A/></RetryUntilSuccessful>', "never runs"),
        (f'<Parallel success_count="3">{TWO}</Parallel>', "asks for 3 of 2 children"),
        ("<Timeout><A/></Timeout>", "needs the port 'msec'"),
        ('<Script code="x := a | b"/>', "'|' works on bits"),
        ('<Script code="@x := 1"/>', "root's blackboard"),
        ('<ScriptCondition code="x := 1"/>', "one condition that sets nothing"),
        ('<A goal="{@goal}"/>', "root's blackboard"),
        ('<SubTree ID="Mainn"/>', "did you mean 'Main'"),
        ("<Mine><A/></Mine>", "runs the decorator 'Mine', which is not built in"),
        ("<Mine><A/><B/></Mine>", "runs the control 'Mine', which is not built in"),
        ('<Action goal="1"/>', "needs an ID"),
        ('<A _skipIff="true"/>', "did you mean '_skipIf'"),
        ('<IfThenElse><A _skipIf="x"/><B/></IfThenElse>', "may be SKIPPED"),
        (f'<Parallel><A _skipIf="x"/>{TWO}</Parallel>', "may be SKIPPED"),
        ('<Fallback><Sequence><A _skipIf="x"/></Sequence></Fallback>', "may be SKIPPED"),
        ('<A _onSuccess="x := 1; x := 2"/>', "sets a key twice"),
    ],
)
def test_what_cannot_be_said_is_refused_with_its_place(xml, said):
    told = refusals(f"<Sequence><Script code='x := true'/>{xml}</Sequence>")
    assert any(said in one and one.startswith("t.xml:1:") for one in told), told


def test_all_refusals_come_at_once_with_line_and_column():
    told = refusals(
        '<Sequence>\n <RoundRobin><A/>\n  <Sleep/></RoundRobin>\n <Sleep msec="x"/></Sequence>'
    )
    assert [one.split(": ")[0] for one in told] == ["t.xml:2:2", "t.xml:3:3", "t.xml:4:2"]


@pytest.mark.parametrize("version", ["3", "5"])
def test_other_versions_are_refused(version):
    data = f'<root BTCPP_format="{version}"><BehaviorTree ID="A"><A/></BehaviorTree></root>'
    with pytest.raises(DocumentError, match="convert_v3_to_v4"):
        import_text("t.xml", data.encode(), NOTHING)


def test_words_of_cpp_enums_are_given():
    xml = "<Sequence><Script code='c := RED'/><ScriptCondition code='c == RED'/></Sequence>"
    children = root_of(xml, enums={"RED": 2})["sequence"]["children"]
    assert children == [{"set": {"c": 2}}, {"when": "c == 2"}]


def test_directions_come_from_models_literals_and_order():
    more = (
        '<TreeNodesModel><Action ID="Say"><input_port name="text" type="std::string"/></Action>'
        "</TreeNodesModel>"
    )
    body = (
        '<Sequence><Plan goal="{goal}" path="{path}"/><Follow path="{path}" speed="0.5"/>'
        '<Say text="{said}"/></Sequence>'
    )
    made = import_text("t.xml", document(body, more=more), NOTHING)
    plan, follow, say = data_of(made.files["main.yaml"])["root"]["sequence"]["children"]
    assert plan == {"skill": "plan", "in": {"goal": "$goal"}, "out": {"path": "$path"}}
    assert follow == {"skill": "follow", "in": {"path": "$path", "speed": 0.5}}
    assert data_of(made.files["main.yaml"])["in"].keys() == {"goal", "said"}
    assert sum("no model says" in str(note) for note in made.notes) == 3
    assert say == {"skill": "say", "in": {"text": "$said"}}


def test_a_leaf_that_is_at_hand_is_no_stub():
    class Plan(Skill):
        OUT = {"path": Port(list[float])}  # noqa: RUF012 - as skills declare them

        def run(self, goal: str) -> SkillRun:
            yield

    skills = Registry("skill")
    skills.add("plan_path", Plan)
    made = import_text("t.xml", document('<PlanPath goal="7" path="{p}"/>'), skills)
    assert list(made.files) == ["main.yaml"]
    root = data_of(made.files["main.yaml"])["root"]
    assert root == {"skill": "plan_path", "in": {"goal": "7"}, "out": {"path": "$p"}}


NAVIGATE = """
<ReactiveSequence>
  <!-- give up only when the battery does -->
  <IsBatteryHigh min="0.2"/>
  <RetryUntilSuccessful num_attempts="6">
    <Fallback name="NavigateRecovery">
      <Sequence name="NavigateWithReplanning">
        <ComputePath goal="{goal}" path="{path}" planner_id="GridBased" error_code="{code}"/>
        <FollowPath path="{path}" controller_id="FollowPath"/>
      </Sequence>
      <ForceFailure>
        <Fallback name="RecoveryActions">
          <ScriptCondition code="code == 0"/>
          <ClearCostmap name="ClearAll" service="local"/>
          <Spin angle="1.57"/><Wait duration_s="5"/>
        </Fallback>
      </ForceFailure>
    </Fallback>
  </RetryUntilSuccessful>
</ReactiveSequence>
"""


def test_a_navigation_tree_imports_checks_and_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "nav.xml").write_bytes(document(NAVIGATE, main="NavigateToPose"))
    runner = CliRunner()
    command = ["import", "nav.xml", "-o", "nav", "--mission", "go"]
    result = runner.invoke(app, command)
    assert result.exit_code == 0, result.output
    result = runner.invoke(app, ["run", "nav/go.yaml", "--json"])
    assert result.exit_code == 0, result.output
    result = runner.invoke(app, command)
    assert result.exit_code != 0
    assert "exists already" in str(result.exception)


def test_files_are_included_relative_to_the_file(tmp_path):
    (tmp_path / "sub").mkdir()
    inner = '<root BTCPP_format="4"><BehaviorTree ID="Grip"><Close/></BehaviorTree></root>'
    (tmp_path / "sub" / "grip.xml").write_text(inner)
    main = document('<SubTree ID="Grip"/>', more='<include path="sub/grip.xml"/>')
    (tmp_path / "main.xml").write_bytes(main)
    made = import_file(tmp_path / "main.xml", NOTHING)
    assert sorted(made.files) == ["grip.yaml", "main.yaml", "main_stubs.yaml"]


def test_ports_of_another_file_are_read(tmp_path):
    models = (
        '<root BTCPP_format="4"><TreeNodesModel><Action ID="Plan">'
        '<output_port name="cost" type="int"/></Action></TreeNodesModel></root>'
    )
    (tmp_path / "models.xml").write_text(models)
    (tmp_path / "main.xml").write_bytes(document('<Plan cost="{cost}"/>'))
    made = import_file(
        tmp_path / "main.xml", NOTHING, ImportOptions(models=(tmp_path / "models.xml",))
    )
    assert data_of(made.files["main_stubs.yaml"])["skills"]["plan"]["out"] == {
        "cost": {"type": "int"}
    }


def test_names_that_fall_together_are_told_apart():
    tree = tree_of('<Sequence><A name="Go!" x="{goal}"/><B name="go" y="{Goal}"/></Sequence>')
    first, second = tree["root"]["sequence"]["children"]
    assert {first["name"], second["name"]} == {"go", "go_2"}
    assert set(tree["in"]) == {"goal", "goal_2"}


def test_words_that_python_keeps_are_no_keys(tmp_path):
    made = imported('<Sequence><Script code="class := 1"/><A is="{class}"/></Sequence>')
    for name, text in made.files.items():
        (tmp_path / name).write_text(text)
    load_program(tmp_path / "main.yaml", skills=NOTHING, types=TYPES)
