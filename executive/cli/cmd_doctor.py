"""`cellwright doctor`: whether this machine can run missions, and what to do if not."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from executive.cli.console import chatter, results, stdout_kept_for_the_result
from executive.cli.doctor_cell import examine
from executive.cli.doctor_checks import CHECKS, WARNINGS, Check, CheckError


def doctor(
    cell: Annotated[
        str | None,
        typer.Argument(help="Cell whose layout is to be judged instead: a name, or a YAML file."),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(dir_okay=False, help="PNG of who reaches what; runs/doctor/CELL.png."),
    ] = None,
    fine: Annotated[bool, typer.Option("--fine", help="Every 5 cm, not 10; minutes.")] = False,
) -> None:
    """Try every library and the simulated cell; say what is broken, and how to mend it.

    With the name of a cell, measure and draw which arm reaches what of its table, and warn of a
    layout that cannot work.

    Exit codes: 0 when all is well, 3 when something is broken or no mission can work.
    """
    if cell is not None:
        with stdout_kept_for_the_result():
            works = examine(cell, picture, fine)
        if not works:
            raise typer.Exit(3)
        return
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    broken = False
    with stdout_kept_for_the_result():
        for check in CHECKS:
            with chatter().status(f"trying {check.name}"):
                found, fine = _tried(check)
            broken |= not fine and check.name not in WARNINGS
            table.add_row(_mark(check, fine), check.name, found, "" if fine else check.fix)
    results().print(table)
    if broken:
        raise typer.Exit(3)


def _tried(check: Check) -> tuple[str, bool]:
    try:
        return check.attempt(), True
    except CheckError as error:
        return str(error), False
    except Exception as error:  # whatever is broken, the other checks are wanted too
        return f"{type(error).__name__}: {error}", False


def _mark(check: Check, fine: bool) -> Text:
    if fine:
        return Text("✓", "green")
    return Text("!", "yellow") if check.name in WARNINGS else Text("✗", "bold red")
