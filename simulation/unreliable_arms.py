"""Arms that now and then miss, let slip or stop: faults of execution, drawn by the seed."""

from dataclasses import dataclass

import numpy as np
from pydantic import JsonValue

from executive.engine.checkpoints.chance import generator_state, generator_words
from robots.interfaces import Arm, ArmsDriver, ArmsState, Grip, Trajectory

# When a cable slips out of a hand that has taken it, and which part of a motion is made [s, 1].
SLIP_AFTER_S = (0.5, 5.0)
STOP_AFTER_SHARE = (0.1, 0.9)


@dataclass(frozen=True, slots=True)
class ArmFaults:
    """How often something goes wrong.

    Attributes:
        miss_rate: Share of closings at which the fingers take nothing, and stay open.
        slip_rate: Share of grasps out of which the cable slips some seconds later.
        stop_rate: Share of motions that end on the way, as at a protective stop.
    """

    miss_rate: float = 0.0
    slip_rate: float = 0.0
    stop_rate: float = 0.0

    def any(self) -> bool:
        """Return whether anything goes wrong at all."""
        return max(self.miss_rate, self.slip_rate, self.stop_rate) > 0.0


class UnreliableArms:
    """An `ArmsDriver` that hands on to another one what does not go wrong.

    What is to happen later happens when the driver is next asked for its state, which skills do
    in every tick.
    """

    def __init__(self, driver: ArmsDriver, faults: ArmFaults, rng: np.random.Generator) -> None:
        """Wrap a driver.

        Args:
            driver: Controllers that do as they are told.
            faults: What goes wrong, and how often.
            rng: Draws when it does.
        """
        self._driver, self._faults, self._rng = driver, faults, rng
        self._slips_s = dict[Arm, float]()
        self._stop_s: float | None = None

    def state(self) -> ArmsState:
        """Return the latest state."""
        self._happen()
        return self._driver.state()

    def gripping(self, arm: Arm) -> bool:
        """Return whether the fingers are still on their way."""
        self._happen()
        return self._driver.gripping(arm)

    def holds(self, arm: Arm) -> bool:
        """Return whether something is between the closed fingers (they are not shut)."""
        self._happen()
        return self._driver.holds(arm)

    def execute(self, trajectory: Trajectory) -> None:
        """Start a trajectory, which may end on the way."""
        self._driver.execute(trajectory)
        self._stop_s = None
        if self._rng.random() < self._faults.stop_rate:
            share = float(self._rng.uniform(*STOP_AFTER_SHARE))
            self._stop_s = self._now_s() + share * trajectory.duration_s

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Start opening or closing a gripper; a closing one may miss."""
        self._slips_s.pop(arm, None)
        closes = grip != "open"
        if closes and self._rng.random() < self._faults.miss_rate:
            self._driver.grip(arm, "open")
            return
        self._driver.grip(arm, grip)
        if closes and self._rng.random() < self._faults.slip_rate:
            self._slips_s[arm] = self._now_s() + float(self._rng.uniform(*SLIP_AFTER_S))

    def hold(self) -> None:
        """Bring a trajectory to rest on its own path, to be taken up again."""
        self._driver.hold()

    def go_on(self) -> None:
        """Take up a trajectory that was held."""
        self._driver.go_on()

    def held(self) -> bool:
        """Return whether a trajectory rests on its path."""
        return self._driver.held()

    def stop(self) -> None:
        """Bring all joints to rest within their jerk limits."""
        self._driver.stop()

    def emergency_stop(self) -> None:
        """Stop as fast as the brakes allow, and take no more commands; from any thread."""
        self._driver.emergency_stop()

    def memento(self) -> JsonValue:
        """Return what is to be drawn next; checkpoints come where nothing moves or is held."""
        return generator_words(self._rng)

    def recall(self, memento: JsonValue) -> None:
        """Go on as the arms went on from which the memento is."""
        self._rng.bit_generator.state = generator_state(memento)

    def _now_s(self) -> float:
        return self._driver.state().stamp_s

    def _happen(self) -> None:
        """Let happen what was to happen by now."""
        now_s = self._now_s()
        for arm in [arm for arm, slip_s in self._slips_s.items() if slip_s <= now_s]:
            del self._slips_s[arm]
            self._driver.grip(arm, "open")
        if self._stop_s is not None and self._stop_s <= now_s:
            self._stop_s = None
            self._driver.stop()
