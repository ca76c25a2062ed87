"""Export and import undo each other where both languages can say a tree."""

import ast
import json

import pytest
from foreign_runs import NOTHING, TYPES, data_of, document, imported
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.core.errors import DocumentError
from executive.engine.exchange.exporting import export_program
from executive.engine.exchange.importing import import_text
from executive.engine.exchange.scripting import write_condition
from executive.engine.exchange.scripts import Vocabulary, read_script
from executive.engine.exchange.yamltext import flow
from executive.engine.language.expression import parse_expression
from executive.engine.loading.loader import load_program

HANDS = {
    "format": 1,
    "stubs": "t_stubs",
    "skills": {
        "grasp": {
            "in": {"width": {"type": "float"}, "part": {"type": "str"}, "n": {"type": "int"}},
            "out": {"force": {"type": "float"}},
            "outcomes": [{"outcome": "success", "out": {"force": 0.0}}],
        },
        "look": {
            "in": {"points": {"type": "list[float]"}, "wide": {"type": "bool"}},
            "outcomes": [{"outcome": "success"}],
        },
    },
}
TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("Cs",)), max_size=6)
FLOATS = st.floats(allow_nan=False, allow_infinity=False)
CONDITIONS = st.sampled_from(["k > 1", "done", "not done", "k == 2 and done", "done or k < 1"])


def grasps():
    return st.fixed_dictionaries(
        {
            "skill": st.just("grasp"),
            "in": st.fixed_dictionaries(
                {
                    "width": FLOATS | st.just("$force"),
                    "part": TEXTS.map(lambda t: f"${t}" if t.startswith("$") else t),
                    "n": st.integers(-9, 9) | st.just("$k"),
                }
            ),
        },
        optional={"out": st.just({"force": "$force"})},
    )


LEAVES = (
    grasps()
    | st.fixed_dictionaries(
        {
            "skill": st.just("look"),
            "in": st.fixed_dictionaries(
                {"points": st.lists(FLOATS, max_size=3), "wide": st.booleans()}
            ),
        }
    )
    | st.sampled_from(
        [{"when": True}, {"when": False}, {"wait": 0.25}, {"set": {"k": "k + 1"}}, {"unset": "u"}]
    )
    | CONDITIONS.map(lambda text: {"when": text})
    | st.just({"set": {"k": "2", "done": "k == 2 and not done"}})
)


@st.composite
def blocks(draw, inner):
    several = st.lists(inner, min_size=1, max_size=3)
    kind = draw(st.integers(0, 6))
    if kind <= 1:
        names = ["sequence", "reactive_sequence", "selector", "reactive_selector"]
        node = {draw(st.sampled_from(names)): {"children": draw(several)}}
    elif kind == 2:
        count = len(children := draw(several))
        need = draw(st.integers(1, count))
        succeed = "all" if need == count else "any" if need == 1 else need
        node = {"parallel": {"children": children, "succeed": succeed}}
    elif kind == 3:
        children = draw(st.lists(inner, min_size=2, max_size=3))
        node = {draw(st.sampled_from(["if_then_else", "while_do_else"])): {"children": children}}
    else:
        more = st.sampled_from(
            [
                ("retry", {"times": 3}),
                ("retry", {"times": "forever"}),
                ("repeat", {"times": "$k"}),
                ("timeout", {"seconds": 1.5}),
                ("run_once", {}),
                *((name, {}) for name in ("inverter", "force_success", "force_failure")),
            ]
        )
        name, body = draw(more)
        node = {name: {**body, "child": draw(inner)}}
    return _guarded(draw, node)


def _guarded(draw, node):
    (kind,) = node
    guards = draw(
        st.fixed_dictionaries(
            {},
            optional={
                "name": st.sampled_from(["one", "two"]),
                "if": CONDITIONS,
                "unless": CONDITIONS,
                "on_success": st.just({"k": "k + 1"}),
                "on_failure": st.just({"done": "true"}),
                "on_halt": st.just({"k": "0"}),
            },
        )
    )
    return {kind: {**guards, **node[kind]}}


