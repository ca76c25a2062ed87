"""Puts an arm with its controllers before a shelf: everything but the controllers is the same."""

from collections.abc import Mapping

from robots.descriptions.specs import kinova_spec
from robots.interfaces import Floats
from robots.shelf_arm import scene
from robots.shelf_arm.driver import ShelfArmDriver
from robots.shelf_arm.motions import ShelfMotions
from robots.shelf_arm.settings import ShelfArmSettings
from robots.shelf_arm.tool import ArmShelfTool
from robots.shelf_tool import ToolShape
from robots.single_arm import PlannedArm


def kinova_shelf_tool(
    driver: ShelfArmDriver,
    size: scene.ShelfSize,
    shape: ToolShape,
    *,
    viewpoints: Mapping[str, Floats],
    seed: int,
    settings: ShelfArmSettings | None = None,
) -> ArmShelfTool:
    """Return what skills ask of the Kinova before a shelf.

    Args:
        driver: Its controllers; the arm rests.
        size: The shelf.
        shape: What the tool needs of room.
        viewpoints: T_shelf_camera by name, shape (4, 4); at home it is at `centre`.
        seed: Of everything random in planning.
        settings: Speeds and forces.
    """
    spec = kinova_spec(len(scene.HOME_RAD))
    arm = PlannedArm(driver, spec, scene.open_scene(size), scene.HOME_RAD, seed=seed)
    return ArmShelfTool(
        ShelfMotions(arm, driver, size, settings or ShelfArmSettings()),
        driver,
        shape,
        viewpoints,
        scene.T_TIP_CAMERA,
        scene.counter_middle(size)[:2],
    )
