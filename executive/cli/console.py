"""Where the command line writes: results on stdout, everything else on stderr."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.text import Text

PIPED_WIDTH = 160


def chatter() -> Console:
    """Return the console for everything that is not the result."""
    return Console(stderr=True, highlight=False)


def results(*, colour: bool = True) -> Console:
    """Return the console for the result; what is no terminal gets long lines."""
    width = None if sys.stdout.isatty() else PIPED_WIDTH
    return Console(highlight=False, no_color=None if colour else True, width=width)


def print_error(console: Console, message: str) -> None:
    """Print an error message as it is."""
    console.print(Text.assemble(("error: ", "bold red"), message), soft_wrap=True)


@contextmanager
def stdout_kept_for_the_result() -> Iterator[None]:
    """Send what libraries print, C code included, to stderr while the block lasts."""
    sys.stdout.flush()
    saved = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(saved, 1)
        os.close(saved)
