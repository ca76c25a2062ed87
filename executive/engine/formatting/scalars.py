"""How one value is written: plain where that means the same, in quotes otherwise."""

import textwrap
from functools import lru_cache
from typing import Any, Final

import yaml

from executive.engine.formatting.items import Scalar
from executive.engine.language.sources import StrictLoader

_NULLS: Final = ("", "~")


def flow_text(scalar: Scalar) -> str:
    """Return a value as it is written inside braces or brackets."""
    return _text(scalar, in_flow=True)


def line_text(scalar: Scalar) -> str:
    """Return a value as it is written behind a key or a dash, on one line."""
    return _text(scalar, in_flow=False)


def key_text(key: str) -> str:
    """Return a key as it is written."""
    return key if _is_plain(key, "{{{}: 1}}", key=True) else quoted(key)


def _text(scalar: Scalar, *, in_flow: bool) -> str:
    if not scalar.is_text:
        return "null" if scalar.text in _NULLS else scalar.text
    form = "{{k: {}, l: 1}}" if in_flow else "k: {}\n"
    return scalar.text if _is_plain(scalar.text, form) else quoted(scalar.text)


def quoted(text: str) -> str:
    """Return a text in double quotes, in single ones where only double ones are inside."""
    if '"' in text and "'" not in text and text.isprintable():
        return f"'{text}'"
    dumped: str = yaml.dump(text, default_style='"', width=float("inf"), allow_unicode=True)
    return dumped.rstrip("\n")


def block_lines(scalar: Scalar, width: int) -> list[str] | None:
    """Return a text as a sign and the lines below it, None where that cannot be said so.

    Args:
        scalar: The value.
        width: Room for a line below the sign.
    """
    if not scalar.is_text:
        return None
    if "\n" in scalar.text:
        kept = scalar.text.removesuffix("\n")
        sign = "|" if scalar.text.endswith("\n") else "|-"
        return _sound([sign, *kept.split("\n")], scalar.text)
    lines = textwrap.wrap(scalar.text, width, break_long_words=False, break_on_hyphens=False)
    return _sound([">-", *lines], scalar.text)


def _sound(lines: list[str], text: str) -> list[str] | None:
    """Return the lines if they mean the text, None otherwise."""
    if any(not line or line != line.strip() for line in lines):
        return None
    body = "".join(f"  {line}\n" for line in lines[1:])
    return lines if _values(f"k: {lines[0]}\n{body}") == [text] else None


@lru_cache(maxsize=4096)
def _is_plain(text: str, form: str, *, key: bool = False) -> bool:
    """Return whether a text without quotes is read as itself; the parser is asked."""
    if not text.strip() or text != text.strip() or not text.isprintable():
        return False
    return (_keys if key else _values)(form.format(text))[:1] == [text]


def _values(text: str) -> list[str | None]:
    return [_plain_string(value) for _, value in _pairs(text)]


def _keys(text: str) -> list[str | None]:
    return [_plain_string(key) for key, _ in _pairs(text)]


def _pairs(text: str) -> list[tuple[Any, Any]]:
    try:
        root = yaml.compose(text, Loader=StrictLoader)
    except yaml.YAMLError:
        return []
    return list(root.value) if isinstance(root, yaml.MappingNode) else []


def _plain_string(node: Any) -> str | None:
    is_string = isinstance(node, yaml.ScalarNode) and node.tag.endswith(":str")
    return str(node.value) if is_string else None
