"""The canonical form of documents: same meaning, same comments, and it stays as it is."""

from collections import Counter
from textwrap import dedent

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from executive.cli.main import app
from executive.core.errors import DocumentError
from executive.engine.formatting.formatter import format_text
from executive.engine.formatting.order import node_order
from executive.engine.language.block_models import BLOCKS, KINDS, LEAVES
from executive.engine.language.comments import find_comments
from executive.engine.language.node_models import NodeModel
from executive.engine.language.sources import read_source
from executive.engine.loading.library import packaged_trees
from executive.engine.loading.validation import validate

MESSY = """\
# At the head.

tree: t   # its name
format: 1
out: {b: {about: "an end", type: float, unit: m}}
in:


  a: {default: 'x y', type: str}   # to be said
root:
  # Above the root.
  sequence:
    children:   # in order
    - {in: {label: "$a", ticks: 2},   # first
       skill: work}
    # Above a set.

    - set: {b: '1.0'}
      # Below the set.
    # Above the name.
    name: t
# The very last.
"""
CLEAN = """\
# At the head.

format: 1
tree: t  # its name
in:
  a: {type: str, default: x y}  # to be said
out:
  b: {type: float, unit: m, about: an end}
root:
  # Above the root.
  sequence:
    # Above the name.
    name: t
    children:  # in order
      - {skill: work, in: {label: $a, ticks: 2}}  # first
      # Above a set.

      - set: {b: "1.0"}
        # Below the set.
# The very last.
"""
LONG = " ".join(["many words"] * 20)


def tree(root, **more):
    """Return a tree of a root node as text."""
    return yaml.safe_dump({"format": 1, "tree": "t", **more, "root": root}, sort_keys=False)


def meaning(text):
    """Return what a text says, with the order of its keys."""
    document, faults = validate(read_source("t.yaml", text))
    assert faults == []
    return repr(document)


def test_canonical_form_of_a_messy_document():
    assert format_text("t.yaml", MESSY) == CLEAN


def test_what_ships_is_in_its_canonical_form():
    for file in packaged_trees().rglob("*.yaml"):
        text = file.read_text(encoding="utf-8")
        assert format_text(str(file), text) == text, f"{file}: say: make fmt"


@pytest.mark.parametrize(
    ("said", "written"),
    [
        ("'x'", "x"),
        ("'true'", '"true"'),
        ("true", "true"),
        ("'12'", '"12"'),
        ("0x1", "0x1"),
        ("1e-3", "1e-3"),
        ("~", "null"),
        ("on", "on"),
        ("'a: b'", '"a: b"'),
        ("'a, b'", '"a, b"'),
        ("'a #b'", '"a #b"'),
        ("'a#b'", "a#b"),
        ("''", '""'),
        ("'- a'", '"- a"'),
        ("'$a[0]'", '"$a[0]"'),
        ("'[a]'", '"[a]"'),
        (r'"tab\there"', r'"tab\there"'),
        ("'it''s'", "it's"),
        (r'"\"left\" | \"right\""', '\'"left" | "right"\''),
        (r"""'"it''s"'""", r'"\"it' + "'" + r's\""'),
        ("'Grüße'", "Grüße"),
        (r'"\U0001F600"', "😀"),
    ],
)
def test_values_are_plain_where_that_means_the_same(said, written):
    text = f"format: 1\ntree: t\nroot: {{skill: work, in: {{a: {said}}}}}\n"
    assert format_text("t.yaml", text).splitlines()[2].endswith(f"in: {{a: {written}}}}}")


def test_leaves_stand_on_one_line_where_they_fit():
    text = format_text("t.yaml", tree({"skill": "work", "in": {f"x{i}": i for i in range(40)}}))
    assert "root:\n  skill: work\n  in:\n    x0: 0\n" in text
    short = format_text("t.yaml", tree({"in": {"x": 1}, "skill": "work", "name": "t"}))
    assert "root: {skill: work, name: t, in: {x: 1}}\n" in short


def test_long_texts_are_wrapped():
    text = format_text("t.yaml", tree({"when": "true"}, about=LONG))
    assert "about: >-\n  many words" in text
    assert max(map(len, text.splitlines())) <= 100


def test_lines_of_a_text_stay_lines():
    said = "one\n  two\nthree"
    root = {"skill": "work", "about": said, "in": {"a": "b\n"}}
    assert meaning(format_text("t.yaml", tree(root))) == meaning(tree(root))


@pytest.mark.parametrize("kind", KINDS)
def test_every_key_of_every_kind_has_its_place(kind):
    model = {**LEAVES, **BLOCKS}[kind]
    keys = [field.alias or name for name, field in model.model_fields.items()]
    assert sorted({kind, *keys}) == sorted(node_order(kind))
    assert node_order(kind)[:3] == [kind, "name", "about"]


def test_endings_come_after_what_they_end():
    order = node_order("skill")
    assert order.index("in") < order.index("out") < order.index("on_success")
    assert set(NodeModel.model_fields) >= {"name", "about"}


