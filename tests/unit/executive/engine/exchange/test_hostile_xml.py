"""Whatever is imported becomes documents or faults; nothing is fetched, expanded or raised."""

import contextlib
import string

import pytest
from foreign_runs import NOTHING, TYPES, document, imported
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from executive.core.errors import DocumentError, InputError
from executive.engine.exchange.importing import ImportOptions, import_file, import_text
from executive.engine.exchange.naming import Namer
from executive.engine.exchange.scripts import Vocabulary, read_script
from executive.engine.exchange.vocabulary import CONDITIONS, ENDINGS, PORTS, REFUSED
from executive.engine.loading.loader import load_program

LAUGHS = """<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">
<!ENTITY c "&b;&b;&b;&b;">]><root BTCPP_format="4"><BehaviorTree ID="&c;"/></root>"""
OUTSIDE = """<!DOCTYPE root [<!ENTITY x SYSTEM "file:///etc/hostname">]>
<root BTCPP_format="4"><BehaviorTree ID="M"><A said="&x;"/></BehaviorTree></root>"""


def fault_of(data):
    with pytest.raises(DocumentError) as caught:
        import_text("t.xml", data, NOTHING)
    return str(caught.value)


@pytest.mark.parametrize("text", [LAUGHS, OUTSIDE])
def test_a_document_type_is_refused_before_an_entity_exists(text):
    assert "declares a document type" in fault_of(text.encode())


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "t.xml:1:1: not XML: no element found"),
        (b"<root>", "not XML"),
        (b'<?xml version="1.0" encoding="nonsense"?><root/>', "not XML: unknown encoding"),
        (b"\xff\xfe<", "not XML"),
        (b"<html/>", "expected the element <root>"),
        (b"<root BTCPP_format='4'/>", "holds no BehaviorTree"),
        (b"<root>" + b"<a>" * 500, "nested deeper than"),
        (b" " * 10_000_001, "holds 10000001 bytes"),
    ],
)
def test_what_is_no_tree_is_answered(data, said):
    assert said in fault_of(data)


def test_trees_that_multiply_are_refused():
    """Thirty trees, each using the next one twice, would be a billion nodes."""
    trees = "".join(
        f'<BehaviorTree ID="T{i}"><Sequence><SubTree ID="T{i + 1}"/><SubTree ID="T{i + 1}"/>'
        "</Sequence></BehaviorTree>"
        for i in range(30)
    )
    more = trees + '<BehaviorTree ID="T30"><AlwaysSuccess/></BehaviorTree>'
    assert "with all subtrees put in" in fault_of(document('<SubTree ID="T0"/>', more=more))


def test_trees_that_are_too_deep_are_refused():
    inner = "<Inverter>" * 90 + "{}" + "</Inverter>" * 90
    trees = "".join(
        f'<BehaviorTree ID="T{i}">' + inner.format(f'<SubTree ID="T{i + 1}"/>') + "</BehaviorTree>"
        for i in range(5)
    )
    more = trees + '<BehaviorTree ID="T5"><AlwaysSuccess/></BehaviorTree>'
    assert "deeper than 200" in fault_of(document('<SubTree ID="T0"/>', more=more))


def test_a_tree_that_contains_itself_is_refused():
    assert "would contain itself: Main > Main" in fault_of(document('<SubTree ID="Main"/>'))


def test_files_that_include_each_other_are_read_once(tmp_path):
    one, two = tmp_path / "one.xml", tmp_path / "two.xml"
    root = '<root BTCPP_format="4" main_tree_to_execute="A"><include path="{}"/>{}</root>'
    tree = '<BehaviorTree ID="{}">{}</BehaviorTree>'
    one.write_text(root.format("two.xml", tree.format("A", '<SubTree ID="B"/>')))
    two.write_text(root.format("one.xml", tree.format("B", "<AlwaysSuccess/>")))
    assert sorted(import_file(one, NOTHING).files) == ["a.yaml", "b.yaml"]


