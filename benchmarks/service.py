"""A service under load: errors, lost commands, what it costs the ticks, and how it stops.

A mission that only waits runs in the simulated table cell. Its tick rate while 50 clients flood
the service is held against the mean of those right before and right after, since a shared machine
drifts: once at 100 ticks a second, as a cell's own clock has them, and once as fast as the
simulation goes, where physics keeps a core busy with the same work in every tick and clients and
service share what is left. Stops are
of untangling missions whose arms move: from the request until the mission has ended, and, on the
cell's clock, from the last tick until every joint rests. The bound is that of the joints' limits:
acceleration ended, full speed braked, rest.
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

import numpy as np

from benchmarks.harness import Row, median, percentile_95, share
from executive.engine.recording.reader import Recording
from robots.limits import TIME_TO_FULL_ACCELERATION_S, TIME_TO_FULL_SPEED_S

CLIENTS = 50
QUIET_S = 1.5
REST_RAD_S = 1e-3
BOUND_S = TIME_TO_FULL_SPEED_S + 2.0 * TIME_TO_FULL_ACCELERATION_S
IDLE = """
format: 1
mission: idle
cell: yumi_table
tick_hz: 100.0
root: {wait: 1000000.0}
"""
_PATIENCE_S = 300.0


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Flood a service with 20,000 requests, and stop it 10 times."""
    floods, each, stops = (2, 20, 1) if quick else (20, 20, 10)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "idle.yaml").write_text(IDLE, encoding="utf-8")
        with _served(folder) as cell:
            paced, fast = _floods(cell, floods // 2, each, 1.0), _floods(cell, floods // 2, each)
            return [*_answers(paced + fast), *_rates(paced, fast), *_stops(cell, stops, seed)]


class _Cell:
    """A service, as its client sees it."""

    def __init__(self, port: int, folder: Path) -> None:
        self.port, self.folder = port, folder

    def ask(self, verb: str, path: str, body: object = None) -> Any:
        data = None if body is None else json.dumps(body).encode()
        headers = {"content-type": "application/json"} if data else {}
        url = f"http://127.0.0.1:{self.port}{path}"
        with urlopen(Request(url, data, headers, method=verb), timeout=60) as answer:
            return json.load(answer)

    def wait_for(self, state: str, ticks: int = 0) -> None:
        """Wait until the cell is in a state, and its mission has ticked so often."""
        deadline = time.monotonic() + _PATIENCE_S
        while True:
            found = self.ask("GET", "/cell")
            if found["state"] == state and found["ticks"] >= ticks:
                return
            if time.monotonic() > deadline:
                raise RuntimeError(f"never {state}: {found}")
            time.sleep(0.02)


@contextmanager
def _served(folder: Path) -> Iterator[_Cell]:
    cellwright = str(Path(sys.executable).with_name("cellwright"))
    command = [cellwright, "--path", str(folder), "serve", "yumi_table", "--port", "0"]
    with subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        line = process.stderr.readline()
        try:
            yield _Cell(int(line.partition("127.0.0.1:")[2].partition("/")[0]), folder)
        finally:
            process.terminate()
            process.wait(60.0)


@dataclass(frozen=True, slots=True)
class _Flooded:
    """What clients found, how long they took, and the tick rate while they did over that before."""

    found: dict[str, Any]
    took_s: float
    rate: float


def _floods(cell: _Cell, floods: int, each: int, speed: float | None = None) -> list[_Flooded]:
    cell.ask("POST", "/missions", {"mission": "idle", "speed": speed})
    cell.wait_for("running", 20)
    flooded = []
    before, _ = _rate_while(cell, partial(time.sleep, QUIET_S))
    for number in range(floods):
        began_s = time.perf_counter()
        during, found = _rate_while(cell, partial(_flood, cell, each, f"{speed}/{number}"))
        took_s = time.perf_counter() - began_s
        after, _ = _rate_while(cell, partial(time.sleep, QUIET_S))
        flooded.append(_Flooded(found, took_s, 2.0 * during / (before + after)))
        rates = f"{before:.1f}, {during:.1f} and {after:.1f} ticks/s"
        print(f"flood {number}: {rates}", found["wrong"], file=sys.stderr)
        before = after
    cell.ask("POST", "/cell/stop")
    cell.wait_for("held")
    cell.ask("POST", "/cell/resume")
    return flooded


def _answers(floods: Sequence[_Flooded]) -> list[Row]:
    found = [flood.found for flood in floods]
    asked = sum(one["requests"] for one in found)
    wrong, lost = (sum(one[name] for one in found) for name in ("wrongs", "lost"))
    times_ms = [time_ms for one in found for time_ms in one["times_ms"]]
    return [
        share("requests_answered", asked - wrong, asked, "= 1"),
        Row("commands_lost", lost, "1", asked // 5, lost, lost, "= 0"),
        median("requests_per_s", [one.found["requests"] / one.took_s for one in floods], "1/s"),
        percentile_95("request_ms", times_ms, "ms"),
    ]


def _rates(paced: Sequence[_Flooded], fast: Sequence[_Flooded]) -> list[Row]:
    goal = ">= 0.95"
    return [
        median("tick_rate_flooded_over_quiet", [one.rate for one in paced], "1", goal),
        median("tick_rate_flooded_over_quiet_unpaced", [one.rate for one in fast], "1", goal),
    ]


def _rate_while(cell: _Cell, act: Callable[[], Any]) -> tuple[float, Any]:
    """Return the tick rate while something is done, and what that returned."""
    began, began_s = _new_ticks(cell)
    found = act()
    ended, ended_s = _new_ticks(cell)
    return (ended - began) / (ended_s - began_s), found


def _new_ticks(cell: _Cell) -> tuple[int, float]:
    """Return the number of ticks when the service has just counted them, and when that was [s]."""
    known = ticks = cell.ask("GET", "/cell")["ticks"]
    while ticks == known:
        time.sleep(0.002)
        ticks = cell.ask("GET", "/cell")["ticks"]
    return ticks, time.perf_counter()


def _flood(cell: _Cell, each: int, called: str) -> dict[str, Any]:
    words = [str(cell.port), str(CLIENTS), str(each), f"flood {called}"]
    command = [sys.executable, "-m", "benchmarks.service_clients", *words]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found: dict[str, Any] = json.loads(said)
    return found


def _stops(cell: _Cell, stops: int, seed: int) -> list[Row]:
    rng, ended_s, rest_s = np.random.default_rng(seed), [], []
    for number in range(stops):
        asked = {"mission": "untangle", "seed": seed + number}
        mission = cell.ask("POST", "/missions", asked)["id"]
        cell.wait_for("running", int(rng.integers(15, 60)))
        began_s = time.perf_counter()
        cell.ask("POST", "/cell/stop")
        cell.wait_for("held")
        ended_s.append(time.perf_counter() - began_s)
        view = cell.ask("GET", f"/missions/{mission}")
        rest_s.append(_rest_s(Recording.open(cell.folder / view["recording"])))
        cell.ask("POST", "/cell/resume")
    worst = max(rest_s)
    return [
        median("stop_request_to_end_s", ended_s, "s"),
        median("stop_to_rest_s", rest_s, "s"),
        Row("stop_to_rest_worst_s", worst, "s", stops, worst, worst, f"<= {BOUND_S:g}"),
    ]


def _rest_s(recording: Recording) -> float:
    """Return the time from the end of the ticks until all joints rest, on the cell's clock [s]."""
    assert recording.result is not None
    ended_s = recording.tick(0).time_s + recording.result.report.sim_s
    moving_s = ended_s
    for message in recording.streams():
        if message.topic == "/joint_states" and message.time_s > ended_s:
            speeds = json.loads(message.data)["velocities"]
            if max(map(abs, speeds)) > REST_RAD_S:
                moving_s = message.time_s
    return moving_s - ended_s
