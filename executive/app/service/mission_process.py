"""The process that runs one mission of a service: a `cellwright run`, or `resume`, of its own.

A mission that breaks does not break the service, and requests to the service take no time from
its ticks. When the service dies, the mission is stopped in order.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Literal

from pydantic import ValidationError

from executive.app.cell_locks import HELD_VARIABLE
from executive.app.service.messages import MissionRequest
from executive.core.errors import InputError
from executive.engine.recording.messages import RunReport
from executive.engine.running.remote import NotRunningError, send

BY = "the service"
STOP_S = 30.0
"""How long a mission may take to stop in order before it is stopped at once [s]."""

END_S = 10.0
"""How long its process may take after that before it is ended [s]."""

_TIED = (
    "import signal; from executive.engine.faults.tether import tie_to_stdin; "
    "tie_to_stdin(signal.SIGTERM); from executive.cli.main import main; main()"
)
_LAST_WORDS = 2000


def run_words(request: MissionRequest) -> list[str]:
    """Return the command line of a mission, without its recording."""
    words = ["run", request.mission, "--seed", str(request.seed)]
    if request.timeout_s is not None:
        words += ["--timeout", f"{request.timeout_s:.9g}"]
    if request.speed is not None:
        words += ["--speed", f"{request.speed:.9g}"]
    for key, value in request.settings.items():
        words += ["--set", f"{key}={json.dumps(value)}"]
    return words


class MissionProcess:
    """One mission under way."""

    def __init__(self, words: Sequence[str], recording: Path, lock: Path) -> None:
        """Start it.

        Args:
            words: Its command line, without the recording.
            recording: Where it is recorded.
            lock: The lock of the cell, which the service holds for it.
        """
        self.recording = recording
        self._log = recording.with_suffix(".log")
        self._stopped_s: float | None = None
        self._at_once_s: float | None = None
        tether, self._held = os.pipe()
        try:
            with self._log.open("wb") as log:
                self._process = subprocess.Popen(
                    [sys.executable, "-c", _TIED, *words, "--record", str(recording), "--json"],
                    stdin=tether,
                    stdout=subprocess.PIPE,
                    stderr=log,
                    start_new_session=True,
                    env={**os.environ, HELD_VARIABLE: str(lock)},
                )
        except BaseException:
            os.close(self._held)
            raise
        finally:
            os.close(tether)

    def pause(self) -> None:
        """Pause the mission.

        Raises:
            NotRunningError: It has not begun, or has ended.
        """
        send(self.recording, "pause", by=BY)

    def go_on(self) -> None:
        """Let it go on.

        Raises:
            NotRunningError: It has not begun, or has ended.
        """
        send(self.recording, "resume", by=BY)

    def stop(self) -> None:
        """Stop it in order; one that does not is stopped at once, and ended if need be."""
        if self._stopped_s is None:
            self._stopped_s = time.monotonic()
            self._ask("stop", signal.SIGTERM)

    def emergency_stop(self) -> None:
        """Stop it at once."""
        self._stopped_s = self._stopped_s or time.monotonic()
        if self._at_once_s is None:
            self._at_once_s = time.monotonic()
            self._ask("emergency_stop", signal.SIGTERM)

    def watch(self) -> bool:
        """Return whether it still runs; enforce the times of a stop meanwhile."""
        if self._process.poll() is not None:
            return False
        now_s = time.monotonic()
        if self._at_once_s is not None and now_s - self._at_once_s > END_S:
            self._signal(signal.SIGKILL)
        elif self._stopped_s is not None and now_s - self._stopped_s > STOP_S:
            self.emergency_stop()
        return True

    def report(self) -> tuple[RunReport | None, str]:
        """Return what it came to; where it says nothing, None and its last words."""
        assert self._process.stdout is not None
        with self._process, self._process.stdout:
            said = self._process.stdout.read().decode(errors="replace").strip()
        os.close(self._held)
        try:
            report = RunReport.model_validate_json(said.splitlines()[-1] if said else "")
        except ValidationError:
            return None, self._last_words()
        return report, ""

    def _last_words(self) -> str:
        code = self._process.returncode
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        with suppress(OSError):
            text = self._log.read_text(encoding="utf-8", errors="replace").strip()
            return f"its process ended with {how}: {text[-_LAST_WORDS:]}".rstrip(": ")
        return f"its process ended with {how}"

    def _ask(self, command: Literal["stop", "emergency_stop"], number: signal.Signals) -> None:
        try:
            send(self.recording, command, by=BY)
        except NotRunningError:  # it has not begun, or hangs
            self._signal(number)
        except InputError:  # the cell raised: the mission ends all the same
            return

    def _signal(self, number: signal.Signals) -> None:
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, number)
