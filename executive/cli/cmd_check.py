"""`cellwright check`: everything that is wrong with trees, missions and cells, in one pass."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from executive.app.catalogue import port_types, skills
from executive.cli.files import TREES, yaml_files
from executive.core.errors import Fault
from executive.engine.loading.loader import Checked, check_files


def check(
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="YAML files, folders of them, or names.  [default: trees]"),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document on stdout.")
    ] = False,
) -> None:
    """Check trees, missions and cells without running them; exit 2 when one has faults."""
    checked, faults = check_files(yaml_files(files or TREES), skills=skills(), types=port_types())
    if as_json:
        typer.echo(_as_json(checked, faults))
    else:
        _print(checked, faults)
    if faults:
        raise typer.Exit(2)


def _as_json(checked: Sequence[Checked], faults: Sequence[Fault]) -> str:
    document = {
        "ok": not faults,
        "files": [asdict(one) for one in checked],
        "faults": [asdict(fault) for fault in faults],
    }
    return json.dumps(document, indent=2)


def _print(checked: Sequence[Checked], faults: Sequence[Fault]) -> None:
    for fault in faults:
        typer.echo(str(fault))
    faulty = {fault.file for fault in faults}
    for one in checked:
        if one.file not in faulty and one.name:
            typer.echo(f"{one.file}: {_verdict(one)}")
    if faults:
        count = len(faults)
        typer.echo(f"{count} fault{'s' if count > 1 else ''}", err=True)


def _verdict(one: Checked) -> str:
    if one.kind in ("tree", "mission") and not one.nodes:
        return f"not ok: {one.kind} {one.name} uses what has faults"
    nodes = f", {one.nodes} node{'s' if one.nodes > 1 else ''}" if one.nodes else ""
    return f"ok: {one.kind} {one.name}{nodes}"
