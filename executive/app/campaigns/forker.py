"""The process that runs missions: it has loaded what they need, and forks once for each.

So a run begins in milliseconds and has a process of its own: what it leaves in memory goes with
it, and one that hangs, takes too much or dies loses only itself. The process of the first run
that ends in order stays and forks the later ones, since it has loaded all that a run needs:
modules, compiled kernels, networks. Reads a line of JSON a run on standard input, and writes one
for each on standard output; started by `RunProcess`.
"""

import gc
import os
import select
import signal
import socket
import sys
import threading
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import IO, NoReturn

from executive.app.campaigns.jobs import Assignment, Ending, Job, RunRecord
from executive.app.campaigns.one_run import lost, run_job
from executive.app.missions import load
from executive.core.errors import InputError
from executive.engine.faults.processes import GRACE_S
from executive.engine.faults.tether import TETHER, tie_to_stdin
from executive.engine.loading.loader import Mission
from executive.engine.recording.messages import (
    MissionHeader,
    ResultMessage,
    TickMessage,
    schema_of,
)
from executive.engine.running.mission_run import versions

POLL_S = 0.1
_STAYS = b"\nstays"
_OOM_SCORE = Path("/proc/self/oom_score_adj")
_STDIN = 0
_PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


class Forker:
    """Runs missions one after the other, each in a child of this process."""

    def __init__(self, mission: Mission, assignment: Assignment, answers: IO[str]) -> None:
        """Know what is run, and where answers go."""
        self._mission, self._assignment, self._answers = mission, assignment, answers
        self._warm = False

    def serve(self, lines: Iterable[str]) -> None:
        """Run a mission for each line, until a child has taken over or the lines end."""
        for line in lines:
            job, began_s = Job.model_validate_json(line), time.monotonic()
            readable, writable = os.pipe()
            pid = os.fork()
            if pid == 0:
                os.close(readable)
                self._be_child(job, writable, lines)
            os.close(writable)
            try:
                data, ending = self._awaited(pid, readable, began_s)
            finally:
                os.close(readable)
            stays = ending is None and data.endswith(_STAYS)
            code, peak_mb = (0, _peak_mb(pid)) if stays else _reaped(pid)
            record = self._record(job, data.removesuffix(_STAYS), ending, code)
            self._answer(record, time.monotonic() - began_s, peak_mb)
            if stays:
                os.waitpid(pid, 0)
                return

    def _be_child(self, job: Job, writable: int, lines: Iterable[str]) -> NoReturn:
        code = 1
        try:
            os.setpgid(0, 0)  # with all that it starts, to be ended together
            tie_to_stdin()
            usual = _be_first_to_go()
            with os.fdopen(writable, "wb") as pipe:
                record = run_job(self._mission, self._assignment, job)
                stays = not self._warm and _is_alone()
                pipe.write(record.model_dump_json().encode() + (_STAYS if stays else b""))
            if stays:
                self._take_over(usual, lines)
            code = 0
        finally:
            # Not `sys.exit`: what the parent has registered to be done at its end is not ours.
            os._exit(code)

    def _take_over(self, usual: str, lines: Iterable[str]) -> None:
        """Fork the later runs from this process, which has run one."""
        _go_last_again(usual)
        gc.collect()
        gc.freeze()  # collecting would write to pages that children share
        self._warm = True
        self.serve(lines)

    def _awaited(self, pid: int, readable: int, began_s: float) -> tuple[bytes, Ending | None]:
        """Read what a child answers; end it when it goes beyond its limits."""
        data, limit_s = b"", self._assignment.wall_s
        ending: Ending | None = None
        asked_s = 0.0
        while True:
            ready, _, _ = select.select([readable], [], [], POLL_S)
            if ready:
                more = os.read(readable, 1 << 16)
                if not more:
                    return data, ending
                data += more
            elif ending is not None:
                if time.monotonic() - asked_s > GRACE_S:
                    _kill(pid, signal.SIGKILL)
            elif time.monotonic() - began_s > limit_s:
                ending, asked_s = "overdue", time.monotonic()
                _kill(pid, signal.SIGTERM)
            elif self._takes_too_much(pid):
                ending, asked_s = "out of memory", time.monotonic()
                _kill(pid, signal.SIGKILL)

    def _takes_too_much(self, pid: int) -> bool:
        limit_mb = self._assignment.memory_mb
        return limit_mb is not None and _resident_mb(pid) > limit_mb

    def _record(self, job: Job, data: bytes, ending: Ending | None, code: int) -> RunRecord:
        if ending == "out of memory":
            said = f"took more than {self._assignment.memory_mb:g} MB"
            return lost(job, ending, said, self._assignment)
        if ending == "overdue":
            said = f"took more than {self._assignment.wall_s:g} s here"
            return lost(job, ending, said, self._assignment)
        if code != 0 or not data:
            return lost(job, "died", _exit_words(code), self._assignment)
        return RunRecord.model_validate_json(data)

    def _answer(self, record: RunRecord, wall_s: float, peak_mb: float) -> None:
        """Say what a run came to."""
        told = {"wall_s": wall_s, "peak_mb": peak_mb, "host": socket.gethostname()}
        self._answers.write(record.model_copy(update=told).model_dump_json() + "\n")
        self._answers.flush()


