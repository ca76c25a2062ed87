"""Measure a spatial network on fresh shelves: `python -m perception.training.spatial_measure DIR`.

There is nothing to calibrate: as in LAX-RAY, what it tells is no probability.
"""

import argparse
import json
from collections.abc import Sequence
from itertools import islice
from pathlib import Path

import torch
from safetensors.torch import save_file

from perception.models.store import load_network
from perception.training.loop import Batch
from perception.training.thesis_spatial import ThesisSpatialTask, likeness

MEASURE_SEED = 920_001
BATCH = 64


@torch.inference_mode()
def measured(folder: Path, batches: int) -> dict[str, float]:
    """Return how well a version tells distributions along the shelf; writes its golden answer."""
    network = load_network(folder)
    looks: list[Batch] = list(
        islice(ThesisSpatialTask().batches(MEASURE_SEED, 0, 1, BATCH), batches)
    )
    told = torch.cat([network(inputs) for inputs, _ in looks])
    alike = likeness(told, torch.cat([roots for _, roots in looks]))
    inputs = looks[0][0][:1].contiguous()
    golden = {"inputs": inputs, "answer": told[:1].contiguous()}
    save_file(golden, folder / "golden.safetensors")
    return {
        "measure_seed": MEASURE_SEED,
        "n": len(alike.overlap),
        "right": float(alike.best_right.mean()),
        "overlap": float(alike.overlap.mean()),
    }


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, and write the figures."""
    parser = argparse.ArgumentParser(prog="python -m perception.training.spatial_measure")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--batches", type=int, default=16)
    options = parser.parse_args(arguments)
    path: Path = options.folder / "metrics.json"
    metrics = json.loads(path.read_text())
    metrics["calibration"] = measured(options.folder, options.batches)
    path.write_text(json.dumps(metrics, indent=2) + "\n")


if __name__ == "__main__":
    main()
