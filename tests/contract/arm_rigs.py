"""Drivers of arms, each with what it needs to be put through the contract.

A rig is a class that is made without arguments and has

    driver        the driver, its arms at rest at home, its grippers open and empty
    step_s        how far `step` takes the cell on, about
    delay_s       from a call to the first state that shows what it did, at most
    step()        lets the cell go on a little
    close()       ends it

Everything is measured on the driver's own stamps, so that a rig may run in real time, skip
states or show them late. `pytest tests/contract --rig MODULE:CLASS` tries one of your own.
"""

from functools import cache

import numpy as np

from robots.drivers.socket_arms import SocketArms
from simulation.loopback.process import LoopbackProcess
from simulation.loopback.settings import LoopbackSettings
from simulation.table_world import TableWorld


class PyBulletRig:
    """The simulated arms, far from a cable."""

    step_s = 1 / 240
    delay_s = 0.0

    def __init__(self):
        nodes_m = np.column_stack(
            [np.linspace(-0.1, 0.1, 21), np.full(21, 0.3), np.full(21, 0.004)]
        )
        self._world = TableWorld(nodes_m, round(1 / self.step_s))
        self.driver = self._world.driver

    def step(self):
        self._world.advance(1)

    def close(self):
        self._world.body.close()


@cache
def process(**settings):
    """Return a controller that serves one test after the other; it ends with this process."""
    return LoopbackProcess(LoopbackSettings(lockstep=True, fresh=True, **settings))


class LoopbackRig:
    """A controller in another process, in lock-step."""

    delay_s = 0.004
    settings = {}  # noqa: RUF012 - it is read only

    def __init__(self):
        controller = process(**self.settings)
        self.driver = SocketArms(controller.host, controller.port)
        self.step_s = self.driver.cycle_s

    def step(self):
        clock = self.driver.clock
        clock.sleep_until(clock.now_s() + self.step_s)

    def close(self):
        self.driver.close()


class BadLinkRig(LoopbackRig):
    """The same over a link that is slow, varies, and loses one message in twelve."""

    delay_s = 0.25  # a command that is lost twice
    settings = {"latency_s": 0.02, "jitter_s": 0.01, "loss": 0.08}  # noqa: RUF012


RIGS = {"pybullet": PyBulletRig, "loopback": LoopbackRig, "bad link": BadLinkRig}
