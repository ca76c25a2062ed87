"""An arm before a shelf with boxes of one's own choice."""

import numpy as np

from perception.shelf.types import Box, Floats, Shelf
from robots.shelf_arm.build import kinova_shelf_tool
from robots.shelf_arm.scene import ShelfSize
from robots.shelf_arm.settings import ShelfArmSettings
from robots.shelf_tool import Cuboid, ToolAction, ToolResult, ToolShape
from simulation.clock import SimClock
from simulation.shelf.cameras import front_camera, viewpoint_cameras
from simulation.shelf_cell.boxes import HeavyBox
from simulation.shelf_cell.config import ToolConfig
from simulation.shelf_cell.world import ShelfWorld

POLL_S = 0.1


def heavy(
    name: str,
    place_m: tuple[float, float],
    size_m: tuple[float, float, float],
    mass_kg: float = 0.3,
    friction: float = 0.35,
) -> HeavyBox:
    """Return a box at a place (x, y)."""
    return HeavyBox(name, Box(*place_m, size_m), mass_kg, friction)


class Rig:
    """A world with a tool in it."""

    def __init__(
        self,
        *boxes: HeavyBox,
        tool: ToolConfig | None = None,
        settings: ShelfArmSettings | None = None,
    ) -> None:
        self.world = ShelfWorld(
            ShelfSize(), boxes, tool or ToolConfig(), 240, np.random.default_rng(0)
        )
        views = viewpoint_cameras(Shelf(), front_camera(Shelf()))
        self.tool = kinova_shelf_tool(
            self.world.driver,
            ShelfSize(),
            ToolShape(blade_m=0.014, gap_m=0.0),
            viewpoints={name: view.T_world_camera for name, view in views.items()},
            seed=0,
            settings=settings,
        )
        self.physics = self.world.physics
        self.clock = SimClock(self)

    @property
    def step_s(self) -> float:
        return self.world.step_s

    @property
    def steps(self) -> int:
        return self.world.steps

    def advance(self, steps: int) -> None:
        for _ in range(steps):
            self.tool.poll()
            self.world.step()

    def wait(self, duration_s: float) -> None:
        self.clock.sleep_until(self.clock.now_s() + duration_s)

    def do(self, action: ToolAction, most_s: float = 90.0) -> ToolResult:
        """Carry out an action to its end."""
        self.tool.start(action)
        end_s = self.clock.now_s() + most_s
        while (result := self.tool.result()) is None:
            assert self.clock.now_s() < end_s, f"{action} takes longer than {most_s} s"
            self.wait(POLL_S)
        return result

    def pose(self, name: str) -> Floats:
        """Return position and quaternion of a box."""
        row: Floats = self.physics.box_poses()[self.physics.box_names.index(name)]
        return row

    def lean(self, name: str) -> float:
        """Return the cosine of a box's lean."""
        x, y = self.pose(name)[3:5]
        return float(1.0 - 2.0 * (x * x + y * y))

    def thing(self, name: str) -> Cuboid:
        """Return where a box is, as a skill tells the tool."""
        x_m, y_m = self.pose(name)[:2]
        size_m = self.physics.box_sizes_m[self.physics.box_names.index(name)]
        return Cuboid(float(x_m), float(y_m), tuple(size_m.tolist()))
