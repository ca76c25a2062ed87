"""The loopback controller as a process: a socket, a clock, one driver at a time."""

import select
import socket
import time
from collections.abc import Callable
from contextlib import suppress

from executive.core.work import InlineWorker, ThreadWorker
from robots.drivers.messages import (
    VERSION,
    Advance,
    Advanced,
    ControllerState,
    Hello,
    Message,
    Sorry,
    ToDriver,
    Welcome,
    WireError,
)
from robots.drivers.wire import Wire
from robots.limits import yumi_limits
from robots.placement import HOME_RAD
from simulation.loopback.controller import Controller
from simulation.loopback.settings import LoopbackSettings
from simulation.loopback.station import Station

HOST = "127.0.0.1"
_IDLE_S = 0.1
_SHORTEST_WAIT_S = 0.001


class Server:
    """Listens for drivers and runs the controller for one of them.

    Attributes:
        port: Where it listens.
    """

    def __init__(self, settings: LoopbackSettings) -> None:
        """Listen.

        Raises:
            OSError: The port cannot be had.
        """
        self._settings = settings
        self._listener = socket.create_server((HOST, settings.port))
        self._listener.setblocking(False)
        self.port: int = self._listener.getsockname()[1]
        self._controller = self._new_controller()
        self._wire: Wire | None = None
        self._newcomers: list[Wire] = []
        self._station: Station | None = None
        self._granted_s, self._started_s = 0.0, time.monotonic()
        self._cuts_s = sorted(settings.cuts_s)

    def serve(self, ended: Callable[[], bool]) -> None:
        """Serve drivers until `ended` says so."""
        while not ended():
            self._wait()
            # Who has left is noticed before who comes instead.
            self._hear()
            self._admit()
            if not self._settings.lockstep:
                self._run_to(self._now_s())

    def close(self) -> None:
        """Close all sockets."""
        self._drop()
        for wire in self._newcomers:
            wire.close()
        self._listener.close()

    def _new_controller(self) -> Controller:
        settings = self._settings
        worker = InlineWorker() if settings.lockstep else ThreadWorker()
        return Controller(HOME_RAD, yumi_limits(), settings.cycle_s, settings.between_m, worker)

    def _now_s(self) -> float:
        if self._settings.lockstep:
            return self._granted_s
        return time.monotonic() - self._started_s

    def _wait(self) -> None:
        """Wait until something comes or a cycle is due."""
        timeout_s = _IDLE_S
        if self._station is not None and not self._settings.lockstep:
            timeout_s = max(self._station.next_s - self._now_s(), _SHORTEST_WAIT_S)
        wires = self._newcomers if self._wire is None else [*self._newcomers, self._wire]
        ends = [self._listener.fileno(), *(wire.fileno() for wire in wires)]
        select.select(ends, [], [], timeout_s)

    def _admit(self) -> None:
        """Take new connections, and the drivers among them that say hello."""
        with suppress(BlockingIOError):
            self._newcomers.append(Wire(self._listener.accept()[0]))
        for wire in tuple(self._newcomers):
            try:
                messages = wire.receive()
            except WireError:
                self._newcomers.remove(wire)
                wire.close()
                continue
            if messages:
                self._newcomers.remove(wire)
                first = messages[0]
                self._greet(wire, first if isinstance(first, Hello) else None)
                self._take(messages[1:])

    def _greet(self, wire: Wire, hello: Hello | None) -> None:
        refusal = self._refusal_of(hello)
        if hello is None or refusal:
            self._send_to(wire, Sorry(text=refusal))
            wire.close()
            return
        self._drop()
        station, resumed = self._station, True
        if station is None or station.session != hello.session:
            station, resumed = self._begin(hello.session), False
        self._wire, self._station = wire, station
        now_s = self._now_s()
        self._send(station.welcome(now_s, resumed))
        self._send(station.state())

    def _refusal_of(self, hello: Hello | None) -> str:
        if hello is None or hello.version != VERSION:
            got = "no hello" if hello is None else f"version {hello.version}"
            return f"got {got}; expected the hello of a driver of version {VERSION}"
        station = self._station
        if station is None or station.session == hello.session or self._settings.fresh:
            return ""
        if self._wire is not None and not station.silent(self._now_s()):
            return "it serves another driver; expected one at a time"
        return "its arms still move; try again when they rest" if self._controller.moving else ""

    def _begin(self, session: str) -> Station:
        if self._settings.fresh:
            self._controller = self._new_controller()
            self._granted_s, self._started_s = 0.0, time.monotonic()
            self._cuts_s = sorted(self._settings.cuts_s)
        self._controller.release()
        return Station(self._controller, self._settings, session, self._now_s())

    def _hear(self) -> None:
        try:
            while self._wire is not None and (messages := self._wire.receive()):
                self._take(messages)
        except WireError:
            self._drop()

    def _take(self, messages: list[Message]) -> None:
        for message in messages:
            if self._station is None or self._wire is None:
                return
            match message:
                case Advance() if self._settings.lockstep:
                    self._granted_s = max(self._granted_s, message.until_s)
                    self._run_to(self._granted_s)
                    self._send(Advanced(now_s=self._granted_s))
                case Hello() | Advance() | Welcome() | Sorry() | ControllerState() | Advanced():
                    self._send(Sorry(text=f"got {message.kind!r}, which does not belong here"))
                    self._drop()
                case _:
                    self._station.hear(message, self._now_s())

    def _run_to(self, now_s: float) -> None:
        if self._station is None:
            return
        for state in self._station.run_to(now_s):
            self._send(state)
        if self._cuts_s and self._cuts_s[0] <= now_s:
            self._cuts_s.pop(0)
            self._station.cut()
            self._drop()

    def _send(self, message: ToDriver) -> None:
        if self._wire is not None and not self._send_to(self._wire, message):
            self._drop()

    def _send_to(self, wire: Wire, message: ToDriver) -> bool:
        try:
            wire.send(message)
        except WireError:
            return False
        return True

    def _drop(self) -> None:
        if self._wire is not None:
            self._wire.close()
        self._wire = None
