"""The expression language: what it says, and what it refuses."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from toy_language import Colour, Part

from executive.core.errors import InputError
from executive.engine.language.expression import parse_expression
from executive.engine.language.porttypes import type_name
from executive.engine.loading.inference import infer

PART = Part(0.5, Colour.RED, (1, 2))
KEYS = {
    "table": dict[str, int],
    "part": Part,
    "parts": tuple[Part, ...],
    "n": int,
    "x": float,
    "ok": bool,
    "s": str,
}
VALUES = {
    "table": {"depth": 2},
    "part": PART,
    "parts": (PART,),
    "n": 3,
    "x": 0.5,
    "ok": True,
    "s": "red",
}


@pytest.mark.parametrize(
    ("text", "value", "kind"),
    [
        ('part.colour == "red"', True, "bool"),
        ('part.colour in ["green", "blue"]', False, "bool"),
        ("part.kind == 'part'", True, "bool"),
        ("part.kind", "part", "str"),
        ("size(parts) > 0 and x < 0.8", True, "bool"),
        ("not ok or n >= 3", True, "bool"),
        ("0 < x < 1", True, "bool"),
        ("parts[0].holes[1]", 2, "int"),
        ("table.depth + 1", 3, "int"),
        ("table['depth']", 2, "int"),
        ("n + 1", 4, "int"),
        ("n / 2", 1.5, "float"),
        ("n * x", 1.5, "float"),
        ("-n % 2", 1, "int"),
        ("max(n, 5)", 5, "int"),
        ("abs(x - 1)", 0.5, "float"),
        ("part if ok else none", PART, "Part | None"),
        ("s == 'red' and true != false", True, "bool"),
        ("written(part) and not written(other)", True, "bool"),
        ("[n, 4]", [3, 4], "list[int]"),
        ("part is none", False, "bool"),
    ],
)
def test_values_and_types_of_expressions(text, value, kind):
    expression = parse_expression(text)
    assert expression.evaluate(VALUES) == value
    assert type_name(infer(expression, KEYS)) == kind


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("__import__('os').system('x')", "unknown function"),
        ("part.__class__", "field '__class__' is private"),
        ("part.holes.count(1)", "unknown function 'part.holes.count'"),
        ("(lambda: 1)()", "unknown function"),
        ("[k for k in parts]", "'[k for k in parts]' is not part of the language"),
        ("f'{x}'", "is not part of the language"),
        ("n ** 9", "not part of the language"),
        ("n << 9", "not part of the language"),
        ("{1: 2}", "not part of the language"),
        ("(n := 3)", "not part of the language"),
        ("b'x'", "not part of the language"),
        ("...", "not part of the language"),
        ("siz(parts)", "unknown function 'siz'; did you mean 'size'?"),
        ("size()", "at least one"),
        ("written(part.mass_kg)", "written() asks for one name"),
        ("n >", "is not an expression"),
        ("", "is not an expression"),
        ("a; b", "is not an expression"),
        ("a && b", "invalid syntax; try and"),
        ("a || b", "invalid syntax; try or"),
        ("a == !b", "invalid syntax; try not"),
        ('a = "b"', "try =="),
        ("a ? 1 : 2", "try a if c else b"),
        ("$a > 1", "try keys without a $ inside an expression"),
    ],
)
def test_the_gate_refuses_what_is_not_in_the_language(text, message):
    with pytest.raises(InputError) as refused:
        parse_expression(text)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("part.mas_kg > 1", "Part has no field 'mas_kg'; did you mean 'mass_kg'?"),
        ('part.colour == "rd"', "Colour has no value 'rd'; did you mean 'red'?"),
        ("parts > 0", "cannot order list[Part] with int; try a number, a field or size()"),
        ("parts and ok", "parts is list[Part], not true or false; try a comparison"),
        ("size(x)", "float has no size"),
        ("part + 1", "part is Part, not a number"),
    ],
)
def test_what_can_never_work_is_known_before_the_first_tick(text, message):
    with pytest.raises(InputError) as refused:
        infer(parse_expression(text), KEYS)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("other > 1", "'other' has no value: nothing has written it yet"),
        ("1 / (n - 3) > 0", "ZeroDivisionError"),
        ("parts[7]", "IndexError"),
        ("s < 1", "TypeError"),
    ],
)
def test_what_fails_at_run_time_names_the_expression(text, message):
    with pytest.raises(InputError) as failed:
        parse_expression(text).evaluate(VALUES)
    assert text in str(failed.value)
    assert message in str(failed.value)


def test_reads_are_the_names_that_need_a_value():
    expression = parse_expression("written(a) and b.c > d[0] and true")
    assert expression.reads == {"b", "d"}
    assert expression.asks == {"a"}


@given(st.text(max_size=40))
def test_any_text_is_an_expression_or_is_refused(text):
    with contextlib.suppress(InputError):
        parse_expression(text)


@given(st.integers(-9, 9), st.integers(-9, 9), st.sampled_from(["+", "-", "*", "<", "==", ">="]))
def test_arithmetic_is_that_of_python(a, b, operator):
    ours = parse_expression(f"a {operator} b").evaluate({"a": a, "b": b})
    assert ours == eval(f"a {operator} b", {"a": a, "b": b})
