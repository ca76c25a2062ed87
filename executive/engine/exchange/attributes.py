"""Values, keys and times of ours as texts of attributes of BehaviorTree.CPP v4."""

from typing import Final

from executive.core.errors import InputError
from executive.core.skill import Port
from executive.engine.exchange.cpptypes import read_literal, write_literal
from executive.engine.exchange.dataflow import key_in
from executive.engine.exchange.xmltext import NOT_XML, printable
from executive.engine.language.porttypes import type_name
from executive.engine.language.values import Literal, key_of, parse_value

_LIMIT: Final = 2**31 - 1


def comment_text(text: str) -> str:
    """Return a text as a comment of XML, empty where no comment can hold it."""
    return "" if "--" in text or text.endswith("-") else printable(text)


def plain_text(text: str) -> str:
    """Return a text that an attribute can hold.

    Raises:
        InputError: It has characters that XML has no way to write.
    """
    if NOT_XML.search(text):
        raise InputError(f"{text!r} has characters that XML cannot hold")
    return text


def input_text(name: str, raw: object, port: Port) -> str:
    """Return what stands at an input, a literal or a key, as the text of its attribute.

    Raises:
        InputError: It is an expression, or a literal that no attribute can hold.
    """
    value = parse_value(raw)
    if isinstance(value, Literal):
        try:
            return literal_text(value.value, port)
        except InputError as error:
            raise InputError(f"input {name!r}: {error}") from None
    key = key_of(value)
    if key is None:
        raise InputError(
            f"input {name!r}: ports there take no expressions such as {value.text!r}; "
            "try to set a key before"
        )
    return f"{{{key}}}"


def literal_text(value: object, port: Port) -> str:
    """Return a literal as an attribute that is read back as the same value.

    Raises:
        InputError: There is none.
    """
    if isinstance(value, tuple):
        value = list(value)
    kind = type_name(port.type)
    for text in (write_literal(value), write_literal({"": value})[len('json:{"": ') : -1]):
        as_json = text if text.startswith("json:") else f"json:{text}"
        for attempt in (text, as_json):
            if _reads_back(attempt, value, kind):
                return attempt
    raise InputError(f"{value!r} cannot stand in an attribute there")


def _reads_back(text: str, value: object, kind: str) -> bool:
    if NOT_XML.search(text) or key_in(text, "") is not None:
        return False
    try:
        back = read_literal(text, kind)
    except InputError:
        return False
    same_type = type(back) is type(value) or {type(back), type(value)} == {int, float}
    return back == value and same_type


def milliseconds(seconds: float | str) -> str:
    """Return a time in seconds, or a key of one, as milliseconds.

    Raises:
        InputError: It is no whole number of them, or an expression that is not `$key / 1000`.
    """
    if isinstance(seconds, str):
        text = seconds.removeprefix("$").replace(" ", "")
        key = text.removesuffix("/1000")
        if key == text or not key.isidentifier():
            raise InputError(
                f"{seconds!r}: there the time is a number of milliseconds, or a key of one; "
                "try '$key / 1000'"
            )
        return f"{{{key}}}"
    whole = round(seconds * 1000)
    if abs(whole - seconds * 1000) > 1e-6 or not 0 < whole <= _LIMIT:
        if seconds == 0.0:
            return "0"
        raise InputError(f"{seconds:g} s is no whole number of milliseconds, 1 to {_LIMIT}")
    return str(whole)


def times_text(times: int | str) -> str:
    """Return how often something is run: a number, -1 for ever, or a key.

    Raises:
        InputError: It is an expression.
    """
    if isinstance(times, int):
        return str(times)
    if times == "forever":
        return "-1"
    key = key_of(parse_value(times))
    if key is None:
        raise InputError(f"times: {times!r} is no plain key; try to set one before")
    return f"{{{key}}}"
