"""What expressions come to, held against Python's own evaluation of the same text."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from toy_language import Colour, Part

from executive.core.errors import InputError
from executive.engine.language.expression import parse_expression

VALUES = {
    "n": 3,
    "x": 0.5,
    "ok": True,
    "s": "red",
    "part": Part(0.5, Colour.RED, (1, 2)),
    "parts": (Part(1.5, Colour.GREEN, (4,)), Part(2.5, Colour.RED)),
    "table": {"depth": 2, "count": 7},
}
PYTHON = {
    **VALUES,
    **{"true": True, "false": False, "none": None, "size": len, "written": VALUES.__contains__},
}
TERMS = st.sampled_from(
    [
        *("n", "x", "ok", "s", "part", "parts", "true", "false", "none", "0", "2", "-1.5"),
        *("'red'", "''", "[]", "part.colour", "part.holes", "parts[0].mass_kg", "parts[n]"),
        *("table['count']", "size(parts)", "size(x)", "max(n, x)", "min(parts)", "round(x, 1)"),
        *("abs(n)", "part.nothing", "(n, x)"),
    ]
)
BINARY = ["+", "-", "*", "/", "//", "%", "==", "!=", "<", ">=", "in", "and", "or"]


def joined(inner):
    return st.one_of(
        st.builds("({} {} {})".format, inner, st.sampled_from(BINARY), inner),
        st.builds("({} < {} != {})".format, inner, inner, inner),
        st.builds("({} is not none)".format, inner),
        st.builds("({} not in {})".format, inner, inner),
        st.builds("(not {})".format, inner),
        st.builds("(-{})".format, inner),
        st.builds("({} if {} else {})".format, inner, inner, inner),
        st.builds("[{}, {}]".format, inner, inner),
        st.builds("[{0}, 1][{1}]".format, inner, inner),
    )


def python_says(text):
    """Return what Python makes of an expression, or that it fails."""
    try:
        return eval(
            text, {"__builtins__": {"max": max, "min": min, "abs": abs, "round": round}, **PYTHON}
        )
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        return InputError


def we_say(text):
    """Return what we make of an expression, or that it fails."""
    try:
        return parse_expression(text).evaluate(VALUES)
    except InputError:
        return InputError


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@settings(max_examples=400, deadline=None)
@given(st.recursive(TERMS, joined, max_leaves=6).filter(lambda text: "'red' %" not in text))
def test_expressions_come_to_what_python_makes_of_them(text):
    ours, pythons = we_say(text), python_says(text)
    assert type(ours) is type(pythons)
    assert ours == pythons


def test_fields_of_a_mapping_are_its_items():
    assert parse_expression("table.depth + 1").evaluate(VALUES) == 3
    assert parse_expression("table.count").evaluate(VALUES) == 7
    with pytest.raises(InputError, match="AttributeError"):
        parse_expression("table.width").evaluate(VALUES)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("s * 999999", "2999997 items; expected 100000 at most"),
        ("999999 * [1]", "999999 items"),
        ("long + long", "120000 items"),
        ("huge * huge", "a product of more than 4096 bits"),
        ("'%9999999d' % 1", "texts are not formatted"),
        ("part.holes.count", "'count' is no field of tuple, but a method"),
        ("s.upper", "'upper' is no field of str, but a method"),
    ],
)
def test_no_operation_exhausts_the_memory_or_reaches_a_method(text, message):
    values = {**VALUES, "long": "x" * 60_000, "huge": 1 << 3000}
    with pytest.raises(InputError) as refused:
        parse_expression(text).evaluate(values)
    assert message in str(refused.value)


@pytest.mark.parametrize("text", ["1" + " + 1" * 100, "not " * 100 + "ok"])
def test_expressions_are_not_nested_without_end(text):
    with pytest.raises(InputError, match="nested more than 60 deep"):
        parse_expression(text)


def test_warnings_of_python_are_faults_of_the_expression():
    with pytest.raises(InputError, match="invalid escape sequence"):
        parse_expression(r"'\d' == s")


@pytest.mark.parametrize("text", ["n is 3", "s is not 'red'", "n is part"])
def test_is_asks_for_constants_only(text):
    with pytest.raises(InputError, match="try == for other values"):
        parse_expression(text)
    assert parse_expression("ok is true and part is not none").evaluate(VALUES) is True


def test_and_or_stop_where_the_answer_is_known():
    assert parse_expression("written(y) and y > 1").evaluate({}) is False
    assert parse_expression("not written(y) or y > 1").evaluate({}) is True
