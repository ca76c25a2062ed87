"""Hold crossing classifiers to fresh scenes: temperature of ours, figures of both."""

import numpy as np
import torch
from torch import Tensor, nn

from perception.cable.classifiers.thesis import corrected
from perception.training.calibration import figures, fit_temperature
from perception.training.crossing import CrossingTask
from perception.training.thesis_crossing import ThesisCrossingTask

FIT_SEED, MEASURE_SEED = 910_001, 920_001
BATCH = 128


@torch.inference_mode()
def calibrate_crossing(network: nn.Module, batches: int) -> tuple[float, dict[str, float]]:
    """Return temperature and figures of a network that sees ribbons."""
    on_top, _, _ = _crossing_logits(network, FIT_SEED, batches)
    temperature = fit_temperature(on_top)
    on_top, crosses, real = _crossing_logits(network, MEASURE_SEED, batches)
    belief = torch.sigmoid(on_top / temperature).double().numpy()
    confidence, right = np.maximum(belief, 1.0 - belief), (belief > 0.5).astype(float)
    belief = torch.sigmoid(crosses).double().numpy()
    sure, known = np.maximum(belief, 1.0 - belief), ((belief > 0.5) == real.numpy()).astype(float)
    doubts = {f"real_{name}": value for name, value in figures(sure, known).items()}
    return temperature, figures(confidence, right) | doubts


def _crossing_logits(network: nn.Module, seed: int, batches: int) -> tuple[Tensor, Tensor, Tensor]:
    """Return logits of the upper strand at crossings, and of "they cross" with its truth."""
    stream = CrossingTask(times=1).batches(seed, 0, 1, BATCH)
    drawn = [next(stream) for _ in range(batches)]
    logits = torch.cat([network(batch[0]).float() for batch in drawn])
    real = torch.cat([batch[1] for batch in drawn]) > 0.5
    return logits[real, 0], logits[:, 1], real


@torch.inference_mode()
def calibrate_thesis(network: nn.Module, batches: int) -> tuple[float, dict[str, float]]:
    """Return 1, as the thesis has no temperature, and figures after its correction."""
    stream = ThesisCrossingTask().batches(MEASURE_SEED, 0, 1, BATCH)
    scores = [
        torch.sigmoid(network(next(stream)[0].flatten(0, 1)).double()).view(-1, 2)
        for _ in range(batches)
    ]
    beliefs = np.array([corrected(first, second) for first, second in torch.cat(scores).tolist()])
    confidence = np.maximum(beliefs, 1.0 - beliefs)
    return 1.0, figures(confidence, (beliefs > 0.5).astype(float))
