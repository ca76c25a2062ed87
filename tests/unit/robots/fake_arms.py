"""Arms that are where they are told to be, the moment they are told; of any robot."""

import numpy as np
import pytest

from robots.interfaces import ARMS, ArmsState

OPENINGS_M = {"open": 0.05, "cage": 0.012, "pinch": 0.0}


class FakeArms:
    """An `ArmsDriver` in memory with perfect tracking; a test moves time on with `finish`."""

    def __init__(self, positions_rad, grippers=ARMS):
        self.positions_rad = np.array(positions_rad, dtype=float)
        self.openings_m = dict.fromkeys(grippers, OPENINGS_M["open"])
        self.running = None
        self.is_held = False
        self.executed = []

    def state(self):
        still = np.zeros_like(self.positions_rad)
        return ArmsState(
            self.positions_rad, still, still, dict(self.openings_m), self.running is not None, 0.0
        )

    def execute(self, trajectory):
        assert trajectory.at(0.0)[0] == pytest.approx(self.positions_rad, abs=1e-9)
        self.running = trajectory
        self.executed.append(trajectory)

    def finish(self):
        self.positions_rad = self.running.at(self.running.duration_s)[0]
        self.running = None

    def grip(self, arm, grip):
        self.openings_m[arm] = OPENINGS_M[grip]

    def gripping(self, arm):
        return False

    def holds(self, arm):
        return False

    def hold(self):
        self.is_held = self.running is not None

    def go_on(self):
        self.is_held = False

    def held(self):
        return self.is_held

    def stop(self):
        self.running = None

    def emergency_stop(self):
        self.running = None