@pytest.mark.parametrize(
    "include", ['<include path="none.xml"/>', "<include/>", '<include ros_pkg="p" path="q"/>']
)
def test_an_include_that_leads_nowhere_is_refused(include):
    more = f'<BehaviorTree ID="X"><AlwaysSuccess/></BehaviorTree>{include}'
    assert "t.xml:1:" in fault_of(document("<AlwaysSuccess/>", more=more))


TAGS = st.sampled_from([*PORTS, *REFUSED, "SubTree", "Action", "Control", "Mine", "Yours"])
KEYS = sorted({port for ports in PORTS.values() for port in ports} | {"ID", "name", "goal"})
NAMES = st.sampled_from([*KEYS, *CONDITIONS, *ENDINGS, "_autoremap", "_odd"])
TEXTS = st.sampled_from(
    [
        *("{x}", "{y}", "{=}", "1", "-1", "2", "0", "x", "true", "false", "1;2", "SKIPPED"),
        *("x := 1", "x += y", "x > 1 && y", "Main", "Sub", "{@x}", "json:[1]", "json:{", "'a'"),
    ]
) | st.text(st.characters(codec="utf-8", exclude_categories=("C",)), max_size=8)


def escaped(text):
    return "".join(f"&#{ord(c)};" if c in "<>&\"'" else c for c in text)


@st.composite
def elements(draw, inner=None):
    tag = draw(TAGS)
    names = st.sampled_from([*PORTS.get(tag, ()), "ID", "name", "goal"]) | NAMES
    attributes = draw(st.dictionaries(names, TEXTS, max_size=4))
    children = draw(st.lists(inner, max_size=3)) if inner is not None else []
    said = "".join(f' {k}="{escaped(v)}"' for k, v in attributes.items())
    return f"<{tag}{said}>{''.join(children)}</{tag}>"


TREES = st.recursive(elements(), elements, max_leaves=8)


def is_handled(data, folder):
    """Import; what comes out loads or has faults, and nothing else is raised."""
    try:
        made = import_text("t.xml", data, NOTHING, ImportOptions(mission="go"))
    except InputError:
        return
    for name, text in made.files.items():
        (folder / name).write_text(text, encoding="utf-8")
    try:
        load_program(folder / "go.yaml", skills=NOTHING, types=TYPES)
    except DocumentError as error:
        text = str(error)  # a foreign tree may be wrong, but what is written is our language
        assert "unknown k" not in text, text
        assert "not YAML" not in text, text
        assert "is not an expression" not in text, text


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(TREES, min_size=1, max_size=2))
def test_any_tree_becomes_documents_or_faults(tmp_path_factory, trees):
    more = f'<BehaviorTree ID="Sub">{trees[-1]}</BehaviorTree>'
    is_handled(document(trees[0], more=more), tmp_path_factory.mktemp("any"))


@settings(deadline=None, max_examples=150)
@given(st.binary(max_size=200) | st.text(max_size=60).map(lambda t: document(t)[:-8] + t.encode()))
def test_any_bytes_become_documents_or_faults(data):
    with contextlib.suppress(InputError):
        import_text("t.xml", data, NOTHING)


@settings(deadline=None, max_examples=200)
@given(
    st.text(string.printable, max_size=30)
    | st.lists(
        st.sampled_from(["a", "b", "1", "2.5", "'t'", "+", "-", "*", "(", ")", "?", ":", "&&"])
        | st.sampled_from(["||", ":=", "=", "+=", ";", "<", "==", "!", "true", "~", "0x1F"]),
        max_size=10,
    ).map(" ".join)
)
def test_any_text_is_a_script_or_is_refused(text):
    try:
        statements = read_script(text, Vocabulary(Namer("key")))
    except InputError:
        return
    for statement in statements:
        assert compile(statement.text, "script", "eval")


def test_a_comment_cannot_break_out_of_its_line():
    made = imported("<Sequence><!-- a\nroot: b\x85c --><AlwaysSuccess/></Sequence>")
    assert "\nroot: b" not in made.files["main.yaml"]
