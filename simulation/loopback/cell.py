"""A cell of two arms whose controller is behind a socket, and nothing else."""

from collections.abc import Iterable, Mapping
from contextlib import suppress

from executive.core.clock import Clock
from executive.core.errors import DeviceError, InputError
from executive.core.world import StreamMessage
from robots.drivers.socket_arms import SocketArms
from simulation.loopback.cell_config import SocketCellConfig
from simulation.loopback.process import LoopbackProcess
from simulation.streams import Stream, joint_states_json
from simulation.table_cell_config import read_settings

_RATE_HZ, _POLL_S = 20.0, 0.02


class SocketCell:
    """`executive.core.world.Cell` over `SocketArms`.

    Attributes:
        clock: The controller's time in lock-step, else that of the machine.
        driver: The arms.
        devices: Clock and driver, by name.
    """

    def __init__(self, config: Mapping[str, object], scenario: Mapping[str, object]) -> None:
        """Connect, with a loopback controller of its own where no other one is named.

        Args:
            config: See `SocketCellConfig`.
            scenario: Nothing: there is nothing to set up.

        Raises:
            InputError: A key or value is not known.
            DeviceError: There is no controller, or it does not take this driver.
        """
        settings = read_settings(SocketCellConfig, config, "cell config")
        if scenario:
            raise InputError(
                f"scenario: a cell of arms alone takes none; got {next(iter(scenario))!r}"
            )
        self._process = None if settings.address else LoopbackProcess(settings.controller)
        host, _, port = settings.address.rpartition(":")
        if self._process is not None:
            host, port = self._process.host, str(self._process.port)
        try:
            self.driver = SocketArms(host, int(port))
        except BaseException:
            self._end_process()
            raise
        self.clock: Clock = self.driver.clock
        self.devices: Mapping[str, object] = {"clock": self.clock, "driver": self.driver}
        self._joint_states = Stream("/joint_states", "JointStates", _RATE_HZ)

    def drain_streams(self) -> Iterable[StreamMessage]:
        """Return where the joints are now, if they have moved; nothing of arms that are lost."""
        now_s = self.clock.now_s()
        if self._joint_states.due(now_s):
            with suppress(DeviceError):
                self._joint_states.add(now_s, joint_states_json(self.driver.state()))
        return self._joint_states.drain()

    def stop(self) -> None:
        """Bring the arms to rest by a jerk-limited stop.

        Raises:
            DeviceError: Nobody can say whether the controller hears it.
        """
        self.driver.stop()
        while self.driver.state().moving:
            self.clock.sleep_until(self.clock.now_s() + _POLL_S)

    def emergency_stop(self) -> None:
        """Bring the arms to rest as fast as the brakes allow; they take no command after that.

        Raises:
            DeviceError: As for `stop`.
        """
        self.driver.emergency_stop()

    def close(self) -> None:
        """Leave the controller, and end it if it is the cell's own."""
        self.driver.close()
        self._end_process()

    def truth(self) -> object | None:
        """Return None: there is nothing to score."""
        return None

    def _end_process(self) -> None:
        if self._process is not None:
            self._process.close()
