"""XML that is written: elements line by line, and which characters it can hold."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final
from xml.sax.saxutils import escape, quoteattr

NOT_XML: Final = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""A character that XML cannot hold."""

_QUOTES: Final = {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}


@dataclass(slots=True)
class XmlElement:
    """An element that is going to be written.

    Attributes:
        tag: Its name.
        attributes: Its attributes in order.
        children: What is inside.
        text: Its text; only where it has no children.
        comment: A comment before it.
    """

    tag: str
    attributes: dict[str, str] = field(default_factory=dict)
    children: list["XmlElement"] = field(default_factory=list)
    text: str = ""
    comment: str = ""

    def lines(self, level: int = 0) -> Iterable[str]:
        """Yield the element line by line."""
        pad = "  " * level
        if self.comment:
            yield f"{pad}<!-- {self.comment} -->"
        attributes = "".join(f" {k}={_quoted(v)}" for k, v in self.attributes.items())
        if self.children:
            yield f"{pad}<{self.tag}{attributes}>"
            for child in self.children:
                yield from child.lines(level + 1)
            yield f"{pad}</{self.tag}>"
        elif self.text:
            yield f"{pad}<{self.tag}{attributes}>{escape(self.text)}</{self.tag}>"
        else:
            yield f"{pad}<{self.tag}{attributes}/>"


def _quoted(text: str) -> str:
    return quoteattr(text, _QUOTES)


def printable(text: str) -> str:
    """Return a text with spaces for what XML cannot hold."""
    return NOT_XML.sub(" ", text)
