"""`cellwright doctor CELL`: what can be reached in a cell, and what of its layout cannot work."""

from pathlib import Path

from rich.text import Text

from executive.cli.console import results
from executive.cli.doctor_shelf import examine_arm_at_shelf, examine_bare_shelf
from executive.cli.doctor_table import examine_table
from executive.core.errors import InputError

WORLDS = {
    "table_cell": examine_table,
    "shelf_cell": examine_arm_at_shelf,
    "shelf_kinematic": examine_bare_shelf,
}
# Places that are looked at lie so far apart.
COARSE_M, FINE_M = 0.10, 0.05
# Worlds in which nothing stands around: there is nothing to reach.
EMPTY = ("dry", "socket_arms")


def examine(cell: str, picture: Path | None, fine: bool) -> bool:
    """Measure the reach in a cell, print and draw it; return whether missions can work there.

    Args:
        cell: Name of a cell, or its file.
        picture: Where the picture goes; `runs/doctor/CELL.png` when None.
        fine: Every 5 cm instead of every 10.

    Raises:
        InputError: No such cell, or one whose reach is not known how to measure.
    """
    from executive.app.missions import load_cell

    document, _ = load_cell(cell)
    if document.world in EMPTY:
        results().print(Text(f"{document.name}: has no table and no shelf; nothing to reach"))
        return True
    if document.world not in WORLDS:
        raise InputError(
            f"doctor: {document.name}: the reach in a {document.world} cannot be measured; "
            f"expected a cell of world {', '.join(WORLDS)}"
        )
    file = picture or Path("runs") / "doctor" / f"{document.name}.png"
    works, warnings = WORLDS[document.world](document, file, FINE_M if fine else COARSE_M)
    for warning in warnings:
        results().print(Text(f"! {warning}", "yellow"), soft_wrap=True)
    results().print(Text(f"picture: {file}"), soft_wrap=True)
    return works
