"""Names of types, which fits which, and literals made to fit."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
import pytest
from numpy.typing import NDArray
from toy_language import Colour, Part, toy_types

from executive.core.errors import InputError
from executive.engine.language.fitting import check, fit
from executive.engine.language.porttypes import accepts, parse_type, type_name


@runtime_checkable
class HasNote(Protocol):
    def note(self, line: str) -> None: ...


@pytest.mark.parametrize(
    "name",
    [
        *("int", "any", "Part", "list[Part]", "float | None", "list[list[int]]"),
        *("int | str | None", "dict[str, Part]", "dict[str, list[int]] | None"),
        *("tuple[float, float]", "list[tuple[int, str]]", "'left' | 'right'", "'both' | None"),
    ],
)
def test_names_of_types_survive_a_round_trip(name):
    assert type_name(parse_type(name, toy_types())) == name


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("flot", "unknown type 'flot'; did you mean 'float'?"),
        ("Prt", "did you mean 'Part'?"),
        ("list", "unknown type 'list'; did you mean 'list[...]'?"),
        ("dict[int]", "is not a type; expected a name, list[NAME], dict[str, NAME]"),
        ("set[int]", "is not a type"),
        ("tuple[]", "is not a type"),
        ("dict", "did you mean 'dict[...]'?"),
        ("1 +", "is not a type"),
    ],
)
def test_wrong_names_of_types_are_answered(name, message):
    with pytest.raises(InputError) as refused:
        parse_type(name, toy_types())
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("target", "source", "fits"),
    [
        (float, int, True),
        (int, float, False),
        (int, bool, False),
        (float, bool, False),
        (bool, bool, True),
        (str, Colour, True),
        (Colour, str, False),
        (Any, Part, True),
        (Part, Any, True),
        (float | None, float, True),
        (float, float | None, False),
        (int | str, Literal[1, 2], True),
        (Literal["a", "b"], Literal["a"], True),
        (Literal["a"], str, False),
        (tuple[Part, ...], Sequence[Part], True),
        (list[float], tuple[int, ...], True),
        (tuple[float, float], tuple[int, int], True),
        (tuple[float, float], tuple[int, int, int], False),
        (Sequence[Part], list[str], False),
        (NDArray[np.float64], np.ndarray, True),
        (np.ndarray, Part, False),
        (Sequence[int], str, False),
        (Mapping[str, float], dict[str, int], True),
        (dict[str, int], Mapping[str, str], False),
        (dict[str, int], list[int], False),
        (dict, Mapping[str, Part], True),
        (Literal["a", "b"] | None, Literal["b"], True),
        (Literal[1], Literal[True], False),
        (Colour | None, None | Colour, True),
    ],
)
def test_which_type_fits_which(target, source, fits):
    assert accepts(target, source) is fits


@pytest.mark.parametrize(
    ("literal", "kind", "value"),
    [
        (2, float, 2.0),
        ("red", Colour, Colour.RED),
        ([1, 2], tuple[int, ...], (1, 2)),
        ([1, 2], list[float], [1.0, 2.0]),
        (None, float | None, None),
        ({"mass_kg": 1, "colour": "green"}, Part, Part(1.0, Colour.GREEN)),
        ({"mass_kg": 1, "colour": "red", "holes": [3]}, Part | None, Part(1.0, Colour.RED, (3,))),
        ("a", Literal["a", "b"], "a"),
        ({"x": 1}, Mapping[str, float], {"x": 1.0}),
        ({"x": ["red"]}, dict[str, tuple[Colour, ...]], {"x": (Colour.RED,)}),
        ({"red": 1}, dict[Colour, int], {Colour.RED: 1}),
        ([1, "red"], tuple[float, Colour], (1.0, Colour.RED)),
        (1, float | str, 1.0),
        ({"mass_kg": 1, "colour": "red"}, dict[str, Any] | Part, {"mass_kg": 1, "colour": "red"}),
    ],
)
def test_literals_become_values_of_the_type(literal, kind, value):
    fitted = fit(literal, kind)
    assert fitted == value
    assert type(fitted) is type(value)


def test_list_of_numbers_becomes_an_array():
    np.testing.assert_array_equal(fit([[0, 1], [2, 3]], NDArray[np.float64]), [[0, 1], [2, 3]])


@pytest.mark.parametrize(
    ("literal", "kind", "message"),
    [
        (True, int, "expected int, got True"),
        (True, float, "expected float, got True"),
        ("x", float, "expected float, got 'x'"),
        ("rd", Colour, "Colour has no value 'rd'; did you mean 'red'?"),
        ([1, "a"], list[int], "expected int, got 'a'"),
        ([1], tuple[float, float], "expected 2 items, got 1"),
        ({"mas_kg": 1}, Part, "Part has no field 'mas_kg'; did you mean 'mass_kg'?"),
        ({"mass_kg": 1}, Part, "missing 1 required positional argument: 'colour'"),
        (["a"], NDArray[np.float64], "expected an array of numbers"),
        (None, float, "expected float, got None"),
        ("x", int | None, "expected int | None, got 'x'"),
        (True, int | str, "expected int | str, got True"),
        (True, Literal[1], "expected 1, got True"),
        ({"x": "a"}, dict[str, int], "expected int, got 'a'"),
        ({"blu": 1}, dict[Colour, int], "Colour has no value 'blu'"),
        ([1], dict[str, int], "expected dict[str, int], got list"),
    ],
)
def test_literals_that_do_not_fit_are_refused(literal, kind, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        fit(literal, kind)


def test_values_at_run_time_are_checked_and_never_converted():
    check((Part(1.0, Colour.RED),), Sequence[Part])
    check(np.zeros(3), NDArray[np.float64])
    with pytest.raises(ValueError, match="expected Colour, got 'red'"):
        check("red", Colour)
    check({"a": (1, 2)}, dict[str, Sequence[int]])
    with pytest.raises(ValueError, match="expected int, got True"):
        check({"a": (True,)}, Mapping[str, Sequence[int]])
    with pytest.raises(ValueError, match="expected Part, got dict"):
        check({"mass_kg": 1.0}, Part)


def test_devices_are_checked_against_protocols():
    class Notes:
        def note(self, line):
            pass

    check(Notes(), HasNote)
    with pytest.raises(ValueError, match="expected HasNote, got object"):
        check(object(), HasNote)