@pytest.mark.parametrize(
    "text",
    [
        "format: 1\ntree: t\nroot: {skill: 3}\n",
        "format: 1\ntree: [\n",
        "a: 1\na: 2\n",
        "",
        "format: 1\ntree: t\nroot: {when: *x}\n",
    ],
)
def test_a_document_with_faults_is_refused(text):
    with pytest.raises(DocumentError):
        format_text("t.yaml", text)


COMMENTS = st.lists(
    st.tuples(st.integers(0, 60), st.integers(0, 12), st.booleans(), st.booleans()), max_size=6
)
TEXTS = st.text(
    st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), min_size=1, max_size=12
) | st.sampled_from(["a b", "x: y", "# no", " lead", "multi\nline", "a\n\nb\n", "'", '"', "$a"])
NAMES = st.from_regex(r"[a-z][a-z0-9_]{0,5}", fullmatch=True)
DATA = st.recursive(
    st.none() | st.booleans() | st.integers(-9, 9) | st.floats(allow_nan=False) | TEXTS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXTS, inner, max_size=3),
    max_leaves=6,
)
LEAF = st.fixed_dictionaries(
    {"in": st.dictionaries(NAMES, DATA, max_size=3), "skill": NAMES},
    optional={"about": TEXTS, "if": st.just("x > 1"), "out": st.just({"a": "$a"})},
) | st.just({"when": 'a.b == "c"'})
IN_ORDER = st.sampled_from(["sequence", "parallel"])
NODES = st.recursive(
    LEAF,
    lambda inner: (
        st.tuples(IN_ORDER, st.lists(inner, min_size=1, max_size=3))
        .map(lambda pair: {pair[0]: {"about": "x", "children": pair[1]}})
        | st.lists(inner, min_size=1, max_size=2).map(lambda nodes: {"selector": nodes})
        | inner.map(lambda node: {"retry": {"child": node, "times": 3}})
        | inner.map(lambda node: {"switch": {"on": "x", "cases": {"a": node}}})
    ),
    max_leaves=6,
)  # fmt: skip


def commented(text, comments):
    """Return a text with comments and blank lines where the hypothesis wants them."""
    lines = text.splitlines()
    for number, column, alone, blank in comments:
        place = number % (len(lines) + 1)
        said = [" " * column + f"# c{number}"] + [""] * blank
        candidate = lines[:place] + said + lines[place:]
        if not alone and place < len(lines):
            candidate = [*lines]
            candidate[place] += f"  # t{number}"
        before = yaml.safe_load("\n".join(lines))
        try:
            same = yaml.safe_load("\n".join(candidate)) == before
        except yaml.YAMLError:
            same = False
        lines = candidate if same else lines
    return "\n".join(lines) + "\n"


@settings(max_examples=150, deadline=None)
@given(
    root=NODES, style=st.sampled_from([True, False, None]), comments=COMMENTS, ports=st.booleans()
)
def test_any_document_means_the_same_keeps_its_comments_and_stays_as_it_is(
    root, style, comments, ports
):
    more = {"in": {"b": {"default": 1, "type": "int"}}} if ports else {}
    plain = yaml.safe_dump(
        {"root": root, "tree": "t", "format": 1, **more},
        default_flow_style=style,
        allow_unicode=True,
        sort_keys=False,
    )
    text = commented(plain, comments)
    if validate(read_source("t.yaml", text))[0] is None:
        return  # what YAML 1.1 writes is not always what YAML 1.2 reads
    after = format_text("t.yaml", text)
    assert meaning(after) == meaning(text)
    assert Counter(c.text for c in find_comments(after)) == Counter(
        c.text for c in find_comments(text)
    )
    assert format_text("t.yaml", after) == after


@pytest.fixture
def cellwright():
    """Run the command line in this process."""
    return lambda *arguments: CliRunner().invoke(app, [str(one) for one in arguments])


def test_fmt_writes_check_and_diff_only_look(cellwright, tmp_path):
    file = tmp_path / "t.yaml"
    file.write_text(MESSY)
    file.chmod(0o640)
    looked = cellwright("fmt", "--check", file)
    assert (looked.exit_code, file.read_text()) == (1, MESSY)
    looked = cellwright("fmt", "--diff", tmp_path)
    assert (looked.exit_code, file.read_text()) == (1, MESSY)
    assert "-out: {b: {" in looked.stdout
    assert cellwright("fmt", file).exit_code == 0
    assert file.read_text() == CLEAN
    assert file.stat().st_mode & 0o777 == 0o640
    assert cellwright("fmt", "--check", file).exit_code == 0
    assert [one.name for one in tmp_path.iterdir()] == ["t.yaml"]


def test_fmt_leaves_files_with_faults_alone_and_formats_the_others(cellwright, tmp_path):
    bad = dedent("""\
        format:   1
        tree: bad
        root: {skil: work}
        """)
    (tmp_path / "bad.yaml").write_text(bad)
    (tmp_path / "t.yaml").write_text(MESSY)
    result = cellwright("fmt", tmp_path)
    assert result.exit_code == 2
    assert "bad.yaml:3:7: bad: unknown kind of node 'skil'; did you mean 'skill'?" in result.stdout
    assert (tmp_path / "bad.yaml").read_text() == bad
    assert (tmp_path / "t.yaml").read_text() == CLEAN
