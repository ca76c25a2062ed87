"""How much longer than Python itself `cellwright check` and `lint` take, in processor time."""

import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from benchmarks.harness import Row, median

CELLWRIGHT = "from executive.cli.main import main; main()"


def run(quick: bool, _seed: int) -> list[Row]:
    """Measure commands on all trees that ship, paired with a bare start of Python."""
    count = 5 if quick else 21
    trees = str(Path(__file__).parent.parent / "trees")
    return [
        over_python("check_over_python_s", ["check", trees], count, "<= 0.5"),
        over_python("lint_over_python_s", ["lint", trees], count, ""),
        over_python("fmt_check_over_python_s", ["fmt", "--check", trees], count, ""),
    ]


def over_python(name: str, arguments: Sequence[str], count: int, goal: str) -> Row:
    """Return how much more processor time a command takes than `python -c pass`.

    Byte code is kept in a folder of its own, as it is from the second run of a command on.

    Args:
        name: Name of the row.
        arguments: What stands behind `cellwright`.
        count: How many pairs.
        goal: What it should reach.
    """
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": cache}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        for code in ("pass", CELLWRIGHT):  # fills the caches
            _seconds(code, arguments, environment)
        extra = [
            _seconds(CELLWRIGHT, arguments, environment) - _seconds("pass", (), environment)
            for _ in range(count)
        ]
    return median(name, extra, "s", goal)


def _seconds(code: str, arguments: Sequence[str], environment: dict[str, str]) -> float:
    """Return the processor time of one Python process [s]."""
    before = _children_s()
    command = [sys.executable, "-c", code, *arguments]
    ended = subprocess.run(command, capture_output=True, check=False, env=environment)
    if ended.returncode not in (0, 1):  # 1: findings, or files to format
        raise RuntimeError(f"{command}: {ended.stderr.decode()}")
    return _children_s() - before


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
