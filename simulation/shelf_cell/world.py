"""Arm, tool and boxes in one time."""

from collections.abc import Sequence

import numpy as np

from robots.descriptions.specs import kinova_spec
from robots.motion.model import RobotModel
from robots.shelf_arm.scene import HOME_RAD, ROBOT, ShelfSize, open_scene
from simulation.shelf_cell.boxes import HeavyBox
from simulation.shelf_cell.config import ToolConfig
from simulation.shelf_cell.driver import SimShelfArmDriver
from simulation.shelf_cell.physics import ShelfPhysics
from simulation.shelf_cell.suction import Cups, Vacuum

# Boxes come to rest within that time after they are put down gently.
_SETTLING_S = 0.5
# Once nothing has moved for this long, there is nothing to compute.
_STILL_S = 0.1


class ShelfWorld:
    """The physics of the cell.

    Attributes:
        physics: The bodies.
        driver: Controllers of the arm and its tool.
        step_s: Length of a step.
        steps: Steps taken since the boxes came to rest.
    """

    def __init__(
        self,
        size: ShelfSize,
        boxes: Sequence[HeavyBox],
        tool: ToolConfig,
        step_hz: int,
        rng: np.random.Generator,
    ) -> None:
        """Put the boxes in the shelf and the arm, at home, before it; let all come to rest."""
        self.step_s = 1.0 / step_hz
        self.steps = self._still_steps = 0
        scene = open_scene(size)
        limits = RobotModel(kinova_spec(len(HOME_RAD)), scene.placement).limits
        self.physics = ShelfPhysics(ROBOT, scene, boxes, HOME_RAD, self.step_s)
        self.cups = Cups(self.physics, Vacuum(tool.pressure_pa, tool.friction))
        self.driver = SimShelfArmDriver(
            self.physics, self.cups, self.now_s, limits, tool.force_noise_n, rng
        )
        for _ in range(round(_SETTLING_S / self.step_s)):
            self.driver.advance(self.step_s)
            self.physics.step()

    def now_s(self) -> float:
        """Return the time since the world began [s]."""
        return self.steps * self.step_s

    def step(self) -> None:
        """Let one step of time pass; a world at rest costs nothing."""
        self.steps += 1
        still = self.driver.at_rest and not self.cups.on
        if still and self._still_steps >= _STILL_S / self.step_s:
            return
        self.driver.advance(self.step_s)
        self.physics.step()
        self.driver.sense(self.step_s)
        self._still_steps = self._still_steps + 1 if still and self.physics.boxes_still() else 0
