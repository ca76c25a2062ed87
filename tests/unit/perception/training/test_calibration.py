import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from perception.training.calibration import (
    expected_calibration_error,
    fit_temperature,
    selective_error,
)


def test_temperature_undoes_overconfidence():
    rng = np.random.default_rng(0)
    honest = rng.normal(0.0, 2.0, 40_000)
    comes_true = rng.random(len(honest)) < 1.0 / (1.0 + np.exp(-honest))
    of_right_answer = torch.from_numpy(np.where(comes_true, honest, -honest))
    assert fit_temperature(3.0 * of_right_answer) == pytest.approx(3.0, rel=0.05)


def test_calibration_error_of_honest_and_of_boastful_beliefs():
    rng = np.random.default_rng(1)
    belief = rng.uniform(0.5, 1.0, 40_000)
    right = (rng.random(len(belief)) < belief).astype(float)
    assert expected_calibration_error(belief, right) < 0.02
    boast = np.ones(len(belief))
    assert expected_calibration_error(boast, right) == pytest.approx(0.25, abs=0.02)


def test_the_surest_answers_are_wrong_less_often():
    confidence = np.array([0.9, 0.95, 0.99, 0.6, 0.97])
    right = np.array([1.0, 1.0, 1.0, 0.0, 1.0])
    assert selective_error(confidence, right) == 0.0
    assert selective_error(confidence, right, kept=1.0) == pytest.approx(0.2)
