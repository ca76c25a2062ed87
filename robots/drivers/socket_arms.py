"""A driver of arms whose controller is another process, here or on another machine."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from executive.core.clock import Clock, MonotonicClock
from executive.core.errors import DeviceError
from robots.drivers.link import Link, LinkSettings
from robots.drivers.messages import ControllerState, numbers
from robots.drivers.outbox import Outbox
from robots.drivers.samples import SampledTrajectory
from robots.drivers.starting import refuse_after_emergency, refuse_elsewhere, refuse_while_moving
from robots.interfaces import ARMS, Arm, ArmsState, Grip, Trajectory


class SocketArms:
    """An `ArmsDriver` over a socket; the controller may run in real time or in lock-step.

    In real time a thread keeps in touch. In lock-step the controller's time goes on while
    `clock` is waited on, and at no other time. What the controller refuses later than the call
    that asked for it is raised by the next call.

    Attributes:
        clock: The cell's clock: the one that was given, or the controller's in lock-step.
        cycle_s: Time between two states of the controller.
    """

    def __init__(
        self,
        host: str,
        port: int,
        *,
        clock: Clock | None = None,
        settings: LinkSettings | None = None,
    ) -> None:
        """Connect, and wait for the first state.

        Args:
            host: Where the controller listens.
            port: The same.
            clock: The cell's clock, for a controller in real time; a new one when None.
            settings: How to keep in touch.

        Raises:
            DeviceError: There is no controller, or it does not take this driver.
        """
        settings = settings or LinkSettings()
        self._outbox = Outbox(settings.resend_s, settings.beat_s)
        self._link = Link(host, port, self._outbox, clock or MonotonicClock(), settings)
        self._latched = False
        self._refused = 0
        self.cycle_s = self._link.welcome.cycle_s
        self.clock: Clock = self._link.clock
        self._closed = threading.Event()
        self._thread = threading.Thread(
            target=self._keep_in_touch, args=(settings.beat_s,), daemon=True
        )
        if not self._link.welcome.lockstep:
            self._thread.start()

    def state(self) -> ArmsState:
        """Return the latest state that has come.

        Raises:
            DeviceError: The controller is silent or reports a fault, or has refused a command.
        """
        with self._looked() as latest:
            return ArmsState(
                positions_rad=numbers(latest.positions_rad),
                velocities_rad_s=numbers(latest.velocities_rad_s),
                accelerations_rad_s2=numbers(latest.accelerations_rad_s2),
                openings_m=dict(zip(ARMS, latest.openings_m, strict=True)),
                moving=self._mode(latest) != "rest",
                stamp_s=latest.stamp_s + self._link.offset_s,
            )

    def execute(self, trajectory: Trajectory) -> None:
        """Send a trajectory that begins at the present state.

        Raises:
            DeviceError: It begins elsewhere, another one is running, or the link is broken.
        """
        with self._looked() as latest:
            refuse_after_emergency(self._latched)
            refuse_while_moving(self._mode(latest))
            tolerance_rad = self._link.welcome.tolerance_rad
            refuse_elsewhere(trajectory, numbers(latest.positions_rad), tolerance_rad)
            samples = SampledTrajectory.of(trajectory, self.cycle_s)
            self._outbox.execute(samples.period_s, samples.to_bytes())
            self._link.exchange()

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Start opening or closing a gripper.

        Raises:
            DeviceError: An emergency stop was made, or the link is broken.
        """
        with self._looked():
            refuse_after_emergency(self._latched)
            self._outbox.grip(arm, grip)
            self._link.exchange()

    def gripping(self, arm: Arm) -> bool:
        """Return whether the fingers are on their way, or a command to them is."""
        with self._looked() as latest:
            return latest.gripping[ARMS.index(arm)] or self._outbox.grips(arm)

    def holds(self, arm: Arm) -> bool:
        """Return whether something is between the closed fingers."""
        with self._looked() as latest:
            return latest.holding[ARMS.index(arm)] and not self._outbox.grips(arm)

    def hold(self) -> None:
        """Bring a trajectory to rest on its own path, to be taken up again."""
        self._ask(self._outbox.hold)

    def go_on(self) -> None:
        """Take up a trajectory that was held."""
        self._ask(self._outbox.go_on)

    def held(self) -> bool:
        """Return whether a trajectory rests on its path, and nothing was asked since."""
        with self._looked() as latest:
            return latest.held and not self._outbox.commands_motion

    def stop(self) -> None:
        """Bring all joints to rest within their jerk limits.

        Raises:
            DeviceError: Nobody can say whether the controller hears it. It was sent all the
                same, and a controller that hears nothing stops its arms by itself.
        """
        self._ask(self._outbox.stop)

    def emergency_stop(self) -> None:
        """Stop as fast as the brakes allow, and take no more commands; from any thread.

        Raises:
            DeviceError: As for `stop`.
        """
        self._latched = True
        self._ask(self._outbox.emergency_stop)

    def close(self) -> None:
        """Leave the controller, which stops what still moves; safe to call again."""
        self._closed.set()
        if self._thread.is_alive():
            self._thread.join()
        with self._link.lock:
            self._link.close()

    def _mode(self, latest: ControllerState) -> str:
        begins = latest.mode == "rest" and self._outbox.may_move
        return "motion" if begins else latest.mode

    def _ask(self, add: Callable[[], None]) -> None:
        with self._link.lock:
            add()
            self._link.exchange()
            self._link.raise_trouble()

    @contextmanager
    def _looked(self) -> Iterator[ControllerState]:
        """Hold the lock, with the newest state after a look at what has come."""
        with self._link.lock:
            self._link.exchange()
            self._link.raise_trouble()
            self._raise_refusal()
            yield self._link.state

    def _raise_refusal(self) -> None:
        state = self._link.state
        if state.refused > self._refused:
            self._refused = state.refused
            raise DeviceError(state.refusal)

    def _keep_in_touch(self, beat_s: float) -> None:
        while not self._closed.wait(beat_s):
            with self._link.lock:
                self._link.exchange()
