"""What speaks for ends of cables, fitted: who sees them, and the tracer that looks outwards.

A mask has dead ends that are no ends, most of all where a cable turns back within its own width.
Drawn scenes, in which such places are frequent, say how far each witness is to be believed.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit

from perception.cable.eyes import Eye
from perception.cable.tracers.outward import EndWeights, witnesses
from perception.cable.tracers.posterior import view_at
from perception.cable.tracers.steps import StepModel
from perception.models.frames import Floats, scale_image
from perception.models.tracer_crop import WIDTH
from perception.training.calibration import expected_calibration_error
from perception.training.sight_calibration import NEAR_WIDTHS, SIZE_PX
from perception.training.sight_scenes import draw_truth

FIT_SEED, MEASURE_SEED = 971_001, 981_001
HAIRPINS = 0.3
PRIOR = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class SeenEnds:
    """Ends that were seen in some scenes.

    Attributes:
        told: Log odds by each witness, shape (N, 2).
        right: 1 where it is an end, shape (N,).
    """

    told: Floats
    right: Floats


def seen_ends(model: StepModel, eye: Eye, seed: int, scenes: int) -> SeenEnds:
    """Look at scenes of a seed, and hold what is said of ends against what is true."""
    told, right = [np.zeros((0, 2))], [np.zeros(0)]
    for number in range(scenes):
        truth = draw_truth(np.random.default_rng([seed, number]), SIZE_PX, HAIRPINS)
        ends = eye.endpoints(truth.image)
        view = view_at(eye.observe, truth.image, None)
        if not ends or view is None:
            continue
        near = np.array([truth.near_ends(end.position_px, NEAR_WIDTHS) for end in ends])
        # Nobody asks for ends that are hidden or at the border.
        true = np.asarray(near.any(axis=1))
        asked = ~true | near[:, truth.clear_ends(NEAR_WIDTHS)].any(axis=1)
        scaled = scale_image(truth.image, view.width_px, WIDTH, model.zoom)
        told.append(witnesses(model, scaled, ends)[asked])
        right.append(true[asked].astype(float))
    return SeenEnds(np.vstack(told), np.concatenate(right))


def fit_ends(seen: SeenEnds) -> EndWeights:
    """Return the likeliest weights (logistic regression with a prior that they are small)."""
    table = np.column_stack([np.ones(len(seen.told)), seen.told])

    def loss(flat: Floats) -> float:
        odds = table @ flat
        total = np.logaddexp(0.0, odds) - seen.right * odds
        return float(total.sum() + PRIOR * flat @ flat)

    bounds = [(None, None), (0.0, None), (0.0, None)]
    one, saw, stops = minimize(loss, np.zeros(3), bounds=bounds).x.round(4).tolist()
    return EndWeights(one=one, seen=saw, stops=stops)


def end_figures(seen: SeenEnds, weights: EndWeights) -> dict[str, float]:
    """Return how well beliefs in ends hold."""
    belief = expit(weights.one + seen.told @ (weights.seen, weights.stops))
    answers = ((belief > 0.5) == (seen.right > 0.5)).astype(float)
    return {
        "n": len(belief),
        "right": float(answers.mean()),
        "right_by_sight_alone": float(((seen.told[:, 0] > 0.0) == (seen.right > 0.5)).mean()),
        "calibration_error": expected_calibration_error(np.maximum(belief, 1.0 - belief), answers),
    }
