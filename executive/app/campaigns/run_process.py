"""The process that runs missions, as seen by whoever wants them run."""

import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from typing import IO

from executive.app.campaigns.jobs import Assignment, Job, RunRecord
from executive.app.campaigns.one_run import lost
from executive.core.errors import InputError

_LAST_WORDS = 2000

# Threads of a library do not come along into a forked run, which would wait for them.
_THREADS_OF = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")
_COMMAND = (sys.executable, "-m", "executive.app.campaigns.forker")


class RunProcess:
    """Runs missions one at a time in a process that stays; one that died is started anew."""

    def __init__(self, assignment: Assignment) -> None:
        """Know what is run; nothing is started yet."""
        self._assignment = assignment
        self._live: _Live | None = None

    def run(self, job: Job) -> RunRecord:
        """Run a mission; when its process is lost, that is the outcome.

        Raises:
            InputError: The mission cannot be run there at all.
        """
        self._live = live = self._live or _Live(self._assignment)
        line = live.answer(job.model_dump_json())
        if not line:
            why = live.last_words() or "the process that had started it is gone"
            self.close()
            return lost(job, "died", why, self._assignment)
        return RunRecord.model_validate_json(line)

    def close(self) -> None:
        """End the process, and the run that it has; may be called from any thread."""
        live, self._live = self._live, None
        if live is not None:
            live.end()


class _Live:
    """One process of `forker`, and a file of what it says on standard error."""

    def __init__(self, assignment: Assignment) -> None:
        # Appended to by several processes, so that it can be emptied in between.
        self._said: IO[str] = tempfile.TemporaryFile("a+", encoding="utf-8", errors="replace")  # noqa: SIM115 - closed by `end`
        self._process = subprocess.Popen(
            _COMMAND,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
            text=True,
            start_new_session=True,
            env={**os.environ, **dict.fromkeys(_THREADS_OF, "1")},
        )
        if self.answer(assignment.model_dump_json()) != "ready\n":
            self._process.wait()
            why = self.last_words() or "the process for runs did not start"
            self.end()
            raise InputError(why)

    def answer(self, line: str) -> str:
        """Send a line and return the one that answers, `""` where the process is gone."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(OSError, ValueError):  # it died, or another thread has ended it
            self._said.truncate(0)
            self._process.stdin.write(f"{line}\n")
            self._process.stdin.flush()
            return self._process.stdout.readline()
        return ""

    def last_words(self) -> str:
        """Return the end of what it has said on standard error."""
        with suppress(OSError, ValueError):
            self._said.seek(0)
            return self._said.read().strip()[-_LAST_WORDS:]
        return ""

    def end(self) -> None:
        """End it, and the run that it has: both do so when their standard input ends."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(OSError):
            self._process.stdin.close()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(5.0)
        self._process.kill()
        self._process.wait()
        self._process.stdout.close()
        self._said.close()
