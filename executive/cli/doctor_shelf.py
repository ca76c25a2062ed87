"""`cellwright doctor` on a shelf: what the tool reaches, and what the camera sees."""

from pathlib import Path

from rich.text import Text

from executive.cli.console import chatter, results
from executive.engine.language.document import CellDocument


def examine_arm_at_shelf(
    document: CellDocument, picture: Path, step_m: float
) -> tuple[bool, list[str]]:
    """Do so for an arm before a shelf; return whether that works, and warnings.

    Raises:
        InputError: The cell's configuration is wrong.
    """
    from simulation.shelf_cell.config import ShelfCellConfig
    from simulation.table_cell_config import read_settings

    settings = read_settings(ShelfCellConfig, document.config, document.name)
    return _examine(document.name, settings.camera.width_px, picture, step_m, with_arm=True)


def examine_bare_shelf(
    document: CellDocument, picture: Path, step_m: float
) -> tuple[bool, list[str]]:
    """Do so for a tool that no arm carries; return whether that works, and warnings.

    Raises:
        InputError: The cell's configuration is wrong.
    """
    from simulation.shelf.cell_config import ShelfCellConfig
    from simulation.table_cell_config import read_settings

    settings = read_settings(ShelfCellConfig, document.config, document.name)
    works, warnings = _examine(
        document.name, settings.camera.width_px, picture, step_m, with_arm=False
    )
    if not settings.tool.suction:
        warnings.append("the tool has no cup: nothing can be taken out, only pushed aside")
    return works, warnings


def _examine(
    name: str, width_px: int, picture: Path, step_m: float, *, with_arm: bool
) -> tuple[bool, list[str]]:
    from perception.shelf.types import Shelf
    from robots.shelf_arm.layout import judge_shelf, shelf_grid, without_arm
    from robots.shelf_arm.scene import ShelfSize
    from robots.viewer.shelf_picture import save_shelf
    from simulation.shelf.cameras import front_camera, sees_floor, viewpoint_cameras

    inside = Shelf()
    shelf = ShelfSize(inside.width_m, inside.depth_m, inside.height_m)
    cameras = viewpoint_cameras(inside, front_camera(inside, width_px))
    viewpoints = {view: camera.T_world_camera for view, camera in cameras.items()}
    seen = sees_floor(cameras.values(), *shelf_grid(shelf, step_m))
    judge = judge_shelf if with_arm else without_arm
    with chatter().status(f"measuring what the tool reaches in {name}"):
        report = judge(shelf, viewpoints, seen, step_m)
    title = f"{name}: what the tool reaches"
    save_shelf(report, shelf, viewpoints, title, picture, with_arm=with_arm)
    low, high, floor = (f"{100 * share:.0f} %" for share in report.shares().values())
    looks = ", ".join(view for view, ok in report.viewpoints.items() if ok) or "nowhere"
    console = results()
    line = (
        f"{name}: of the shelf, reached near the floor {low}, higher up {high}; floor seen {floor}"
    )
    console.print(Text(line), soft_wrap=True)
    console.print(Text(f"the camera looks from: {looks}"), soft_wrap=True)
    console.print(Text("rows from the back to the front, in metres; # both, o low, ^ high, . none"))
    for row in report.rows():
        console.print(Text(row))
    return report.works, list(report.warnings)
