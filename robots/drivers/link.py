"""The driver's side of a connection to a controller: what was heard, and what is wrong with it.

In real time, `exchange` is called often; in lock-step, the controller's time goes on by
`let_pass` and by nothing else. Either way nothing waits for the controller, except for the
first connection and for a step of time.
"""

import threading
import time
import uuid
from dataclasses import dataclass

from executive.core.clock import Clock
from executive.core.errors import DeviceError
from robots.drivers.messages import (
    VERSION,
    Advance,
    Advanced,
    Beat,
    ControllerState,
    Hello,
    Message,
    Sorry,
    Welcome,
    WireError,
)
from robots.drivers.outbox import Outbox
from robots.drivers.wire import Wire

_RECONNECT_S = 0.1


@dataclass(frozen=True, slots=True)
class LinkSettings:
    """How a driver keeps in touch.

    Attributes:
        beat_s: Time between signs of life, and between looks at what has come.
        resend_s: A command that is not taken is sent again after that; stops with every beat.
        answer_s: How long the first connection, and a step in lock-step, may take.
    """

    beat_s: float = 0.02
    resend_s: float = 0.1
    answer_s: float = 10.0


class Link:
    """A session with a controller; survives connections.

    Attributes:
        lock: To be held around every call but `let_pass`, which takes it step by step.
        clock: The cell's clock; in lock-step the controller's.
        welcome: What the controller says of itself.
        state: The newest state that has come.
        offset_s: The clock's time less the controller's.
        trouble: What went wrong for good; empty while nothing has.
    """

    def __init__(
        self, host: str, port: int, outbox: Outbox, clock: Clock, settings: LinkSettings
    ) -> None:
        """Connect, and wait for the first state.

        Args:
            host: Where the controller listens.
            port: The same.
            outbox: What to send.
            clock: The cell's clock, unless the controller is in lock-step.
            settings: How to keep in touch.

        Raises:
            DeviceError: There is no controller, or it does not take this driver.
        """
        self._host, self._port = host, port
        self._outbox, self._settings = outbox, settings
        self._session = uuid.uuid4().hex
        self.lock = threading.RLock()
        self._wire: Wire | None = None
        self._welcome: Welcome | None = None
        self._state: ControllerState | None = None
        self._lost = self.trouble = ""
        self._granted_s = self._heard_s = 0.0
        self._beaten_s = -1e9
        asked_s = clock.now_s()
        self.welcome, self.state = self._first_answer()
        if self.welcome.lockstep:
            self.clock: Clock = LockstepClock(self)
            self._granted_s, self.offset_s = self.welcome.now_s, 0.0
        else:
            self.clock = clock
            self.offset_s = (asked_s + clock.now_s()) / 2.0 - self.welcome.now_s
        self._heard_s = self._looked_s = self.clock.now_s()

    @property
    def granted_s(self) -> float:
        """How far a controller in lock-step has come [s]."""
        return self._granted_s

    def exchange(self) -> None:
        """Take what has come, send what is due, and see whether the controller is there."""
        now_s = self.clock.now_s()
        if now_s - self._looked_s > self.welcome.silence_s / 2.0:
            # It was this process that was busy: the controller gets its time to answer anew.
            self._heard_s = now_s
        self._looked_s = now_s
        try:
            wire = self._wire or self._connect(_RECONNECT_S)
            self._take_all(wire)
            self._send_due(wire, now_s)
        except WireError as cause:
            self._lose(cause)
        self._watch(now_s)

    def let_pass(self, until_s: float) -> None:
        """Let the time of a controller in lock-step go on.

        Raises:
            DeviceError: It does not answer.
        """
        while self._granted_s < until_s - 1e-9:
            with self.lock:
                self.exchange()
                self._advance(min(until_s, self._granted_s + self._settings.beat_s))

    def raise_trouble(self) -> None:
        """Raise what went wrong for good, if anything has."""
        if self.trouble:
            raise DeviceError(self.trouble)

    def close(self) -> None:
        """Leave the controller; safe to call again."""
        if self._wire is not None:
            self._wire.close()
        self._wire = None

    def _first_answer(self) -> tuple[Welcome, ControllerState]:
        end_s = time.monotonic() + self._settings.answer_s
        try:
            wire = self._connect(self._settings.answer_s)
            while self._welcome is None or self._state is None:
                self._wait(wire, end_s)
                self._take_all(wire)
        except WireError as cause:
            self._fail(str(cause), "try: see that the controller runs there and serves nobody else")
            self.close()
            raise DeviceError(self.trouble) from cause
        return self._welcome, self._state

    def _connect(self, timeout_s: float) -> Wire:
        self._wire = Wire.connect(self._host, self._port, timeout_s)
        self._wire.send(Hello(version=VERSION, session=self._session))
        self._outbox.send_anew()
        return self._wire

    def _wait(self, wire: Wire, end_s: float) -> None:
        if not wire.wait(end_s - time.monotonic()):
            raise WireError(f"no answer within {self._settings.answer_s:g} s")

    def _send_due(self, wire: Wire, now_s: float) -> None:
        for command in self._outbox.due(now_s):
            wire.send(command)
        if now_s - self._beaten_s >= self._settings.beat_s - 1e-9:
            self._beaten_s = now_s
            wire.send(Beat(time_s=now_s, seen_s=self.state.stamp_s))

    def _take_all(self, wire: Wire) -> None:
        for message in wire.receive():
            self._take(message)

    def _take(self, message: Message) -> None:
        match message:
            case ControllerState():
                self._take_state(message)
            case Advanced():
                self._granted_s = message.now_s
            case Welcome():
                self._take_welcome(message)
            case Sorry():
                raise WireError(message.text)
            case _:
                raise WireError(f"got {message.kind!r}, which only a driver sends")

    def _take_welcome(self, welcome: Welcome) -> None:
        if welcome.version != VERSION:
            raise WireError(f"it speaks version {welcome.version}; expected {VERSION}")
        if self._welcome is not None and not welcome.resumed:
            self._fail(
                "it was started anew or has served another driver; what it did is unknown",
                "try: run the mission anew",
            )
        self._welcome, self._lost = welcome, ""

    def _take_state(self, state: ControllerState) -> None:
        if self._state is not None and state.stamp_s <= self._state.stamp_s:
            return  # it was overtaken on its way
        self._state = self.state = state
        if state.echo_s is not None:
            self._heard_s = max(self._heard_s, state.echo_s)
        self._outbox.taken(state.taken)
        if state.fault:
            self._fail(state.fault, "")

    def _lose(self, cause: WireError) -> None:
        self.close()
        self._lost = self._lost or str(cause)

    def _watch(self, now_s: float) -> None:
        silent_s = now_s - self._heard_s
        if silent_s <= self.welcome.silence_s:
            return
        lost = f"the connection is lost ({self._lost}); " if self._lost else ""
        self._fail(
            f"{lost}got no answer to anything sent in the last {silent_s:.2f} s; expected one "
            f"within {self.welcome.silence_s:g} s; a controller that hears nothing for as long "
            "stops its arms by itself",
            "try: see whether it still runs",
        )

    def _fail(self, what: str, advice: str) -> None:
        """Note the first thing that goes wrong for good."""
        where = f"arms: controller at {self._host}:{self._port}: {what}"
        self.trouble = self.trouble or "; ".join(part for part in (where, advice) if part)

    def _advance(self, until_s: float) -> None:
        """Ask for a step of time and wait for it, over another connection if need be."""
        asked: Wire | None = None
        end_s = time.monotonic() + self._settings.answer_s
        try:
            while self._granted_s < until_s - 1e-9:
                wire = self._wire or self._connect(_RECONNECT_S)
                if asked is not wire:
                    wire.send(Advance(until_s=until_s))
                    asked = wire
                self._wait(wire, end_s)
                self._take_or_lose(wire)
        except WireError as cause:
            self._fail(f"its time does not go on ({cause})", "try: see whether it still runs")
            raise DeviceError(self.trouble) from cause

    def _take_or_lose(self, wire: Wire) -> None:
        try:
            self._take_all(wire)
        except WireError as cause:
            self._lose(cause)


class LockstepClock:
    """The clock of a controller in lock-step: waiting on it lets its time go on."""

    def __init__(self, link: Link) -> None:
        """Show the time of a link."""
        self._link = link

    def now_s(self) -> float:
        """Return how far the controller has come."""
        return self._link.granted_s

    def sleep_until(self, time_s: float) -> None:
        """Let the controller go on until then.

        Raises:
            DeviceError: It does not answer.
        """
        self._link.let_pass(time_s)
