"""Types of C++ as types of ours, and the texts of attributes as values of them."""

import json
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from executive.core.errors import InputError

_NAMES: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(("bool",), "bool"),
        **dict.fromkeys(("float", "double", "long double"), "float"),
        **dict.fromkeys(("int", "unsigned", "unsigned int", "short", "unsigned short"), "int"),
        **dict.fromkeys(("long", "long long", "unsigned long", "unsigned long long"), "int"),
        **dict.fromkeys(("char", "signed char", "unsigned char", "size_t"), "int"),
        **dict.fromkeys((f"{s}int{n}_t" for s in ("", "u") for n in (8, 16, 32, 64)), "int"),
        **dict.fromkeys(("string", "string_view", "StringView", "NodeStatus"), "str"),
        **dict.fromkeys(("Any", "AnyTypeAllowed", "BT::AnyTypeAllowed", ""), "any"),
    }
)
_LONGEST: Final = 400
_LISTS: Final = re.compile(r"(?:vector|deque|list|SharedQueue)<(.+)>")
_STRING: Final = re.compile(r"(?:__cxx11::)?basic_string<.*>")
_WRAPPED: Final = re.compile(r"(?:shared_ptr|optional|unique_ptr)<(.+)>")
_QUALIFIERS: Final = re.compile(r"\b(?:std|BT|const)(?:::|\b)|[&*]")
_JSON: Final = "json:"
_CLASSES: Final[Mapping[str, type]] = MappingProxyType(
    {"bool": bool, "int": int, "float": float, "str": str}
)
_CPP: Final[Mapping[str, str]] = MappingProxyType(
    {"bool": "bool", "float": "double", "int": "int", "str": "std::string", "any": ""}
)


def our_type(cpp: str) -> str:
    """Return the type of ours that takes the values of a C++ type; `any` for one of its own."""
    name = _QUALIFIERS.sub("", cpp).strip()
    if len(name) > _LONGEST:
        return "any"
    if _STRING.fullmatch(name):
        return "str"
    if found := _WRAPPED.fullmatch(name):
        return our_type(found[1])
    if found := _LISTS.fullmatch(name):
        return f"list[{our_type(_first_argument(found[1]))}]"
    return _NAMES.get(name, "any")


def _first_argument(arguments: str) -> str:
    """Return the first of several template arguments: `vector<T, allocator<T>>` holds `T`."""
    depth = 0
    for i, character in enumerate(arguments):
        depth += (character == "<") - (character == ">")
        if character == "," and depth == 0:
            return arguments[:i]
    return arguments


def cpp_type(ours: str) -> str:
    """Return the C++ type for a type of ours, empty for anything that has no counterpart."""
    if ours.startswith("list[") and ours.endswith("]"):
        item = cpp_type(ours[5:-1])
        return f"std::vector<{item}>" if item else ""
    return _CPP.get(ours, "")


def read_literal(text: str, kind: str) -> object:
    """Return the value that the text of an attribute has for a port of a type.

    A port that may be anything gets a number, true or false where the text is how one of them
    would be written back, and the text itself otherwise.

    Raises:
        InputError: It is no such value.
    """
    if text.startswith(_JSON):
        return _from_json(text, kind)
    if kind == "any":
        return _guessed(text)
    if kind == "str":
        return text
    try:
        return _typed(text.strip(), kind)
    except ValueError:
        raise InputError(f"expected {kind}, got {text!r}") from None


def _from_json(text: str, kind: str) -> object:
    try:
        value = json.loads(text.removeprefix(_JSON))
    except (ValueError, RecursionError) as error:
        raise InputError(f"is no JSON: {error}") from None
    wanted = list if kind.startswith("list[") else _CLASSES.get(kind, object)
    if not isinstance(value, wanted) or (isinstance(value, bool) and wanted in (int, float)):
        raise InputError(f"expected {kind}, got {text!r}")
    return value


def _typed(text: str, kind: str) -> object:
    if kind.startswith("list["):
        items = text.split(";") if text else []
        return [read_literal(item, kind[5:-1]) for item in items]
    if kind == "bool":
        known = {"true": True, "1": True, "false": False, "0": False}
        if text.lower() not in known:
            raise ValueError(text)
        return known[text.lower()]
    return int(text, 0) if kind == "int" and text[:2] in ("0x", "0X") else _number(text, kind)


def _number(text: str, kind: str) -> int | float:
    number = int(text) if kind == "int" else float(text)
    if number != number or number in (float("inf"), float("-inf")):
        raise ValueError(text)
    return number


def _guessed(text: str) -> object:
    for kind in ("int", "float", "bool"):
        try:
            value = _typed(text, kind)
        except ValueError:
            continue
        if write_literal(value) == text:
            return value
    return text


def guess_type(text: str) -> str:
    """Return the type that a text is taken for where nothing declares one."""
    return {bool: "bool", int: "int", float: "float"}.get(type(_guessed(text)), "str")


def write_literal(value: object) -> str:
    """Return a value as the text of an attribute.

    Lists of single values are written as BehaviorTree.CPP splits them, at `;`; anything deeper
    is JSON behind `json:`, which it reads too.

    Raises:
        InputError: No attribute can hold it.
    """
    match value:
        case bool():
            return "true" if value else "false"
        case int() | float():
            return json.dumps(value)
        case str():
            return value
        case list() | tuple() if not any(isinstance(item, list | tuple | dict) for item in value):
            texts = [write_literal(item) for item in value]
            if texts and not any(";" in text for text in texts):
                return ";".join(texts)
    try:
        return _JSON + json.dumps(value, allow_nan=False)
    except (TypeError, ValueError):
        raise InputError(f"{value!r} cannot stand in an attribute of XML") from None
