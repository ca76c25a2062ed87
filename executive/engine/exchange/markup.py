"""Reads XML into elements that know their line and column, and nothing that could do harm.

A document type is refused as soon as it shows, so no entity is ever declared, fetched or
expanded.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final
from xml.parsers import expat

from executive.core.errors import Fault

MAX_BYTES: Final = 10_000_000
MAX_LEVELS: Final = 120
_READ_BYTES: Final = 65_536


@dataclass(frozen=True, slots=True, eq=False)
class Element:
    """One element of a file.

    Attributes:
        tag: Its name.
        attributes: Attributes in the order of the file.
        file: Path as the user gave it.
        line: Line, counted from 1.
        column: Column, counted from 1.
        comments: What is said about it in comments just before it.
        children: Elements in it.
        texts: Pieces of text in it.
    """

    tag: str
    attributes: Mapping[str, str]
    file: str
    line: int
    column: int
    comments: tuple[str, ...] = ()
    children: list["Element"] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """Its text as one line."""
        return " ".join("".join(self.texts).split())

    def walk(self) -> Iterator["Element"]:
        """Yield the element and all below it in the order of the file."""
        yield self
        for child in self.children:
            yield from child.walk()

    def fault(self, message: str) -> Fault:
        """Return a fault at this element, which it names."""
        name = self.attributes.get("name") or self.attributes.get("ID")
        what = f'<{self.tag} {"name" if self.attributes.get("name") else "ID"}="{name}">'
        return Fault(
            self.file, self.line, self.column, "", f"{what if name else f'<{self.tag}>'}: {message}"
        )


class _RefusedError(Exception):
    """Ends the parsing; the fault is on record."""


def read_markup(file: str, data: bytes) -> tuple[Element | None, list[Fault]]:
    """Return the root element of an XML file, or the fault that keeps it from being read."""
    if len(data) > MAX_BYTES:
        message = f"holds {len(data)} bytes; expected {MAX_BYTES} at most"
        return None, [Fault(file, 1, 1, "", message)]
    reading = _Reading(file)
    try:
        for start in range(0, len(data), _READ_BYTES):
            reading.parser.Parse(data[start : start + _READ_BYTES], False)
        reading.parser.Parse(b"", True)
    except _RefusedError:
        pass
    except expat.ExpatError as error:
        message = f"not XML: {expat.errors.messages[error.code]}"
        reading.faults.append(Fault(file, error.lineno, error.offset + 1, "", message))
    except (LookupError, ValueError) as error:  # an encoding that is unknown, or not its own
        reading.complain(f"not XML: {error}")
    return (None if reading.faults else reading.root), reading.faults


class _Reading:
    """What is gathered while one file is parsed."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.root: Element | None = None
        self.faults: list[Fault] = []
        self._open: list[Element] = []
        self._comments: list[str] = []
        self.parser = expat.ParserCreate()
        self.parser.ordered_attributes = False
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.CommentHandler = self._comment
        self.parser.StartDoctypeDeclHandler = self._doctype
        self.parser.EntityDeclHandler = self._doctype

    def complain(self, message: str) -> None:
        line, column = self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1
        self.faults.append(Fault(self.file, line, column, "", message))

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self._open) >= MAX_LEVELS:
            self.complain(f"nested deeper than {MAX_LEVELS} elements")
            raise _RefusedError
        line, column = self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1
        comments, self._comments = tuple(self._comments), []
        element = Element(tag, attributes, self.file, line, column, comments)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, _tag: str) -> None:
        self._open.pop()
        self._comments = []

    def _text(self, text: str) -> None:
        self._open[-1].texts.append(text)

    def _comment(self, text: str) -> None:
        self._comments.append(" ".join(text.split()))

    def _doctype(self, *_: object) -> None:
        self.complain("declares a document type or an entity; trees have none, take it out")
        raise _RefusedError
