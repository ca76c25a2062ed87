"""Starts a loopback controller in a process of its own and ends it."""

import json
import signal
import subprocess
import sys
from types import TracebackType
from typing import Self

from executive.core.errors import DeviceError
from simulation.loopback.settings import LoopbackSettings


class LoopbackProcess:
    """A loopback controller that lasts as long as the block, or until `close`.

    Attributes:
        host: Where it listens.
        port: The same.
    """

    def __init__(self, settings: LoopbackSettings | None = None) -> None:
        """Start it and wait until it listens.

        Raises:
            DeviceError: It does not start.
        """
        given = (settings or LoopbackSettings()).model_dump(mode="json")
        command = [sys.executable, "-m", "simulation.loopback", "--until-input-ends"]
        command += [f"{name}={json.dumps(value)}" for name, value in given.items()]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert self._process.stdout is not None
        line = self._process.stdout.readline().strip()
        said, _, address = line.rpartition(" ")
        if said != "listening on":
            self.close()
            raise DeviceError(f"loopback controller: did not start; got {line or 'no answer'!r}")
        self.host, _, port = address.partition(":")
        self.port = int(port)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def freeze(self) -> None:
        """Let it hang as it is."""
        self._process.send_signal(signal.SIGSTOP)

    def thaw(self) -> None:
        """Let it go on."""
        self._process.send_signal(signal.SIGCONT)

    def kill(self) -> None:
        """End it at once, as a crash would."""
        self._process.kill()
        self._process.wait()

    def close(self) -> None:
        """End it; safe to call again."""
        self.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
