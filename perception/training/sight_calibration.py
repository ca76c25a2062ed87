"""Calibrate a trained detector: `python -m perception.training.sight_calibration FOLDER`.

Whole scenes of one seed fit how likely ends are, scenes of another one are measured on;
training saw neither.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import save_file
from scipy.optimize import minimize
from scipy.special import logit

from perception.cable.sight.reading import ReadingConfig
from perception.cable.sight.seen import Seen
from perception.cable.sight.sight import Sight
from perception.models.frames import Floats
from perception.models.sight_input import prepare
from perception.models.store import load_network, read_config
from perception.training.calibration import expected_calibration_error, selective_error
from perception.training.sight_scenes import SightTruth, draw_truth

FIT_SEED, MEASURE_SEED = 910_001, 920_001
SIZE_PX = (480, 640)
NEAR_WIDTHS = 1.5
# What is hardly an end is of no use for telling how likely ends are.
LEAST_END = 0.03
GOLDEN_SIDE = 96


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """Ends claimed in some scenes, and what else was seen.

    Attributes:
        beliefs: Belief in each claimed end, shape (N,).
        right: 1 where it is one, shape (N,).
        wanted: How many ends there are.
        overlaps: Intersection over union of the masks, one a scene.
        width_errors: Relative errors of the width, one a scene with cable.
    """

    beliefs: Floats
    right: Floats
    wanted: int
    overlaps: Floats
    width_errors: Floats


def judge(sight: Sight, seed: int, scenes: int) -> Judged:
    """Look at scenes of a seed, and hold what is seen against what is true."""
    beliefs: list[float] = []
    right: list[float] = []
    wanted = 0
    overlaps, errors = [], []
    for number in range(scenes):
        truth = draw_truth(np.random.default_rng([seed, number]), SIZE_PX)
        seen = sight.look(truth.image)
        clear = truth.clear_ends(NEAR_WIDTHS)
        wanted += int(clear.sum())
        for end in seen.endpoints:
            near = truth.near_ends(end.position_px, NEAR_WIDTHS)
            # Nobody asks for ends that are hidden or at the border.
            if not near.any() or clear[near].any():
                beliefs.append(end.probability)
                right.append(float(near.any()))
        overlaps.append(overlap(seen, truth))
        if seen.width_px is not None and truth.cable.any():
            errors.append(abs(seen.width_px / truth.usual_width_px - 1.0))
    return Judged(np.array(beliefs), np.array(right), wanted, np.array(overlaps), np.array(errors))


def overlap(seen: Seen, truth: SightTruth) -> float:
    """Return intersection over union; 1 where nothing is and nothing is seen."""
    either = int((seen.cable_pixels | truth.shown).sum())
    return int((seen.cable_pixels & truth.shown).sum()) / either if either else 1.0


def fit(judged: Judged) -> tuple[float, float]:
    """Return temperature and bias that make beliefs as high as answers are often right."""
    logits = logit(judged.beliefs.clip(1e-6, 1.0 - 1e-6))

    def loss(values: Floats) -> float:
        scaled = logits * np.exp(values[0]) + values[1]
        return float(np.mean(np.logaddexp(0.0, scaled) - judged.right * scaled))

    slope, bias = minimize(loss, np.zeros(2), method="Nelder-Mead").x
    return round(float(np.exp(-slope)), 3), round(float(bias), 3)


def figures(judged: Judged) -> dict[str, float]:
    """Return what a card tells."""
    sure = judged.beliefs > ReadingConfig().least_end
    # The answer to each place is the likelier one of "an end" and "none".
    confidence = np.maximum(judged.beliefs, 1.0 - judged.beliefs)
    answers = ((judged.beliefs > 0.5) == (judged.right > 0.5)).astype(float)
    return {
        "n": judged.wanted,
        "ends_found": float(judged.right[sure].sum()) / judged.wanted,
        "ends_right": float(judged.right[sure].mean()),
        "calibration_error": expected_calibration_error(confidence, answers),
        "error_of_surest_80": selective_error(confidence, answers),
        "mask_iou": float(judged.overlaps.mean()),
        "width_error": float(np.median(judged.width_errors)),
    }


@torch.inference_mode()
def _write_golden(folder: Path) -> None:
    """Write one input and its answer, by which a changed runtime shows."""
    truth = draw_truth(np.random.default_rng([MEASURE_SEED, 0]), (GOLDEN_SIDE, GOLDEN_SIDE))
    inputs = torch.from_numpy(prepare(truth.image))[None]
    cable, grid = load_network(folder)(inputs)
    tensors = {"inputs": inputs, "answer": cable.contiguous(), "grid": grid.contiguous()}
    save_file(tensors, folder / "golden.safetensors")


def main(arguments: Sequence[str] | None = None) -> None:
    """Fit temperature and bias, and write them and the figures."""
    parser = argparse.ArgumentParser(prog="python -m perception.training.sight_calibration")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scenes", type=int, default=200)
    options = parser.parse_args(arguments)
    folder: Path = options.folder
    everything = ReadingConfig(least_end=LEAST_END)
    plain = read_config(folder).model_copy(update={"temperature": 1.0, "bias": 0.0})
    (folder / "config.json").write_text(plain.model_dump_json(indent=2) + "\n")
    temperature, bias = fit(judge(Sight(folder, everything), FIT_SEED, options.scenes))
    changed = plain.model_copy(update={"temperature": temperature, "bias": bias})
    (folder / "config.json").write_text(changed.model_dump_json(indent=2) + "\n")
    measured = figures(judge(Sight(folder, everything), MEASURE_SEED, options.scenes))
    _write_golden(folder)
    path = folder / "metrics.json"
    metrics = json.loads(path.read_text())
    metrics["calibration"] = {"fit_seed": FIT_SEED, "measure_seed": MEASURE_SEED, **measured}
    path.write_text(json.dumps(metrics, indent=2) + "\n")


if __name__ == "__main__":
    main()
