"""A service for the benchmark of faults: started as a user starts it, asked over HTTP, killed."""

import json
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

from benchmarks.fault_missions import MISSION, command, environment

_PATIENCE_S = 60.0


class Service:
    """A service that runs.

    Attributes:
        pid: Its process.
    """

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        """Wait until it serves."""
        assert process.stderr is not None
        line = process.stderr.readline()
        self._process, self.pid = process, process.pid
        self._address = line.partition(": ")[2].partition("/openapi.json")[0]

    def ask(self, verb: str, path: str, body: Mapping[str, object] | None = None) -> Any:
        """Send a request, and return the answer."""
        data = None if body is None else json.dumps(body).encode()
        headers = {"content-type": "application/json"}
        request = Request(self._address + path, data, headers, method=verb)
        with urlopen(request, timeout=_PATIENCE_S) as answer:
            return json.load(answer)

    def kill(self) -> None:
        """Kill it (`kill -9`)."""
        self._process.kill()


def write_served(folder: Path) -> None:
    """Write a cell of its own, and the mission for it."""
    (folder / "own.yaml").write_text("format: 1\ncell: own\nworld: dry\n", encoding="utf-8")
    text = MISSION.replace("cell: dry", "cell: own")
    (folder / "work.yaml").write_text(text, encoding="utf-8")


@contextmanager
def served(folder: Path) -> Iterator[Service]:
    """Serve the cell in a folder while the block lasts."""
    with subprocess.Popen(
        command("serve", "own.yaml", "--port", "0"),
        cwd=folder,
        stderr=subprocess.PIPE,
        text=True,
        env=environment(),
    ) as process:
        try:
            yield Service(process)
        finally:
            process.terminate()
            process.wait(_PATIENCE_S)


def wait_until(due: Callable[[], bool]) -> None:
    """Wait until something holds.

    Raises:
        TimeoutError: It never did.
    """
    deadline = time.monotonic() + _PATIENCE_S
    while not due():
        if time.monotonic() > deadline:
            raise TimeoutError("it never happened")
        time.sleep(0.02)
