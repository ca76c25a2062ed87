"""Comments that let a finding stand: `# lint: allow L104 because the valve is idempotent`."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from executive.engine.language.comments import Comment, find_comments, split_lines

_MARK: Final = re.compile(r"#\s*lint\b")
_FORM: Final = re.compile(r"#\s*lint:\s*allow\s+(\w+(?:\s*,\s*\w+)*)(?:\s+because\s+(\S.*))?$")
FORM: Final = "# lint: allow CODE because REASON"


@dataclass(frozen=True, slots=True)
class Waiver:
    """One waiver.

    Attributes:
        line: Line of the comment, counted from 1.
        column: Column of the comment, counted from 1.
        target: Line of what it stands for, counted from 1: its own, or the next one that
            says anything.
        codes: Codes that it allows.
        reason: Why, empty where it does not say.
    """

    line: int
    column: int
    target: int
    codes: tuple[str, ...]
    reason: str


def find_waivers(text: str) -> list[Waiver]:
    """Return the waivers of a text that is YAML; one that cannot be read has no codes."""
    if not _MARK.search(text):
        return []
    comments = find_comments(text)
    lines = split_lines(text)
    return list(_waivers(comments, lines))


def _waivers(comments: Sequence[Comment], lines: Sequence[str]) -> Iterator[Waiver]:
    alone = {comment.line for comment in comments if comment.alone}
    for comment in comments:
        if not _MARK.match(comment.text):
            continue
        target = comment.line
        while comment.alone and target < len(lines) - 1:
            if target not in alone and lines[target].strip():
                break
            target += 1
        form = _FORM.match(comment.text)
        codes = tuple(re.split(r"\s*,\s*", form[1])) if form else ()
        reason = (form[2] or "") if form else ""
        yield Waiver(comment.line + 1, comment.column + 1, target + 1, codes, reason)
