"""A YAML text as entries with their comments and blank lines, before it is laid out."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml

from executive.engine.language.comments import Comment, find_comments, split_lines
from executive.engine.language.sources import StrictLoader

BLANK = ""
"""Stands for a blank line among comments."""


@dataclass(slots=True, eq=False)
class Scalar:
    """One value that is no collection.

    Attributes:
        text: What it says, as it was read.
        is_text: Whether it is a string.
    """

    text: str
    is_text: bool


@dataclass(slots=True, eq=False)
class Collection:
    """A mapping or a list.

    Attributes:
        is_list: Which of the two.
        entries: What is in it, in order.
    """

    is_list: bool
    entries: list["Entry"] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class Entry:
    """A key with its value, or an item of a list.

    Attributes:
        key: The key, None for an item of a list.
        value: The value.
        line: Line in which it begins, from 0.
        column: Column in which it begins, from 0.
        parent: Entry that it stands in.
        in_flow: Whether it stands between braces or brackets.
        above: Comments and blank lines before it.
        beside: Comment at the end of its first line.
        after: Comments and blank lines after all of it.
    """

    key: str | None
    value: "Scalar | Collection"
    line: int
    column: int
    parent: "Entry | None"
    in_flow: bool = False
    above: list[str] = field(default_factory=list)
    beside: str = ""
    after: list[str] = field(default_factory=list)

    def lineage(self) -> "Iterator[Entry]":
        """Yield the entry and what it stands in, innermost first."""
        entry: Entry | None = self
        while entry is not None:
            yield entry
            entry = entry.parent

    def has_comments_inside(self) -> bool:
        """Return whether comments belong to anything in its value."""
        if isinstance(self.value, Scalar):
            return False
        return any(
            any(one.above) or one.beside or any(one.after) or one.has_comments_inside()
            for one in self.value.entries
        )


def read_items(text: str) -> tuple[Collection, list[str]]:
    """Return the mapping that a sound document is, and the comments at its head.

    Args:
        text: YAML that has been read without faults.
    """
    loader: Any = StrictLoader(text)
    try:
        root = loader.get_single_node()
    finally:
        loader.dispose()
    entries: list[Entry] = []
    value = _value(root, None, entries)
    assert isinstance(value, Collection)
    _attach(entries, find_comments(text), split_lines(text))
    head, value.entries[0].above = value.entries[0].above, []
    return value, head


def _value(node: Any, parent: Entry | None, entries: list[Entry]) -> Scalar | Collection:
    if isinstance(node, yaml.ScalarNode):
        return Scalar(node.value, node.tag.endswith(":str"))
    collection = Collection(isinstance(node, yaml.SequenceNode))
    for item in node.value:
        key, value = (None, item) if collection.is_list else item
        mark = (key or value).start_mark
        column = mark.column
        if collection.is_list and not node.flow_style:
            column = node.start_mark.column  # that of the dash
        said = key.value if key is not None else None
        entry = Entry(said, Scalar("", False), mark.line, column, parent, bool(node.flow_style))
        entries.append(entry)
        entry.value = _value(value, entry, entries)
        collection.entries.append(entry)
    return collection


def _attach(entries: list[Entry], comments: list[Comment], lines: list[str]) -> None:
    """Give every comment and blank line to an entry."""
    for comment in comments:
        before = [one for one in entries if (one.line, one.column) < (comment.line, comment.column)]
        if comment.alone:
            _attach_alone(entries, len(before), comment, _is_blank(lines, comment.line - 1))
        elif before:
            _attach_beside(before, comment)
    first: dict[int, Entry] = {}
    for entry in entries:
        first.setdefault(entry.line, entry)
    for line, entry in first.items():
        if _is_blank(lines, line - 1):
            entry.above.append(BLANK)


def _attach_alone(entries: list[Entry], index: int, comment: Comment, blank: bool) -> None:
    said = [BLANK, comment.text] if blank else [comment.text]
    later = entries[index] if index < len(entries) else None
    limit = later.column if later else -1
    if comment.column > limit and index:
        for one in entries[index - 1].lineage():
            if limit < one.column <= comment.column:
                one.after += said
                return
    if later is not None:
        later.above += said
    else:
        next(reversed(list(entries[-1].lineage()))).after += said


def _is_blank(lines: list[str], number: int) -> bool:
    return number >= 0 and not lines[number].strip()


def _attach_beside(before: list[Entry], comment: Comment) -> None:
    here = [one for one in before if one.line == comment.line]
    in_block = [one for one in here if not one.in_flow]
    entry = in_block[-1] if in_block else here[0] if here else before[-1]
    if entry.beside:
        entry.above.append(comment.text)
    else:
        entry.beside = comment.text