ROOTS = st.recursive(LEAVES, blocks, max_leaves=7).map(
    lambda root: {
        "sequence": {
            "children": [
                {"set": {"k": "1", "done": "false", "force": "0.5", "u": "1"}},
                root,
            ]
        }
    }
)


def normal(value, key=""):
    """Return a document as both ways of writing it say it."""
    if isinstance(value, dict):
        defaults = {"succeed": "all"}
        return {k: normal(v, k) for k, v in value.items() if defaults.get(k) != v}
    if isinstance(value, list):
        return [normal(item) for item in value]
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return f"{float(value)!r}"
    text = str(value)
    if key in ("when", "if", "unless", "done") and text:
        return ast.unparse(ast.parse(text))
    return f"{float(text)!r}" if text.isdecimal() else text


def unique_names(node):
    """Drop names that siblings share; no document may hold them."""
    if isinstance(node, dict):
        seen = set()
        for child in node.get("children", []):
            for body in child.values():
                if isinstance(body, dict) and "name" in body:
                    if body["name"] in seen:
                        del body["name"]
                    else:
                        seen.add(body["name"])
        for value in node.values():
            unique_names(value)
    elif isinstance(node, list):
        for item in node:
            unique_names(item)


def export(folder, root):
    tree = {"format": 1, "tree": "t", "uses": ["t_stubs"], "root": root}
    (folder / "t.yaml").write_text(flow(tree), encoding="utf-8")
    (folder / "t_stubs.yaml").write_text(json.dumps(HANDS))
    return export_program(load_program(folder / "t.yaml", skills=NOTHING, types=TYPES))


@settings(deadline=None, max_examples=60)
@given(ROOTS)
def test_a_tree_that_is_exported_and_imported_is_the_same(tmp_path_factory, root):
    unique_names(root)
    xml = export(tmp_path_factory.mktemp("trip"), root).text
    again = import_text("t.xml", xml.encode(), NOTHING)
    assert normal(data_of(again.files["t.yaml"])["root"]) == normal(root)


FOREIGN = """
<Sequence>
  <Script code="n := 0; ready := false"/>
  <Fallback name="find">
    <A goal="1;2" speed="0.5" _successIf="ready" _onFailure="n += 1"/>
    <SequenceWithMemory><A goal="3;4" speed="1.5"/><B found="{pose}"/></SequenceWithMemory>
  </Fallback>
  <Parallel success_count="2" failure_count="2"><B found="{x}"/><B found="{y}"/><C/></Parallel>
  <ParallelAll max_failures="2"><C/><C/><C/></ParallelAll>
  <RetryUntilSuccessful num_attempts="-1"><Timeout msec="500"><C/></Timeout></RetryUntilSuccessful>
  <Repeat num_cycles="{n}"><Delay delay_msec="100"><C/></Delay></Repeat>
  <LoopInt queue="1;2;3" value="{i}"><C/></LoopInt>
  <RunOnce><C/></RunOnce>
  <Switch2 variable="{n}" case_1="0" case_2="1"><C/><C/><AlwaysFailure/></Switch2>
  <C _skipIf="n &gt; 3 || ready" _while="n == 0"/>
  <SubTree ID="Sub" n="{n}"/>
</Sequence>
"""
SUB = """
<BehaviorTree ID="Sub"><Sequence><ScriptCondition code="n == 0"/><D/></Sequence></BehaviorTree>
<TreeNodesModel>
  <Action ID="A"><input_port name="goal" type="std::vector&lt;int&gt;"/>
    <input_port name="speed" type="double"/></Action>
  <Action ID="B"><output_port name="found" type="Pose2D"/></Action>
</TreeNodesModel>
"""


