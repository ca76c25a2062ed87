"""Hold beliefs to what comes true: temperature, and expected calibration error."""

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import softplus

from perception.models.frames import Floats


def fit_temperature(logits: Tensor) -> float:
    """Return what to divide logits of the right answer by, for the least cross-entropy.

    Args:
        logits: Of the answer that is right, against the other one; shape (N,).
    """
    candidates = torch.logspace(-0.7, 0.7, 141)
    losses = [float(softplus(-logits / temperature).mean()) for temperature in candidates]
    return round(float(candidates[int(np.argmin(losses))]), 3)


def expected_calibration_error(confidence: Floats, right: Floats, bins: int = 15) -> float:
    """Return the mean gap between confidence and share of right answers, over equal bins.

    Bins hold equal numbers of answers (adaptive binning, Nixon et al. 2019), as most answers
    are nearly certain.

    Args:
        confidence: Belief in each given answer, shape (N,).
        right: 1 where the answer is right, else 0, shape (N,).
        bins: Number of bins.
    """
    order = np.argsort(confidence, kind="stable")
    gaps = [
        abs(float(confidence[part].mean() - right[part].mean())) * len(part)
        for part in np.array_split(order, bins)
        if len(part)
    ]
    return sum(gaps) / len(confidence)


def selective_error(confidence: Floats, right: Floats, kept: float = 0.8) -> float:
    """Return the share of wrong answers among the surest `kept` of all."""
    order = np.argsort(-confidence, kind="stable")[: max(int(kept * len(confidence)), 1)]
    return float(1.0 - right[order].mean())


def figures(confidence: Floats, right: Floats) -> dict[str, float]:
    """Return number, share of right answers, calibration error and error of the surest 80 %."""
    return {
        "n": len(right),
        "right": float(right.mean()),
        "calibration_error": expected_calibration_error(confidence, right),
        "error_of_surest_80": selective_error(confidence, right),
    }
