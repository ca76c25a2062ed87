import numpy as np
import pytest

pytest.importorskip("torch")

from perception.training.end_evidence import SeenEnds, end_figures, fit_ends


def _seen(rng, count):
    """Return ends that are some as often as weights of 0.5, 1 and 0 say."""
    told = rng.normal(0.0, 2.0, (count, 2))
    right = rng.random(count) < 1.0 / (1.0 + np.exp(-(0.5 + told[:, 0])))
    return SeenEnds(told, right.astype(float))


def test_the_fit_finds_who_is_to_be_believed():
    rng = np.random.default_rng(2)
    weights = fit_ends(_seen(rng, 2000))
    assert (weights.one, weights.seen, weights.stops) == pytest.approx((0.5, 1.0, 0.0), abs=0.2)
    measured = end_figures(_seen(rng, 2000), weights)
    assert measured["calibration_error"] < 0.05
    assert measured["right"] >= measured["right_by_sight_alone"] - 0.02
