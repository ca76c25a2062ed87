"""The controller's side of a session: what it hears, when it stops by itself, what it tells."""

from collections.abc import Sequence

import numpy as np

from executive.core.errors import DeviceError
from robots.drivers.messages import (
    VERSION,
    Beat,
    Command,
    ControllerState,
    EmergencyStop,
    Stop,
    Welcome,
    row,
)
from robots.interfaces import ARMS
from simulation.loopback.controller import TOLERANCE_RAD, Controller
from simulation.loopback.line import Line
from simulation.loopback.settings import LoopbackSettings


class Station:
    """One session of one driver with a controller, on a clock that it is told."""

    def __init__(
        self, controller: Controller, settings: LoopbackSettings, session: str, now_s: float
    ) -> None:
        """Begin a session.

        Args:
            controller: Moves the arms.
            settings: Times, and what is to go wrong.
            session: The driver's name for it.
            now_s: The controller's time.
        """
        self.session = session
        self._controller, self._settings = controller, settings
        to, fro = np.random.default_rng(settings.seed).spawn(2)
        self._coming: Line[Beat | Command] = Line(settings, to)
        self._going: Line[ControllerState] = Line(settings, fro)
        self._start_s, self._cycles = now_s, 0
        # What the driver has of us: the stamp of a state that it had when it spoke last.
        self._seen_s = now_s
        self._echo_s: float | None = None
        self._taken = self._refused = 0
        self._refusal = self._fault = ""

    @property
    def next_s(self) -> float:
        """When the next cycle is due."""
        return self._start_s + (self._cycles + 1) * self._settings.cycle_s

    def welcome(self, now_s: float, resumed: bool) -> Welcome:
        """Return the answer to a driver that says hello."""
        return Welcome(
            version=VERSION,
            resumed=resumed,
            now_s=now_s,
            cycle_s=self._settings.cycle_s,
            silence_s=self._settings.silence_s,
            tolerance_rad=TOLERANCE_RAD,
            lockstep=self._settings.lockstep,
        )

    def hear(self, message: Beat | Command, now_s: float) -> None:
        """Take a message that was sent now; it arrives when the link has it arrive."""
        self._coming.put(message, now_s)

    def cut(self) -> None:
        """Lose what is under way, both ways."""
        self._coming.clear()
        self._going.clear()

    def silent(self, now_s: float) -> bool:
        """Return whether the driver has not been heard for longer than it may be."""
        return now_s - self._seen_s > self._settings.silence_s

    def run_to(self, now_s: float) -> Sequence[ControllerState]:
        """Do the cycles that are due and return the states that arrive by now."""
        stall_s = self._settings.stall_at_s
        if stall_s >= 0.0 and stall_s <= now_s < stall_s + self._settings.stall_s:
            return ()
        late_s = now_s - self.next_s
        if late_s > self._settings.overrun_s:
            self._catch_breath(late_s)
        while self.next_s <= now_s + 1e-9:
            self._cycle(self.next_s)
        return self._going.due(now_s)

    def state(self) -> ControllerState:
        """Return everything that a driver has to know, as of the last cycle."""
        controller = self._controller
        left, right = (controller.fingers[arm] for arm in ARMS)
        return ControllerState(
            stamp_s=self.next_s - self._settings.cycle_s,
            mode=controller.mode,
            held=controller.held,
            positions_rad=row(controller.positions_rad),
            velocities_rad_s=row(controller.velocities_rad_s),
            accelerations_rad_s2=row(controller.accelerations_rad_s2),
            openings_m=(left.opening_m, right.opening_m),
            gripping=(left.moving, right.moving),
            holding=(left.holding, right.holding),
            taken=self._taken,
            refused=self._refused,
            refusal=self._refusal,
            echo_s=self._echo_s,
            fault=self._fault,
        )

    def _cycle(self, now_s: float) -> None:
        self._cycles += 1
        for message in self._coming.due(now_s):
            if isinstance(message, Beat):
                self._feel(message)
            else:
                self._take(message)
        if self._controller.moving and self.silent(now_s):
            self._stop_for(
                f"it heard nothing newer than {now_s - self._seen_s:.2f} s; expected a sign of "
                f"life every {self._settings.silence_s:g} s"
            )
        self._controller.advance()
        self._going.put(self.state(), now_s)

    def _catch_breath(self, late_s: float) -> None:
        """Leave cycles out that were missed: joints cannot make up for them in one."""
        self._cycles += int(late_s / self._settings.cycle_s)
        if self._controller.moving:
            self._stop_for(
                f"a cycle came {late_s:.2f} s late; expected {self._settings.overrun_s:g} s at most"
            )

    def _stop_for(self, fault: str) -> None:
        self._controller.stop()
        self._fault = self._fault or f"it stopped the arms by itself: {fault}"

    def _feel(self, beat: Beat) -> None:
        self._seen_s = max(self._seen_s, beat.seen_s)
        self._echo_s = beat.time_s if self._echo_s is None else max(self._echo_s, beat.time_s)

    def _take(self, command: Command) -> None:
        stops = isinstance(command, Stop | EmergencyStop)
        # A gap means that a command was lost and will come again; only stops do not wait for it.
        if command.number <= self._taken or (command.number > self._taken + 1 and not stops):
            return
        self._taken = command.number
        try:
            if self._fault and not stops:
                raise DeviceError(f"arms: {self._fault}; got another command; expected none")
            self._controller.obey(command)
        except DeviceError as cause:
            self._refused, self._refusal = command.number, str(cause)
