"""Commands on their way to a controller: sent again until it says that it has taken them."""

from collections.abc import Sequence
from itertools import count
from math import inf

from robots.drivers.messages import (
    Command,
    EmergencyStop,
    Execute,
    GoOn,
    GripCommand,
    Hold,
    Stop,
)
from robots.interfaces import Arm, Grip


class Outbox:
    """Numbers commands, keeps those that may not have arrived, and says when to repeat them."""

    def __init__(self, resend_s: float, resend_stop_s: float) -> None:
        """Begin empty.

        Args:
            resend_s: A command that is not taken is sent again after that [s].
            resend_stop_s: The same of stops, which are small and must not wait [s].
        """
        self._resend_s, self._resend_stop_s = resend_s, resend_stop_s
        self._numbers = count(1)
        self._waiting: list[Command] = []
        self._sent_s: dict[int, float] = {}
        # Until the command of this number is taken, a motion may have begun.
        self._may_move = 0

    def execute(self, period_s: float, samples: bytes) -> None:
        """Add a trajectory."""
        command = Execute(number=next(self._numbers), period_s=period_s, samples=samples)
        self._may_move = command.number
        self._waiting.append(command)

    def grip(self, arm: Arm, grip: Grip) -> None:
        """Add a command to a gripper."""
        self._waiting.append(GripCommand(number=next(self._numbers), arm=arm, grip=grip))

    def hold(self) -> None:
        """Add a wish to hold."""
        self._waiting.append(Hold(number=next(self._numbers)))

    def go_on(self) -> None:
        """Add a wish to go on."""
        self._waiting.append(GoOn(number=next(self._numbers)))

    def stop(self) -> None:
        """Put a stop before all that waits: motions are given up, grips come after it."""
        self._overtake(Stop(number=next(self._numbers)))

    def emergency_stop(self) -> None:
        """Put an emergency stop before all that waits, which is given up."""
        self._overtake(EmergencyStop(number=next(self._numbers)))
        self._waiting = self._waiting[:1]

    def taken(self, number: int) -> None:
        """Forget the commands up to a number: they have been taken or refused."""
        self._waiting = [command for command in self._waiting if command.number > number]
        self._sent_s = {key: value for key, value in self._sent_s.items() if key > number}
        if number >= self._may_move:
            self._may_move = 0

    @property
    def may_move(self) -> bool:
        """Whether a trajectory is on its way, of which nothing has been heard."""
        return self._may_move > 0

    @property
    def commands_motion(self) -> bool:
        """Whether anything but a grip is on its way."""
        return any(not isinstance(command, GripCommand) for command in self._waiting)

    def grips(self, arm: Arm) -> bool:
        """Return whether a command to a gripper is on its way."""
        return any(isinstance(each, GripCommand) and each.arm == arm for each in self._waiting)

    def due(self, now_s: float) -> Sequence[Command]:
        """Return what is to be sent now, in order: what was not, and what is overdue."""
        due = [command for command in self._waiting if self._due_s(command) <= now_s + 1e-9]
        self._sent_s.update((command.number, now_s) for command in due)
        return due

    def send_anew(self) -> None:
        """Count everything as not sent: the connection is another one."""
        self._sent_s.clear()

    def _due_s(self, command: Command) -> float:
        stops = isinstance(command, Stop | EmergencyStop)
        wait_s = self._resend_stop_s if stops else self._resend_s
        return self._sent_s.get(command.number, -inf) + wait_s

    def _overtake(self, stop: Stop | EmergencyStop) -> None:
        # A gripper's command may have been taken already; to give it again changes nothing.
        grips = [command for command in self._waiting if isinstance(command, GripCommand)]
        again = [grip.model_copy(update={"number": next(self._numbers)}) for grip in grips]
        self._waiting = [stop, *again]
        if self._may_move:
            self._may_move = stop.number
