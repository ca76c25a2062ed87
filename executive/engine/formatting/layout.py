"""Writes entries down: on one line where they fit, one below the other where they do not."""

from collections.abc import Sequence
from typing import Final

from executive.engine.formatting.items import BLANK, Collection, Entry, Scalar
from executive.engine.formatting.order import Places
from executive.engine.formatting.scalars import block_lines, flow_text, key_text, line_text
from executive.engine.language.sources import YamlPath

WIDTH: Final = 100
_STEP: Final = 2


class Layout:
    """Writes down one document."""

    def __init__(self, places: Places) -> None:
        """Know what stands where."""
        self._places = places

    def lines(self, collection: Collection, path: YamlPath, indent: int) -> list[str]:
        """Return the lines of a collection, each entry on lines of its own."""
        written: list[str] = []
        for position, (index, entry) in enumerate(self._ordered(collection, path)):
            step = index if collection.is_list else entry.key
            assert step is not None
            if entry.key is None:
                self._lift_first(entry, (*path, step))
            above = _without_leading_blank(entry.above) if position == 0 else entry.above
            written += _comment_lines(above, indent)
            written += self._entry(entry, (*path, step), indent)
            written += _comment_lines(entry.after, indent)
        return written

    def _lift_first(self, entry: Entry, path: YamlPath) -> None:
        """Put what stands above the first key of an item above the item: no line is between."""
        if isinstance(entry.value, Collection) and entry.value.entries:
            index, first = self._ordered(entry.value, path)[0]
            if first.key is None:
                self._lift_first(first, (*path, index))
            entry.above += first.above
            first.above = []
            if first.beside and entry.beside:
                entry.above.append(entry.beside)
                entry.beside = ""

    def _ordered(self, collection: Collection, path: YamlPath) -> Sequence[tuple[int, Entry]]:
        known = () if collection.is_list else self._places.known_order(path)
        rank = {key: position for position, key in enumerate(known)}
        return sorted(
            enumerate(collection.entries), key=lambda one: rank.get(one[1].key or "", len(rank))
        )

    def _entry(self, entry: Entry, path: YamlPath, indent: int) -> list[str]:
        lead = " " * indent + ("-" if entry.key is None else f"{key_text(entry.key)}:")
        if isinstance(entry.value, Scalar):
            return self._scalar(entry, entry.value, lead, indent)
        if not (self._places.is_open(path) and entry.value.entries):
            flow = f"{lead} {self._flow(entry.value, path)}"
            if not entry.value.entries or (len(flow) <= WIDTH and not entry.has_comments_inside()):
                return [_with(flow, entry.beside)]
        return self._block(entry, entry.value, path, lead, indent)

    def _block(
        self, entry: Entry, value: Collection, path: YamlPath, lead: str, indent: int
    ) -> list[str]:
        below = self.lines(value, path, indent + _STEP)
        if entry.key is not None:
            return [_with(lead, entry.beside), *below]
        return [_with(f"{lead} {below[0].lstrip()}", entry.beside), *below[1:]]

    def _scalar(self, entry: Entry, scalar: Scalar, lead: str, indent: int) -> list[str]:
        line = f"{lead} {line_text(scalar)}"
        if len(line) > WIDTH or "\n" in scalar.text:
            inner = indent + _STEP
            block = block_lines(scalar, WIDTH - inner)
            if block is not None:
                below = [" " * inner + text for text in block[1:]]
                return [_with(f"{lead} {block[0]}", entry.beside), *below]
        return [_with(line, entry.beside)]

    def _flow(self, value: Scalar | Collection, path: YamlPath) -> str:
        if isinstance(value, Scalar):
            return flow_text(value)
        parts = []
        for index, entry in self._ordered(value, path):
            step = index if value.is_list else entry.key
            assert step is not None
            text = self._flow(entry.value, (*path, step))
            parts.append(text if entry.key is None else f"{key_text(entry.key)}: {text}")
        inside = ", ".join(parts)
        return f"[{inside}]" if value.is_list else f"{{{inside}}}"


def _with(line: str, comment: str) -> str:
    return f"{line}  {comment}" if comment else line


def _comment_lines(said: Sequence[str], indent: int) -> list[str]:
    lines: list[str] = []
    for text in said:
        if text != BLANK:
            lines.append(" " * indent + text)
        elif not lines or lines[-1] != BLANK:
            lines.append(BLANK)
    return lines


def _without_leading_blank(said: Sequence[str]) -> Sequence[str]:
    return said[1:] if said and said[0] == BLANK else said
