"""What thousands of missions in one campaign leave in memory: nothing, or they could not go on.

The mission has one node, so that there is little but what the campaign itself keeps. Two workers
run it; every hundredth of the way, the memory of this process and of those that stay is taken.
By the first tenth everything is loaded; the growth is that of the last tenth over the second.
"""

import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import psutil

from benchmarks.campaign_missions import campaign, write_trivial
from benchmarks.harness import Row, median
from executive.app.campaigns.campaign import Where

_MB = 2**20


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Run 10,000 missions (300 when quick) in one campaign."""
    count = 300 if quick else 10_000
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        one = campaign(write_trivial(folder), range(seed, seed + count), folder / "trivial")
        began_s, sizes_mb = time.perf_counter(), []
        for place, _ in enumerate(one.run(Where(2))):
            if place % (count // 100) == 0:
                sizes_mb.append(_all_mb())
        took_s = time.perf_counter() - began_s
        kept = sum(1 for _ in one.folder.records())
    settled = sizes_mb[len(sizes_mb) // 10 :]
    tenth = max(1, len(settled) // 10)
    first, last = (sorted(part)[len(part) // 2] for part in (settled[:tenth], settled[-tenth:]))
    return [
        _exactly("missions_kept", kept, "1", count, f"= {count}"),
        _exactly("missions_per_s", count / took_s, "1/s", count),
        _exactly("memory_growth", last / first, "1", len(settled), "<= 1.05"),
        _exactly("memory_growth_mb", last - first, "MB", len(settled)),
        median("memory_mb", settled, "MB"),
    ]


def _exactly(name: str, value: float, unit: str, n: int, goal: str = "") -> Row:
    return Row(name, value, unit, n, value, value, goal)


def _all_mb() -> float:
    """Return the memory of this process and of those that stay [MB]."""
    this, total = psutil.Process(), 0.0
    for one in (this, *this.children()):
        try:
            total += one.memory_info().rss
        except psutil.NoSuchProcess:
            continue
    return total / _MB
