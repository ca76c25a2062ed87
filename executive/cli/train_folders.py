"""Where `cellwright train` writes, and what has to be there before it does."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from executive.cli.console import chatter
from executive.core.errors import InputError

LEAST_FREE_MB = 200


def need_learning(command: str) -> None:
    """Make sure that networks can be trained here.

    Raises:
        InputError: They cannot.
    """
    missing = [name for name in ("torch", "safetensors") if find_spec(name) is None]
    if missing:
        raise InputError(
            f"{command}: needs {' and '.join(missing)}, which the extra `learn` brings; "
            "try pip install 'cellwright[learn]'"
        )


def begin(out: Path, resume: bool, mark: str) -> None:
    """Make sure that a folder can take what is made.

    Args:
        out: The folder.
        resume: Whether to go on in it.
        mark: File that shows that there is something to go on with, empty where any does.

    Raises:
        InputError: It holds something, or nothing to go on with, or there is no room.
    """
    if out.exists() and not out.is_dir():
        raise InputError(f"--out {out}: a file; expected a folder, empty or new")
    held = sum(1 for _ in out.iterdir()) if out.exists() else 0
    if resume and not (out / mark).exists():
        raise InputError(
            f"--resume: {out} has {mark and 'no '}{mark or 'nothing'} to go on with; try without it"
        )
    if held and not resume:
        hint = "try --resume to go on in it, or" if (out / mark).exists() else "try"
        raise InputError(
            f"--out {out}: not empty; got {held} entries; expected an empty or new folder; "
            f"{hint} another folder"
        )
    near = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
    free_mb = shutil.disk_usage(near).free // 1_000_000
    if free_mb < LEAST_FREE_MB:
        raise InputError(
            f"--out {out}: disk full; got {free_mb} MB free; expected at least {LEAST_FREE_MB} MB"
        )


@contextmanager
def interruptible(out: Path) -> Iterator[None]:
    """Say how to go on where somebody stops the work, or a disk does.

    Raises:
        InputError: A file cannot be written.
    """
    from typer import Exit

    try:
        yield
    except KeyboardInterrupt:
        chatter().print(f"stopped; what is finished lies in {out}: go on with --resume")
        raise Exit(130) from None
    except OSError as error:
        raise InputError(
            f"{error.filename or out}: cannot be written; {error.strerror or error}; "
            "try another folder, then or later --resume"
        ) from error
