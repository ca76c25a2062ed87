"""YAML text and where its values stand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.engine.language.sources import read_source


def messages(text):
    return [str(fault) for fault in read_source("t.yaml", text).faults]


def test_scalars_follow_the_core_schema_of_yaml_1_2():
    data = read_source("t.yaml", "[true, on, no, 1, 0x10, 1e3, .5, .inf, ~, null, 2001-01-01]").data
    assert data == [
        True,
        "on",
        "no",
        1,
        "0x10",
        1000.0,
        0.5,
        float("inf"),
        None,
        None,
        "2001-01-01",
    ]


def test_quoted_scalars_are_text():
    assert read_source("t.yaml", "['1', \"true\", '~']").data == ["1", "true", "~"]


def test_every_key_and_value_has_its_line_and_column():
    source = read_source("t.yaml", "a: 1\nb:\n  - c: x\n")
    assert source.key_mark(("b", 0, "c")) == (3, 5)
    assert source.value_mark(("b", 0, "c")) == (3, 8)


def test_position_of_something_missing_is_that_of_what_holds_it():
    source = read_source("t.yaml", "a: 1\nb: {c: 2}\n")
    assert source.key_mark(("b", "x", "y")) == (2, 1)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\nb: 2\na: 3\n", "t.yaml:3:1: duplicate key 'a'; the first one is in line 1"),
        ("a: !!python/name:os.system x", "t.yaml:1:4: unknown tag"),
        ("a: &x 1\nb: *x", "t.yaml:1:4: anchor or alias 'x'; documents carry none"),
        ("1: x", "t.yaml:1:1: a key must be a word"),
        ("a: [1,", "t.yaml:2:1: not YAML: while parsing a flow node"),
        ("a: 1\n---\nb: 1", "t.yaml:2:1: not YAML: expected a single document"),
        ("a: \x00", "t.yaml:1:1: not YAML"),
    ],
)
def test_what_could_be_misread_is_refused(text, message):
    assert any(fault.startswith(message) for fault in messages(text)), messages(text)


def test_every_fault_of_a_text_is_found_in_one_pass():
    assert len(messages("a: &x 1\nb: *x\n")) == 2
    assert len(messages("a: 1\na: 2\nb: 1\nb: 2\n")) == 2


def test_deep_nesting_is_a_fault_and_no_crash():
    assert messages("[" * 5000 + "]" * 5000)


@given(st.text(max_size=60))
def test_any_text_gives_values_or_faults(text):
    source = read_source("t.yaml", text)
    assert all(fault.line >= 1 and fault.column >= 1 for fault in source.faults)


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.from_regex(r"[a-z]{1,8}", fullmatch=True),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(st.from_regex(r"[a-z]{5,8}", fullmatch=True), inner, max_size=3)
        ),
        max_leaves=10,
    )
)
def test_values_survive_writing_and_reading(value):
    import json

    if value in ("true", "false", "null"):
        return
    assert read_source("t.yaml", json.dumps(value)).data == value


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a:\n\tb: 1\n", "t.yaml:2:1: not YAML: a tab in the indentation; expected blanks"),
        ("a:\n    - b\n   - c\n", "look at the indentation of this line"),
        ("a: {b: 1\nc: 2\n", "look at brackets, commas and quotes"),
        ('a: "b\n', "look at the closing quote"),
    ],
)
def test_what_is_not_yaml_says_where_to_look(text, message):
    assert message in messages(text)[0]
