"""What the runs of a campaign come to: shares and means with the interval that holds 95 %."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from executive.app.campaigns.jobs import RunRecord

SUCCESS = "success"
Z = 1.959964
"""97.5 % quantile of the normal distribution."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of a set of runs.

    Attributes:
        name: What is measured.
        value: The share or mean.
        low: Lower end of its 95 % interval.
        high: Upper end.
        n: Number of runs that it is made of.
        share: Whether it is a share of runs.
    """

    name: str
    value: float
    low: float
    high: float
    n: int
    share: bool


def measures(record: RunRecord) -> Mapping[str, float | bool]:
    """Return what is measured of one run, by name."""
    return {
        SUCCESS: record.outcome == "success",
        "sim_s": record.sim_s,
        "ticks": float(record.ticks),
        "actions": float(record.actions),
        "wall_s": record.wall_s,
        **record.measures,
    }


def columns(records: Iterable[RunRecord]) -> dict[str, list[float | bool]]:
    """Return what is measured, by name, over all runs that have it."""
    found: dict[str, list[float | bool]] = {}
    for record in records:
        for name, value in measures(record).items():
            found.setdefault(name, []).append(value)
    return found


def figures(records: Iterable[RunRecord]) -> list[Figure]:
    """Return the figures of a set of runs, success first."""
    return [figure(name, values) for name, values in columns(records).items()]


def figure(name: str, values: Sequence[float | bool]) -> Figure:
    """Return the share of what is true or false, the mean of anything else."""
    is_share = all(isinstance(value, bool) for value in values)
    interval = wilson(sum(values), len(values)) if is_share else _mean(values)
    return Figure(name, *interval, len(values), is_share)


def wilson(hits: float, n: int) -> tuple[float, float, float]:
    """Return a share and the ends of its interval (E. B. Wilson, JASA 1927)."""
    p, z2 = hits / n, Z * Z
    centre = (p + z2 / (2 * n)) / (1 + z2 / n)
    half = Z / (1 + z2 / n) * math.sqrt(p * (1 - p) / n + z2 / (4 * n * n))
    return p, max(0.0, centre - half), min(1.0, centre + half)


def _mean(values: Sequence[float | bool]) -> tuple[float, float, float]:
    """Return a mean with the interval of Student's t distribution."""
    from scipy.stats import t

    data = np.asarray(values, dtype=float)
    data = data[np.isfinite(data)]
    if len(data) == 0:
        return math.nan, math.nan, math.nan
    middle = float(data.mean())
    if len(data) == 1:
        return middle, -math.inf, math.inf
    half = float(t.ppf(0.975, len(data) - 1) * data.std(ddof=1) / math.sqrt(len(data)))
    return middle, middle - half, middle + half
