"""What every benchmark gives: rows with n, an interval and a goal, in one JSON form."""

import json
import math
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from executive.app.campaigns.figures import Z, wilson

RESULTS = Path(__file__).parent / "results"


@dataclass(frozen=True, slots=True)
class Row:
    """One figure.

    Attributes:
        name: Stable name; docs/results.md and outside checks use it.
        value: The figure.
        unit: Its unit, `1` for shares and ratios.
        n: How many samples it is made of.
        low: Lower end of the 95 % interval.
        high: Upper end.
        goal: What it should reach, as text with its direction, e.g. `>= 5`; empty for none.
    """

    name: str
    value: float
    unit: str
    n: int
    low: float
    high: float
    goal: str = ""


@dataclass(frozen=True, slots=True)
class Benchmark:
    """A benchmark by name.

    Attributes:
        about: One line for the list.
        run: Takes (quick, seed), returns the rows.
    """

    about: str
    run: Callable[[bool, int], Sequence[Row]]


def share(name: str, hits: int, n: int, goal: str = "") -> Row:
    """Return a share with its Wilson interval."""
    p, low, high = wilson(hits, n)
    return Row(name, p, "1", n, low, high, goal)


def median(name: str, samples: Sequence[float], unit: str, goal: str = "") -> Row:
    """Return a median with its interval from order statistics (binomial, normal approximation)."""
    ordered = np.sort(np.asarray(samples, dtype=float))
    n = len(ordered)
    reach = Z * math.sqrt(n) / 2
    low = ordered[max(0, math.floor(n / 2 - reach))]
    high = ordered[min(n - 1, math.ceil(n / 2 + reach))]
    return Row(name, float(np.median(ordered)), unit, n, float(low), float(high), goal)


def mean(name: str, samples: Sequence[float], unit: str, goal: str = "") -> Row:
    """Return a mean with its interval (normal approximation)."""
    values = np.asarray(samples, dtype=float)
    half = Z * float(values.std(ddof=1)) / math.sqrt(len(values)) if len(values) > 1 else math.inf
    middle = float(values.mean())
    return Row(name, middle, unit, len(values), middle - half, middle + half, goal)


def percentile_95(name: str, samples: Sequence[float], unit: str, goal: str = "") -> Row:
    """Return the 95th percentile with its interval from order statistics."""
    ordered, n = sorted(samples), len(samples)
    reach = Z * math.sqrt(n * 0.95 * 0.05)
    at = [min(n - 1, max(0, round(0.95 * n + step))) for step in (-reach, 0.0, reach)]
    low, value, high = (ordered[i] for i in at)
    return Row(name, value, unit, n, low, high, goal)


def hand_over(name: str, seed: int, quick: bool, rows: Sequence[Row], target: Path | None) -> None:
    """Print the rows of one run, and write its result document where one is wanted."""
    for row in rows:
        spread = f"[{row.low:.3g}, {row.high:.3g}]"
        print(f"{row.name:36} {row.value:10.4g} {row.unit:4} n={row.n:<6} {spread:20} {row.goal}")
    if target is not None:
        target.write_text(document(name, seed, quick, rows), encoding="utf-8")
        print(f"written: {target}", file=sys.stderr)


def document(name: str, seed: int, quick: bool, rows: Sequence[Row]) -> str:
    """Return the result document of one run as JSON."""
    content = {
        "benchmark": name,
        "commit": _commit(),
        "seed": seed,
        "quick": quick,
        "rows": [asdict(row) for row in rows],
    }
    return json.dumps(content, indent=1) + "\n"


def _commit() -> str:
    answer = subprocess.run(
        ["git", "describe", "--always", "--dirty"], capture_output=True, text=True, check=False
    )
    return answer.stdout.strip() or "unknown"
