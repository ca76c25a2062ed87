"""Calibrate a trained version on fresh scenes: `python -m perception.training.calibrate FOLDER`.

Scenes of one seed fit the temperature, scenes of another one are measured on; training saw
neither.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import save_file
from torch import Tensor, nn

from perception.cable.tracers.modes import find_modes
from perception.models.frames import Floats
from perception.models.store import load_network, read_config
from perception.models.tracer_math import step_logits
from perception.training.calibration import figures
from perception.training.crossing import CrossingTask
from perception.training.crossing_calibration import (
    BATCH,
    FIT_SEED,
    MEASURE_SEED,
    calibrate_crossing,
    calibrate_thesis,
)
from perception.training.loop import Task
from perception.training.thesis_crossing import ThesisCrossingTask
from perception.training.tracer import HIT_CROP_PX, TracerTask
from perception.training.tracer_samples import NOWHERE

STEP_TEMPERATURES = tuple(round(0.7 + 0.1 * k, 1) for k in range(14))


def calibrate_tracer(network: nn.Module, batches: int) -> tuple[float, dict[str, float]]:
    """Return temperature and figures of single steps of a tracer network."""
    logits, targets = _tracer_logits(network, FIT_SEED, batches)
    temperature = min(STEP_TEMPERATURES, key=lambda t: _log_loss(*_judged(logits, targets, t)))
    logits, targets = _tracer_logits(network, MEASURE_SEED, batches)
    return temperature, figures(*_judged(logits, targets, temperature))


@torch.inference_mode()
def _tracer_logits(network: nn.Module, seed: int, batches: int) -> tuple[Tensor, Tensor]:
    stream = TracerTask().batches(seed, 0, 1, BATCH)
    logits, targets = [], []
    for _ in range(batches):
        crops, target = next(stream)
        logits.append(step_logits(*network(crops)))
        targets.append(target[:, 0])
    return torch.cat(logits), torch.cat(targets)


def _judged(logits: Tensor, targets: Tensor, temperature: float) -> tuple[Floats, Floats]:
    """Return the belief in the best answer to each crop, and 1 where it is right."""
    beliefs = torch.softmax(logits / temperature, 1).double().numpy()
    answers = [_answer(belief) for belief in beliefs]
    right = [
        place is None if target[0] <= NOWHERE else place is not None and _near(place, target)
        for (_, place), target in zip(answers, targets.double().numpy(), strict=True)
    ]
    return np.array([confidence for confidence, _ in answers]), np.array(right, dtype=float)


def _near(place: Floats, target: Floats) -> bool:
    return float(np.linalg.norm(place - target)) < HIT_CROP_PX


def _log_loss(confidence: Floats, right: Floats) -> float:
    believed = np.where(right > 0.0, confidence, 1.0 - confidence)
    return -float(np.log(believed.clip(1e-6)).mean())


def _answer(belief: Floats) -> tuple[float, Floats | None]:
    """Return the best answer's belief and place; no place for "it ends"."""
    grid = int(np.sqrt(len(belief)))
    modes = find_modes(belief[:-1].reshape(grid, grid), least=0.03, most=3)
    end = float(belief[-1])
    total = end + sum(mode.probability for mode in modes)
    if not modes or end > modes[0].probability:
        return end / max(total, 1e-9), None
    return modes[0].probability / total, modes[0].point_crop


@torch.inference_mode()
def _write_golden(network: nn.Module, name: str, path: Path) -> None:
    """Write one input and its answer, by which a changed runtime shows."""
    tasks: tuple[Task, ...] = (CrossingTask(), ThesisCrossingTask(), TracerTask())
    task = next(task for task in tasks if task.name == name)
    inputs = next(task.batches(MEASURE_SEED, 0, 1, BATCH))[0][:2].contiguous()
    if name == ThesisCrossingTask.name:
        inputs = inputs.flatten(0, 1)
    answer = network(inputs)
    answer = answer if isinstance(answer, Tensor) else answer[0]
    save_file({"inputs": inputs, "answer": answer.contiguous()}, path)


def main(arguments: Sequence[str] | None = None) -> None:
    """Fit the temperature, and write it and the figures."""
    parser = argparse.ArgumentParser(prog="python -m perception.training.calibrate")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--batches", type=int, default=40)
    options = parser.parse_args(arguments)
    folder: Path = options.folder
    config = read_config(folder)
    ways = {
        CrossingTask.name: calibrate_crossing,
        ThesisCrossingTask.name: calibrate_thesis,
        TracerTask.name: calibrate_tracer,
    }
    temperature, measured = ways[config.network](load_network(folder), options.batches)
    _write_golden(load_network(folder), config.network, folder / "golden.safetensors")
    changed = config.model_copy(update={"temperature": temperature})
    (folder / "config.json").write_text(changed.model_dump_json(indent=2) + "\n")
    path = folder / "metrics.json"
    metrics = json.loads(path.read_text())
    metrics["calibration"] = {"fit_seed": FIT_SEED, "measure_seed": MEASURE_SEED, **measured}
    path.write_text(json.dumps(metrics, indent=2) + "\n")


if __name__ == "__main__":
    main()
