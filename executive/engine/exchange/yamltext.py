"""Writes documents as YAML that people read: leaves on one line, comments before their nodes."""

import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from executive.engine.exchange.draft import Draft
from executive.engine.language.block_models import BLOCKS, DecoratorBody

WIDTH: Final = 100

_PLAIN: Final = re.compile(r"[A-Za-z_$][A-Za-z0-9_ .()+*/<>=$'-]*")
_ASKING: Final = frozenset({"when", "if", "unless", "while"})
_ASSIGNING: Final = frozenset({"set", "on_success", "on_failure", "on_halt"})
_WORDS: Final = frozenset({"true", "false", "null"})
_ESCAPES: Final = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}
_DECORATORS: Final = frozenset(
    kind for kind, body in BLOCKS.items() if issubclass(body, DecoratorBody)
)


def document_text(head: Mapping[str, object], root: Draft | None = None) -> str:
    """Return a document as text.

    Args:
        head: Its keys in order, without the root.
        root: Its root node.
    """
    lines: list[str] = []
    for key, value in head.items():
        lines += _entry(key, value, 0)
    if root is not None:
        lines += _named("root", root)
    return "\n".join(lines) + "\n"


def _node(draft: Draft) -> list[str]:
    """Return the lines of a node, without its comments."""
    if draft.is_leaf:
        line = flow(draft.body)
        if len(line) < WIDTH - 20:
            return [line]
        return [line for key, value in draft.body.items() for line in _entry(key, value, 0)]
    lines = [f"{draft.kind}:"]
    for key, value in draft.body.items():
        lines += _entry(key, value, 1)
    return [*lines, *(f"  {line}" for line in _below(draft))]


def _below(draft: Draft) -> Iterator[str]:
    if draft.cases:
        yield from _cases(draft)
        return
    if draft.kind in _DECORATORS:
        yield from _named("child", draft.children[0])
        return
    yield "children:"
    for child in draft.children:
        yield from _comment(child, 1)
        first, *rest = _node(child)
        yield f"  - {first}"
        yield from (f"    {line}" for line in rest)


def _cases(draft: Draft) -> Iterator[str]:
    yield "cases:"
    for text, child in zip(draft.cases, draft.children, strict=False):
        yield from (f"  {line}" for line in _named(_quoted_key(text), child))
    for child in draft.children[len(draft.cases) :]:
        yield from _named("default", child)


def _named(key: str, child: Draft) -> Iterator[str]:
    yield from _comment(child, 0)
    lines = _node(child)
    if len(lines) == 1 and child.is_leaf:
        yield f"{key}: {lines[0]}"
        return
    yield f"{key}:"
    yield from (f"  {line}" for line in lines)


def _quoted_key(text: str) -> str:
    return text if re.fullmatch(r"[A-Za-z_]\w*", text) and text not in _WORDS else quoted(text)


def _comment(draft: Draft, level: int) -> Iterator[str]:
    for text in draft.comments:
        yield from comment_lines(text, level)


def comment_lines(text: str, level: int = 0) -> list[str]:
    """Return a comment as lines of YAML."""
    clean = "".join(c if c.isprintable() else " " for c in text)
    return [
        f"{'  ' * level}# {line}"
        for line in textwrap.wrap(clean, WIDTH - 4 - 2 * level, break_on_hyphens=False)
    ]


def _entry(key: str, value: object, level: int) -> list[str]:
    """Return `key: value` on one line if it fits, as a block otherwise."""
    pad, value = "  " * level, _as_written(key, value)
    line = f"{pad}{key}: {flow(value)}"
    nested = isinstance(value, Mapping) and any(
        isinstance(item, Mapping | list) for item in value.values()
    )
    if not nested and (len(line) <= WIDTH or not isinstance(value, Mapping | list)):
        return [line]
    if isinstance(value, Mapping):
        inner = [each for k, v in value.items() for each in _entry(k, v, level + 1)]
        return [f"{pad}{key}:", *inner]
    assert isinstance(value, Sequence)
    return [f"{pad}{key}:", *(f"{pad}  - {flow(item)}" for item in value)]


def _as_written(key: object, value: object) -> object:
    """Return expressions that are a number, true or false as those of YAML."""
    if key in _ASSIGNING and isinstance(value, Mapping):
        return {name: _as_written("when", text) for name, text in value.items()}
    if key not in _ASKING or not isinstance(value, str):
        return value
    if value in ("true", "false"):
        return value == "true"
    return int(value) if re.fullmatch("0|[1-9][0-9]{0,8}", value) else value


def flow(value: object) -> str:
    """Return a value on one line."""
    match value:
        case None | bool():
            return {None: "null", True: "true", False: "false"}[value]
        case int() | float():
            return repr(value)
        case str():
            return _text(value)
        case Mapping():
            items = (f"{_key(k)}: {flow(_as_written(k, v))}" for k, v in value.items())
            return f"{{{', '.join(items)}}}"
        case Sequence():
            return f"[{', '.join(flow(item) for item in value)}]"
    raise TypeError(f"{type(value).__name__} has no place in a document")


def _key(key: object) -> str:
    return _quoted_key(str(key))


def _text(text: str) -> str:
    is_plain = _PLAIN.fullmatch(text) and text not in _WORDS and not text.endswith(" ")
    return text if is_plain else quoted(text)


def quoted(text: str) -> str:
    """Return a text in double quotes, every character that YAML may not hold escaped."""
    return f'"{"".join(map(_escaped, text))}"'


def _escaped(character: str) -> str:
    if character in _ESCAPES:
        return _ESCAPES[character]
    return character if character.isprintable() else f"\\U{ord(character):08x}"