def test_xml_that_is_imported_and_exported_settles_after_one_trip(tmp_path):
    """Names change once, wrappers appear once; what is exported then comes back as it is."""
    data, texts = document(FOREIGN, more=SUB), []
    for trip in ("one", "two", "three"):
        folder = tmp_path / trip
        folder.mkdir()
        for name, text in import_text("main.xml", data, NOTHING).files.items():
            (folder / name).write_text(text)
        program = load_program(folder / "main.yaml", skills=NOTHING, types=TYPES)
        data = export_program(program).text.encode()
        texts.append(data)
    assert texts[1] == texts[2]
    assert b'num_attempts="-1"' in texts[0]
    assert b'goal="1;2"' in texts[0]


NUMBERS = st.recursive(
    st.sampled_from(["1", "2.5", "n", "m"]),
    lambda inner: (
        st.tuples(inner, st.sampled_from("+-*"), inner).map("({0[0]}) {0[1]} ({0[2]})".format)
        | inner.map("-({})".format)
    ),
    max_leaves=3,
)
EXPRESSIONS = st.recursive(
    st.sampled_from(["a", "b", "true", "'t' == 't'"])
    | st.tuples(NUMBERS, st.sampled_from(["<", "==", "!=", ">="]), NUMBERS).map(" ".join),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["and", "or"]), inner).map(
            "({0[0]}) {0[1]} ({0[2]})".format
        ),
        inner.map("not ({})".format),
        st.tuples(inner, inner, inner).map("({0[0]}) if ({0[1]}) else ({0[2]})".format),
    ),
    max_leaves=6,
)


@settings(deadline=None, max_examples=120)
@given(EXPRESSIONS)
def test_a_script_means_what_its_expression_meant(text):
    (back,) = read_script(write_condition(text), Vocabulary(str))
    before, after = parse_expression(text), parse_expression(back.text)
    for a in (True, False):
        for b in (True, False):
            names = {"a": a, "b": b, "n": 2, "m": 0.5}
            assert before.evaluate(names) == after.evaluate(names)


@pytest.mark.parametrize(
    ("root", "said"),
    [
        ({"cooldown": {"seconds": 1, "child": {"when": True}}}, "cooldown has no counterpart"),
        ({"retry": {"times": 2, "delay_s": 0.5, "child": {"when": True}}}, "delay_s has no"),
        ({"wait": "forever"}, "wait: forever"),
        ({"wait": 0.00005}, "no whole number of milliseconds"),
        ({"when": "size([1]) > 0"}, "scripts of BehaviorTree.CPP cannot say"),
        ({"when": True, "on_start": {"k": "1"}}, "on_start has no counterpart"),
        ({"for_each": {"item": "$i", "in": "$[1, 2]", "child": {"when": True}}}, "a queue"),
        ({"switch": {"on": "'a'", "cases": {"a": {"when": True}}}}, "switch decides once"),
        (
            {"parallel": {"children": [{"when": True}, {"when": "1 > 2"}], "fail": "all"}},
            "fails with 1, try fail: 1",
        ),
        ({"skill": "look", "in": {"points": "$[1.0, 2.0]", "wide": True}}, "no expressions"),
    ],
)
def test_what_cannot_be_said_there_is_refused(tmp_path, root, said):
    with pytest.raises(DocumentError, match=r"t\.yaml:1:\d+: t") as caught:
        export(tmp_path, root)
    assert said in str(caught.value)


def test_all_refusals_come_at_once(tmp_path):
    root = {"sequence": [{"wait": "forever"}, {"chance": 0.5}, {"when": "7 % 2 == 1"}]}
    with pytest.raises(DocumentError) as caught:
        export(tmp_path, root)
    assert len(caught.value.faults) == 3


def test_what_differs_is_noted(tmp_path):
    root = {"retry": {"times": 2, "child": {"fail": "part.missing"}}}
    notes = " ".join(str(note) for note in export(tmp_path, root).notes)
    assert "within one tick there" in notes
    assert "the reason is left out" in notes


def test_comments_and_descriptions_are_kept():
    text = imported(
        "<Sequence><!-- look first --><A _description='what it is for'/></Sequence>"
    ).files["main.yaml"]
    assert "# look first" in text
    assert "about: what it is for" in text
