"""`cellwright fmt`: trees, missions and cells in their canonical form."""

import difflib
import os
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from executive.cli.files import TREES, yaml_files
from executive.core.errors import DocumentError, Fault, InputError
from executive.engine.formatting.formatter import format_text


def fmt(
    files: Annotated[
        list[Path] | None, typer.Argument(help="YAML files, or folders of them.  [default: trees]")
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Change nothing; exit 1 when a file would change.")
    ] = False,
    diff: Annotated[
        bool, typer.Option("--diff", help="Change nothing; print what would change.")
    ] = False,
) -> None:
    """Write documents in their canonical form; a file with faults stays as it is (exit 2)."""
    faults: list[Fault] = []
    changed = 0
    chosen = yaml_files(files or TREES)
    for file in chosen:
        before = _read(file)
        try:
            after = format_text(str(file), before)
        except DocumentError as error:
            faults += error.faults
            continue
        if after == before:
            continue
        changed += 1
        if diff:
            typer.echo(_difference(file, before, after), nl=False)
        elif check:
            typer.echo(f"{file}: would be formatted")
        else:
            _write(file, after)
            typer.echo(f"{file}: formatted")
    for fault in faults:
        typer.echo(str(fault))
    typer.echo(_summary(len(chosen), changed, len(faults), dry=check or diff), err=True)
    if faults or (changed and (check or diff)):
        raise typer.Exit(2 if faults else 1)


def _read(file: Path) -> str:
    try:
        return file.read_bytes().decode("utf-8")
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: is not UTF-8 text: {error.reason}") from None


def _write(file: Path, text: str) -> None:
    """Put the text in the place of the file in one step: a kill leaves the old or the new one."""
    target = file.resolve()
    descriptor, name = tempfile.mkstemp(dir=target.parent, prefix=f".{file.name}.")
    scratch = Path(name)
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8", newline="") as stream:
            stream.write(text)
            stream.flush()
            os.fsync(stream.fileno())
        scratch.chmod(target.stat().st_mode)
        scratch.replace(target)
    except OSError as error:
        scratch.unlink(missing_ok=True)
        raise InputError(f"{file}: cannot be written: {error.strerror}") from None


def _difference(file: Path, before: str, after: str) -> str:
    lines = difflib.unified_diff(
        before.splitlines(keepends=True),
        after.splitlines(keepends=True),
        f"{file} (as it is)",
        f"{file} (formatted)",
    )
    return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)


def _summary(files: int, changed: int, faults: int, *, dry: bool) -> str:
    done = "would be formatted" if dry else "formatted"
    summary = f"{files} file{'' if files == 1 else 's'}, {changed} {done}"
    return f"{summary}, {faults} fault{'' if faults == 1 else 's'}" if faults else summary
