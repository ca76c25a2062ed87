"""What differs between two campaigns beyond noise.

Where both have run the same settings with the same seeds, runs are compared in pairs: a seed
that is hard is hard for both. Differences are tested by permutation (R. A. Fisher, The Design
of Experiments, 1935: exact where there are few), which needs no distribution of what is
measured; and since many things are measured at once, a difference counts only if it holds
with Holm's correction (S. Holm, Scandinavian Journal of Statistics, 1979).
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from executive.app.campaigns.figures import measures
from executive.app.campaigns.jobs import RunRecord

ALPHA = 0.05
_RESAMPLES = 9999
_MACHINE = ("wall_s",)
"""Differs between machines and says nothing of the mission: shown, never counted."""

Samples = NDArray[np.float64]
BySeed = defaultdict[str, defaultdict[int, list[float | bool]]]


@dataclass(frozen=True, slots=True)
class Difference:
    """One measure in two campaigns.

    Attributes:
        name: What is measured.
        a: Its mean, or share, in the first.
        b: In the second.
        low: Lower end of the 95 % interval of b - a.
        high: Upper end.
        n: Number of seeds that are compared in pairs, or of the smaller side.
        p: Chance of such a difference when there is none.
        beyond_noise: Whether it is one, all that is measured considered.
    """

    name: str
    a: float
    b: float
    low: float
    high: float
    n: int
    p: float
    beyond_noise: bool = False


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two campaigns side by side.

    Attributes:
        paired: Whether runs were compared in pairs.
        pairs: Number of runs on each side that have a partner, or of the smaller side.
        left_out: Number of runs that have none.
        differences: One a measure, the first that of success.
    """

    paired: bool
    pairs: int
    left_out: int
    differences: tuple[Difference, ...]


def compare(a: Iterable[RunRecord], b: Iterable[RunRecord]) -> Comparison:
    """Compare two sets of runs; the same sets give the same answer."""
    first, second = list(a), list(b)
    left, right = _by_pair(first), _by_pair(second)
    common = sorted(left.keys() & right.keys())
    if not common and _one_variant(first) and _one_variant(second):
        # Each ran one thing: what was set is what is to be compared.
        left, right = ({("", s): one for (_, s), one in runs.items()} for runs in (left, right))
        common = sorted(left.keys() & right.keys())
    if common:
        pairs = [(seed, left[what, seed], right[what, seed]) for what, seed in common]
        found = _paired(pairs)
        return Comparison(True, len(pairs), len(first) + len(second) - 2 * len(pairs), found)
    return Comparison(False, min(len(first), len(second)), 0, _unpaired(first, second))


def _by_pair(records: Sequence[RunRecord]) -> dict[tuple[str, int], RunRecord]:
    return {(repr(sorted(one.settings.items())), one.seed): one for one in records}


def _one_variant(records: Sequence[RunRecord]) -> bool:
    return len({one.variant for one in records}) == 1


def _paired(pairs: Sequence[tuple[int, RunRecord, RunRecord]]) -> tuple[Difference, ...]:
    """Compare by seed: runs of several variants with one seed are no independent samples."""
    a: BySeed = defaultdict(lambda: defaultdict(list))
    b: BySeed = defaultdict(lambda: defaultdict(list))
    for seed, left, right in pairs:
        of_left, of_right = measures(left), measures(right)
        for name in of_left.keys() & of_right.keys():
            a[name][seed].append(of_left[name])
            b[name][seed].append(of_right[name])
    found = []
    for name in _order(a):
        seeds = sorted(a[name])
        x, y = (np.array([np.mean(side[name][seed]) for seed in seeds]) for side in (a, b))
        found.append(_difference(name, x, y, paired=True))
    return _judged(found)


def _unpaired(a: Sequence[RunRecord], b: Sequence[RunRecord]) -> tuple[Difference, ...]:
    left, right = ([measures(one) for one in side] for side in (a, b))
    names = {name for one in left for name in one} & {name for one in right for name in one}
    found = [
        _difference(
            name,
            np.array([one[name] for one in left if name in one], dtype=float),
            np.array([one[name] for one in right if name in one], dtype=float),
            paired=False,
        )
        for name in _order(names)
    ]
    return _judged(found)


def _order(names: Iterable[str]) -> list[str]:
    return sorted(names, key=lambda name: (name != "success", name))


def _difference(name: str, a: Samples, b: Samples, *, paired: bool) -> Difference:
    from scipy.stats import permutation_test

    n = min(len(a), len(b))
    mean_a, mean_b = float(a.mean()), float(b.mean())
    if (
        n < 2
        or (np.ptp(a) == np.ptp(b) == 0.0 and mean_a == mean_b)
        or not math.isfinite(mean_a + mean_b)
    ):
        p = 1.0
    else:
        p = float(
            permutation_test(
                (b - a,) if paired else (b, a),
                np.mean if paired else _mean_difference,
                permutation_type="samples" if paired else "independent",
                n_resamples=_RESAMPLES,
                rng=np.random.default_rng(0),
                vectorized=True,
            ).pvalue
        )
    low, high = _interval(a, b, paired=paired)
    return Difference(name, mean_a, mean_b, low, high, n, p)


def _mean_difference(x: Samples, y: Samples, axis: int) -> Samples:
    difference: Samples = x.mean(axis=axis) - y.mean(axis=axis)
    return difference


def _interval(a: Samples, b: Samples, *, paired: bool) -> tuple[float, float]:
    """Return the interval of the difference of means (bootstrap, percentiles)."""
    rng = np.random.default_rng(0)
    means = _means(b - a, rng) if paired else _means(b, rng) - _means(a, rng)
    low, high = np.quantile(means, (0.025, 0.975))
    return float(low), float(high)


def _means(values: Samples, rng: np.random.Generator) -> Samples:
    draws = rng.integers(len(values), size=(2000, len(values)))
    means: Samples = values[draws].mean(axis=1)
    return means


def _judged(found: Sequence[Difference]) -> tuple[Difference, ...]:
    """Say which differences hold, with Holm's correction."""
    counted = sorted((one for one in found if one.name not in _MACHINE), key=lambda one: one.p)
    beyond: set[str] = set()
    for place, one in enumerate(counted):
        if one.p * (len(counted) - place) > ALPHA:
            break
        beyond.add(one.name)
    return tuple(replace(one, beyond_noise=one.name in beyond) for one in found)
