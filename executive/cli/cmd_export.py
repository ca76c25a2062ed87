"""`cellwright export`: a tree as XML of BehaviorTree.CPP v4."""

from pathlib import Path
from typing import Annotated

import typer

from executive.app.catalogue import port_types, skills
from executive.cli.console import chatter
from executive.engine.exchange.exporting import export_program
from executive.engine.loading.loader import load_program


def export(
    file: Annotated[str, typer.Argument(help="Name of a tree or mission, or its YAML file.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", dir_okay=False, help="XML file; stdout without it."),
    ] = None,
) -> None:
    """Export a tree with its subtrees to BehaviorTree.CPP v4; exit 2 when that cannot say it."""
    exported = export_program(load_program(file, skills=skills(), types=port_types()))
    for note in exported.notes:
        chatter().print(f"note: {note}", markup=False, soft_wrap=True)
    if out is None:
        typer.echo(exported.text, nl=False)
    else:
        out.write_text(exported.text, encoding="utf-8")
        typer.echo(str(out))
