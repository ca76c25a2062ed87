"""Files with one thing a line, such as breakpoints: `#` begins a comment."""

import re
from collections.abc import Callable
from typing import TypeVar

from executive.core.errors import InputError

T = TypeVar("T")


def parsed_lines(text: str, parse: Callable[[str], T]) -> list[T]:
    """Read a file line by line; empty lines and what follows a `#` are left out.

    Raises:
        InputError: `parse` raised it for a line; says which.
    """
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        content = re.sub(r"(^|\s)#.*$", "", line).strip()
        if content:
            try:
                found.append(parse(content))
            except InputError as error:
                raise InputError(f"line {number}: {error}") from None
    return found
