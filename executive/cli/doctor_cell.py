"""`cellwright doctor CELL`: who reaches what in a cell, and what of its layout cannot work."""

from pathlib import Path

from rich.text import Text

from executive.cli.console import chatter, results
from executive.core.errors import InputError
from executive.engine.language.document import CellDocument

COARSE_M, FINE_M = 0.10, 0.05


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
    from robots.layout import judge_layout
    from robots.viewer.reach_picture import save_reach
    from simulation.overhead_camera import seen_rectangle
    from simulation.table_cell_config import TableCellConfig, read_settings
    from simulation.table_setup import planning_scene

    document, _ = load_cell(cell)
    _demand_table(document)
    settings = read_settings(TableCellConfig, document.config, document.name)
    scene = planning_scene(settings.layout)
    with chatter().status(f"measuring who reaches what in {document.name}"):
        report = judge_layout(scene, seen_rectangle(settings.camera), FINE_M if fine else COARSE_M)
    file = picture or Path("runs") / "doctor" / f"{document.name}.png"
    save_reach(report, scene.placement, f"{document.name}: who grasps where", file)
    _print(document.name, report.reach.rows(), report.shares())
    for warning in report.warnings:
        results().print(Text(f"! {warning}", "yellow"), soft_wrap=True)
    results().print(Text(f"picture: {file}"), soft_wrap=True)
    return report.works


def _demand_table(document: CellDocument) -> None:
    if document.world != "table_cell":
        raise InputError(
            f"doctor: {document.name}: the reach in a {document.world} cannot be measured; "
            "expected a cell of world table_cell"
        )


def _print(name: str, rows: list[str], shares: dict[str, float]) -> None:
    told = ", ".join(f"{who} {100 * share:.0f} %" for who, share in shares.items())
    console = results()
    console.print(Text(f"{name}: of the table, within reach of {told}"), soft_wrap=True)
    console.print(Text("rows from far to near, in metres; L left arm, R right arm, B both"))
    for row in rows:
        console.print(Text(row))
