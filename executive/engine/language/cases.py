"""Which case of a `switch` a value is."""

import typing
from collections.abc import Iterator, Sequence
from enum import Enum
from typing import Any, Final, Literal

from executive.core.registry import closest
from executive.engine.language.porttypes import accepts, type_name, union_members

_WORDS: Final = {"true": True, "false": False, "none": None, "null": None}


def case_of(cases: Sequence[str], value: object) -> int | None:
    """Return the index of the case that a value is, None where it is none of them.

    Enums are compared by their value. A text is the case that is written like it; anything
    else the case that says the same in YAML, so `3` and `3.0` are one.
    """
    value = value.value if isinstance(value, Enum) else value
    for i, case in enumerate(cases):
        if case == value if isinstance(value, str) else _says(case, value):
            return i
    return None


def _says(case: str, value: object) -> bool:
    if case in _WORDS:
        return value is _WORDS[case]
    try:
        return not isinstance(value, bool) and float(case) == value
    except ValueError:
        return False


def case_faults(cases: Sequence[str], kind: Any) -> Iterator[tuple[str, str]]:
    """Yield the cases that a value of a type can never be, and what is wrong with each."""
    known = _values(kind)
    for case in cases:
        if known is not None and case not in known:
            message = f"{type_name(kind)} has no value {case!r}; {closest(case, known)}"
            yield case, message
        elif known is None and _is_number(kind) and not _is_written_number(case):
            yield case, f"expected a number, got {case!r}"


def _is_number(kind: Any) -> bool:
    return kind is not Any and accepts(float, kind)


def _is_written_number(case: str) -> bool:
    try:
        float(case)
    except ValueError:
        return False
    return True


def _values(kind: Any) -> list[str] | None:
    """Return the texts of all values of a type, None where they are not known."""
    if members := union_members(kind):
        parts = [_values(member) for member in members]
        return None if None in parts else [text for part in parts for text in part or ()]
    if kind in (None, type(None)):
        return ["none", "null"]
    if kind is bool:
        return ["true", "false"]
    if typing.get_origin(kind) is Literal:
        return [str(value) for value in typing.get_args(kind)]
    if isinstance(kind, type) and issubclass(kind, Enum):
        return [str(member.value) for member in kind]
    return None
