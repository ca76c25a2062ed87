"""The comments of a YAML text; a YAML parser throws them away."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import yaml

from executive.engine.language.sources import StrictLoader

_BREAK: Final = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_START: Final = re.compile(r"(?:^|(?<=[ \t]))#")


@dataclass(frozen=True, slots=True)
class Comment:
    """One comment.

    Attributes:
        line: Its line, counted from 0.
        column: Column of the `#`, counted from 0.
        text: From the `#` to the end of the line, without blanks at the end.
        alone: Whether nothing else stands in its line.
    """

    line: int
    column: int
    text: str
    alone: bool


def split_lines(text: str) -> list[str]:
    """Return the lines of a text as YAML counts them, without their ends."""
    return _BREAK.split(text)


def find_comments(text: str) -> list[Comment]:
    """Return the comments of a text that is YAML, in order."""
    if "#" not in text:
        return []
    lines = split_lines(text)
    masked = [list(line) for line in lines]
    for start, end in _scalars(text):
        for number in range(start[0], min(end[0] + 1, len(lines))):
            first = start[1] if number == start[0] else 0
            last = end[1] if number == end[0] else len(lines[number])
            masked[number][first:last] = "x" * (last - first)
    found = []
    for number, characters in enumerate(masked):
        if match := _START.search("".join(characters)):
            before = lines[number][: match.start()]
            comment = lines[number][match.start() :].rstrip()
            found.append(Comment(number, match.start(), comment, not before.strip()))
    return found


def _scalars(text: str) -> Iterator[tuple[tuple[int, int], tuple[int, int]]]:
    """Yield line and column of the first character of every scalar, and past its last one."""
    for event in yaml.parse(text, Loader=StrictLoader):
        if isinstance(event, yaml.ScalarEvent):
            start: Any = event.start_mark
            end: Any = event.end_mark
            begin = (start.line, start.column)
            if event.style in ("|", ">"):  # a comment may stand behind the sign
                begin = (start.line + 1, 0)
            yield begin, (end.line, end.column)