def _reaped(pid: int) -> tuple[int, float]:
    """Return a child's exit code and the most memory it had [MB], once all of it has ended."""
    os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
    _kill(pid, signal.SIGKILL)  # what it has left behind
    _, status, usage = os.wait4(pid, 0)
    return os.waitstatus_to_exitcode(status), usage.ru_maxrss / 1024.0


def _is_alone() -> bool:
    """Whether a run has left neither threads nor processes, whose locks a fork would keep."""
    tasks = list(Path("/proc/self/task").iterdir())
    threads = [one for one in threading.enumerate() if one.name != TETHER]
    children = [(task / "children").read_text(encoding="ascii") for task in tasks]
    return len(threads) == 1 and len(tasks) == 2 and not any(children)


def _peak_mb(pid: int) -> float:
    """Return the most memory that a live process has had [MB]."""
    with suppress(OSError):
        for line in Path(f"/proc/{pid}/status").read_text(encoding="ascii").splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1024.0
    return 0.0


def _resident_mb(pid: int) -> float:
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    except (OSError, IndexError):  # it has just ended
        return 0.0
    return pages * _PAGE_BYTES / 2**20


def _be_first_to_go() -> str:
    """Let the system end this process before others when memory runs out; return how it was."""
    usual = ""
    with suppress(OSError):
        usual = _OOM_SCORE.read_text(encoding="ascii")
        _OOM_SCORE.write_text("1000", encoding="ascii")
    return usual


def _go_last_again(usual: str) -> None:
    with suppress(OSError):
        _OOM_SCORE.write_text(usual, encoding="ascii")


def _kill(pid: int, number: signal.Signals) -> None:
    for end in (os.killpg, os.kill):  # the group may not be there yet
        with suppress(ProcessLookupError, PermissionError):
            end(pid, number)
            return


def _exit_words(code: int) -> str:
    if code < 0:
        name = signal.Signals(-code).name
        return f"its process was ended by {name}"
    return f"its process ended with exit code {code}"


def _loaded(assignment: Assignment) -> Mission:
    """Load the mission, as it was when the campaign began.

    Raises:
        InputError: It has faults, or is another one than it was.
    """
    os.chdir(assignment.directory)
    os.environ["CELLWRIGHT_PATH"] = assignment.path
    mission = load(assignment.mission)
    for source in mission.sources:
        if assignment.sources.get(str(Path(source.file).resolve())) != source.sha256:
            raise InputError(
                f"{source.file}: is not what it was when the campaign began; try another --out"
            )
    if not Path(assignment.folder).is_dir():
        raise InputError(
            f"{assignment.folder}: cannot be seen from {socket.gethostname()}; expected a folder "
            "that all workers share"
        )
    return mission


def _prepare_recordings() -> None:
    """Make what every recording needs, and what takes longer than a short run to make."""
    versions()
    for kind in (MissionHeader, TickMessage, ResultMessage):
        schema_of(kind)


def main() -> None:
    """Serve until standard input ends."""
    # Answers go where standard output was; what libraries print goes to standard error.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    lines = os.fdopen(os.dup(_STDIN), "r", encoding="utf-8")
    assignment = Assignment.model_validate_json(lines.readline())
    try:
        _prepare_recordings()
        forker = Forker(_loaded(assignment), assignment, answers)
    except (InputError, OSError) as error:
        sys.exit(str(error))
    answers.write("ready\n")
    answers.flush()
    forker.serve(lines)


if __name__ == "__main__":
    main()
