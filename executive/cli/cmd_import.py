"""`cellwright import`: trees of BehaviorTree.CPP v4 as YAML documents."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from executive.app.catalogue import port_types, skills
from executive.cli.console import chatter
from executive.core.errors import InputError
from executive.engine.exchange.importing import ImportOptions, import_file
from executive.engine.exchange.naming import our_name
from executive.engine.loading.loader import check_files


def import_(
    file: Annotated[Path, typer.Argument(help="XML of BehaviorTree.CPP v4.")],
    out: Annotated[
        Path, typer.Option("--out", "-o", file_okay=False, help="Folder for the documents.")
    ],
    mission: Annotated[
        str, typer.Option(help="Write a mission of this name too, which runs with stubs.")
    ] = "",
    models: Annotated[
        list[Path] | None,
        typer.Option("--models", help="XML whose TreeNodesModel declares the ports of nodes."),
    ] = None,
    enums: Annotated[
        list[str] | None,
        typer.Option("--enum", metavar="NAME=NUMBER", help="Value of a word in scripts."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Write over files that exist.")] = False,
) -> None:
    """Import trees from BehaviorTree.CPP v4; exit 2 when something cannot be said here.

    Leaves that are not at hand become stubs, whose outcomes you can script.
    """
    if mission and our_name(mission) != mission:
        raise InputError(f"--mission {mission}: expected a name such as {our_name(mission)!r}")
    options = ImportOptions(tuple(models or ()), _enums(enums or ()), mission)
    imported = import_file(file, skills(), options)
    _refuse_to_overwrite(out, imported.files, force)
    out.mkdir(parents=True, exist_ok=True)
    written = []
    for name, text in imported.files.items():
        written.append(out / name)
        written[-1].write_text(text, encoding="utf-8")
        typer.echo(str(written[-1]))
    for note in imported.notes:
        chatter().print(f"note: {note}", markup=False, soft_wrap=True)
    _, faults = check_files(written, skills=skills(), types=port_types())
    for fault in faults:
        typer.echo(str(fault))
    if faults:
        chatter().print(f"written, but with {len(faults)} faults; the XML may have them too")
        raise typer.Exit(2)


def _enums(texts: Sequence[str]) -> dict[str, int]:
    values = {}
    for text in texts:
        name, _, number = text.partition("=")
        try:
            values[name.strip()] = int(number)
        except ValueError:
            raise InputError(f"--enum {text}: expected NAME=NUMBER, as in RED=2") from None
    return values


def _refuse_to_overwrite(out: Path, names: Iterable[str], force: bool) -> None:
    there = [str(out / name) for name in names if (out / name).exists()]
    if there and not force:
        raise InputError(f"{', '.join(there)}: exists already; try another folder, or --force")
