"""How fast campaigns are: missions an hour, overhead over a bare loop.

The mission is `untangle` for a few seconds of the robot's clock. A bare loop runs it over and
over in one process that has everything loaded; a campaign runs the same seeds right after it,
in blocks, so that a noisy machine slows both. What starts once (Dask, the process for runs) is
not counted: runs are timed from the end of the first one. `cpu` is the time that all processes
of the campaign have on the cores, over that of the bare loop: the noise of other work is not
in it. Two workers cannot give twice the missions where the cores are busy with other work.
"""

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import psutil

from benchmarks.campaign_missions import bare_loop, campaign, seconds
from benchmarks.harness import Row, median
from executive.app.campaigns.campaign import Where

MISSION = "untangle"
BLOCK = 4
"""Missions that are timed together."""

WARM = 10**6
"""Seed of the run that is not timed."""


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Time blocks, then throughput."""
    blocks, runs, length_s = (2, 4, 2.0) if quick else (6, 12, 6.0)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows = _overhead(folder, seed, blocks, length_s)
        for where, called in ((Where(1), "1_worker"), (Where(2), "2_workers")):
            rows.append(_throughput(folder / called, seed, runs, length_s, where))
        with dask_cluster() as address:
            where = Where(scheduler=address)
            rows.append(_throughput(folder / "cluster_of_2", seed, runs, length_s, where))
        return rows


def _overhead(folder: Path, seed: int, blocks: int, length_s: float) -> list[Row]:
    loop = bare_loop(MISSION, folder / "bare.mcap", length_s)
    bare_s, walls, cpus = [], [], []
    for block in range(blocks):
        first = seed + block * BLOCK
        seeds = range(first, first + BLOCK)
        began_cpu_s = time.process_time()
        wall_s = seconds(partial(_each, loop, seeds))
        cpu_s = time.process_time() - began_cpu_s
        one = campaign(MISSION, (WARM, *seeds), folder / f"b{block}", timeout_s=length_s)
        records = one.run(Where(1))
        next(records)  # what starts once
        before_cpu_s, before_s = _all_cpu_s(), time.perf_counter()
        for _ in range(BLOCK):
            next(records)
        bare_s.append(wall_s / BLOCK)
        walls.append((time.perf_counter() - before_s) / wall_s)
        cpus.append((_all_cpu_s() - before_cpu_s) / cpu_s)
        records.close()
    return [
        median("bare_mission_s", bare_s, "s"),
        median("campaign_over_bare", walls, "1", "<= 1.05"),
        median("campaign_over_bare_cpu", cpus, "1", "<= 1.05"),
    ]


def _each(act: Callable[[int], None], seeds: range) -> None:
    for number in seeds:
        act(number)


def _all_cpu_s() -> float:
    """Return the time on the cores of this process, its children, and those they have ended."""
    this = psutil.Process()
    times = [one.cpu_times() for one in (this, *this.children(recursive=True))]
    ended = [one.children_user + one.children_system for one in times[1:]]
    return float(sum(one.user + one.system for one in times) + sum(ended))


def _throughput(folder: Path, seed: int, runs: int, length_s: float, where: Where) -> Row:
    one = campaign(MISSION, range(seed, seed + runs), folder, timeout_s=length_s)
    ends_s = []
    for record in one.run(where):
        if record.outcome in ("died", "overdue", "error"):
            raise RuntimeError(f"{record.name}: {record.outcome}: {record.reason}")
        ends_s.append(time.perf_counter())
    # Halves of the campaign, so that the row has a spread.
    middle, name = len(ends_s) // 2, f"missions_per_hour_{folder.name}"
    rates = [_rate(ends_s[: middle + 1]), _rate(ends_s[middle:])]
    return Row(name, _rate(ends_s), "1/h", runs - 1, min(rates), max(rates))


def _rate(ends_s: Sequence[float]) -> float:
    return 3600.0 * (len(ends_s) - 1) / (ends_s[-1] - ends_s[0])


@contextmanager
def dask_cluster(workers: int = 2) -> Iterator[str]:
    """Start a scheduler and workers as a user would, on loopback; yield its address."""
    dask = str(Path(sys.executable).with_name("dask"))
    port = _free_port()
    address = f"tcp://127.0.0.1:{port}"
    local = ["--host", "127.0.0.1", "--no-dashboard"]
    commands = [[dask, "scheduler", *local, "--port", str(port)]]
    commands += [[dask, "worker", address, *local, "--nthreads", "1"]] * workers
    with tempfile.TemporaryFile() as said:
        running = [subprocess.Popen(one, stdout=said, stderr=said) for one in commands]
        try:
            _wait_for(address, workers)
            yield address
        finally:
            for process in reversed(running):
                process.terminate()
            for process in running:
                process.wait(30.0)


def _wait_for(address: str, workers: int) -> None:
    from distributed import Client

    with Client(address, timeout="60s") as client:
        client.wait_for_workers(workers, timeout=120.0)


def _free_port() -> int:
    import socket

    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port: int = one.getsockname()[1]
        return port
