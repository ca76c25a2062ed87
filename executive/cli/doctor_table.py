"""`cellwright doctor` on a table: which arm grasps where."""

from pathlib import Path

from rich.text import Text

from executive.cli.console import chatter, results
from executive.engine.language.document import CellDocument


def examine_table(document: CellDocument, picture: Path, step_m: float) -> tuple[bool, list[str]]:
    """Measure, print and draw who reaches what; return whether that works, and warnings.

    Raises:
        InputError: The cell's configuration is wrong.
    """
    from robots.layout import judge_layout
    from robots.viewer.reach_picture import save_reach
    from simulation.overhead_camera import seen_rectangle
    from simulation.table_cell_config import TableCellConfig, read_settings
    from simulation.table_setup import planning_scene

    settings = read_settings(TableCellConfig, document.config, document.name)
    scene = planning_scene(settings.layout)
    with chatter().status(f"measuring who reaches what in {document.name}"):
        report = judge_layout(scene, seen_rectangle(settings.camera), step_m)
    save_reach(report, scene.placement, f"{document.name}: who grasps where", picture)
    told = ", ".join(f"{who} {100 * share:.0f} %" for who, share in report.shares().items())
    console = results()
    console.print(Text(f"{document.name}: of the table, within reach of {told}"), soft_wrap=True)
    console.print(Text("rows from far to near, in metres; L left arm, R right arm, B both"))
    for row in report.reach.rows():
        console.print(Text(row))
    return report.works, list(report.warnings)
