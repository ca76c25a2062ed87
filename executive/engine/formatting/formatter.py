"""A document in its canonical form, held against what it said before."""

from collections import Counter

from executive.core.errors import DocumentError
from executive.engine.formatting.items import BLANK, read_items
from executive.engine.formatting.layout import Layout
from executive.engine.formatting.order import find_places
from executive.engine.language.comments import find_comments
from executive.engine.language.sources import read_source
from executive.engine.loading.validation import validate


def format_text(file: str, text: str) -> str:
    """Return a document in its canonical form.

    Args:
        file: Its file, for messages.
        text: What it says.

    Raises:
        DocumentError: It has faults.
        AssertionError: The canonical form would not mean the same; a bug of ours.
    """
    before = _meaning(file, text)
    formatted = _laid_out(file, _laid_out(file, text))  # a comment may settle only when moved
    assert _meaning(file, formatted) == before, f"{file}: would not mean the same"
    assert _comments(formatted) == _comments(text), f"{file}: comments would be lost"
    return formatted


def _laid_out(file: str, text: str) -> str:
    places = find_places(read_source(file, text).data)
    root, head = read_items(text)
    while head and head[0] == BLANK:
        head = head[1:]
    lines = [*head, *Layout(places).lines(root, (), 0)]
    return "\n".join(lines) + "\n"


def _meaning(file: str, text: str) -> str:
    document, faults = validate(read_source(file, text))
    if document is None:
        raise DocumentError(faults)
    return repr(document)  # with the order of all keys that have one


def _comments(text: str) -> Counter[str]:
    return Counter(comment.text for comment in find_comments(text))
