"""Arms and cables in one time: each step moves the arms, then what they push and hold."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.descriptions import DESCRIPTIONS
from robots.descriptions.yumi import OPEN_OPENING_M
from robots.interfaces import ARMS
from robots.limits import yumi_limits
from robots.placement import HOME_RAD, YUMI_AT_TABLE, Placement
from simulation.arms_driver import DriverState, SimArmsDriver
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.cable.rod_state import RodState
from simulation.cable_obstacles import CableObstacles
from simulation.yumi_body import YumiBody

Floats = NDArray[np.float64]

# Once nothing has moved for this many steps, the arms need no more physics.
_SETTLING_STEPS = 12


@dataclass(frozen=True, slots=True, eq=False)
class WorldState:
    """Arms at rest and free cables at one moment.

    Attributes:
        steps: Steps taken since the world began.
        still_steps: For how many of them nothing has moved.
        joints: Position and velocity of each driven joint of the body, shape (18, 2).
        driver: The arms' controllers.
        rod: The cables.
    """

    steps: int
    still_steps: int
    joints: Floats
    driver: DriverState
    rod: RodState


class TableWorld:
    """The physics of the cell.

    Attributes:
        rod: The cables.
        body: The arms.
        driver: Their controllers.
        robot: What the arms look like.
        step_s: Length of a step.
        steps: Steps taken since the world began.
    """

    def __init__(
        self,
        nodes_m: Floats | Sequence[Floats],
        step_hz: int,
        placement: Placement = YUMI_AT_TABLE,
        parameters: RodParameters | None = None,
    ) -> None:
        """Put the robot, at home, before a table with cables at rest along `nodes_m`.

        Args:
            nodes_m: Centre line of the cable, shape (N, 3), or of several cables.
            step_hz: Steps a second.
            placement: Where the robot stands.
            parameters: What the cables are made of.
        """
        self.step_s = 1.0 / step_hz
        self.rod = Rod(nodes_m, parameters)
        self.robot = DESCRIPTIONS["yumi"]()
        self.body = YumiBody(HOME_RAD, dict.fromkeys(ARMS, OPEN_OPENING_M), self.step_s, placement)
        self._obstacles = CableObstacles.of(self.robot)
        self._obstacles.follow(self.body, self.rod)
        self.driver = SimArmsDriver(self.body, self.rod, self.now_s, yumi_limits())
        self.steps = self._still_steps = 0

    def now_s(self) -> float:
        """Return the time since the world began [s]."""
        return self.steps * self.step_s

    def state(self) -> WorldState:
        """Return what the world goes on from.

        Raises:
            DeviceError: Something moves or is held.
        """
        driver = self.driver.rest_state()
        return WorldState(
            self.steps, self._still_steps, self.body.joints(), driver, self.rod.state()
        )

    def take_state(self, state: WorldState) -> None:
        """Go on from a state of a world with the same cable, bit for bit.

        Raises:
            InputError: It is that of other cables.
        """
        self.rod.take_state(state.rod)
        self.body.place_joints(state.joints)
        self.driver.take_rest_state(state.driver)
        self.steps, self._still_steps = state.steps, state.still_steps

    def advance(self, steps: int) -> None:
        """Let time pass, arms and cable in lockstep; resting arms cost nothing."""
        end = self.steps + steps
        while self.steps < end and not self._arms_settled():
            self._step()
            self.steps += 1
        if self.steps < end:
            self.rod.advance((end - self.steps) * self.step_s)
            self.steps = end

    def _arms_settled(self) -> bool:
        return self.driver.at_rest and self._still_steps >= _SETTLING_STEPS

    def _step(self) -> None:
        self._still_steps = self._still_steps + 1 if self.driver.at_rest else 0
        self.driver.advance(self.step_s)
        self.body.step()
        self._obstacles.follow(self.body, self.rod)
        self.rod.advance(self.step_s)
