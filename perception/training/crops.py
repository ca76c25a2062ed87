"""What networks see, on disk: samples of a task as arrays, with pictures of them."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from perception.training.dataset import SHEET, encoded
from perception.training.sheets import contact_sheet
from perception.training.tasks import load_task

ARRAYS, INDEX = "crops.npz", "crops.json"
ON_SHEET, BATCH = 40, 32
# What the tensors of a task's batches are, in their order.
ABOUT: Mapping[str, Mapping[str, str]] = {
    "tracer": {
        "crops": "grey, recent path, whole path",
        "targets": "(x, y) after 1, 2, 3 steps [crop units], -1000 where the cable has ended",
    },
    "crossing": {
        "ribbons": "of both strands, the upper one first",
        "crosses": "1 where strands really cross there, 0 where they do not",
    },
    "sight": {
        "images": "grey values as the network takes them",
        "cable": "1 where a pixel shows cable",
        "grid": "targets on the network's grid",
    },
    "thesis-crossing": {"visits": "of both strands, the upper one first"},
    "thesis-spatial": {
        "looks": "depth, whether it is known, sizes of the target, places",
        "roots": "of the share of poses that would show in a pixel, over 0.02",
    },
}


def write_crops(task: str, seed: int, count: int, folder: Path) -> None:
    """Write samples of a task: arrays, what they mean, and a contact sheet.

    Args:
        task: One of `perception.training.tasks.TASKS`.
        seed: Of all samples.
        count: How many.
        folder: Where to.

    Raises:
        InputError: There is no such task.
        OSError: A file cannot be written.
    """
    batches = load_task(task).batches(seed, 0, 1, min(BATCH, count))
    parts: list[tuple[torch.Tensor, ...]] = []
    while sum(len(part[0]) for part in parts) < count:
        parts.append(next(batches))
    columns = [torch.cat(column)[:count].numpy() for column in zip(*parts, strict=True)]
    arrays = dict(zip(ABOUT[task], columns, strict=True))
    folder.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(folder / ARRAYS, allow_pickle=False, **arrays)
    tiles = [picture(sample) for sample in columns[0][:ON_SHEET]]
    (folder / SHEET).write_bytes(encoded(contact_sheet(tiles)))
    index = {
        "format": 1,
        "task": task,
        "seed": seed,
        "count": count,
        "arrays": {
            name: {"about": about, "shape": list(arrays[name].shape)}
            for name, about in ABOUT[task].items()
        },
    }
    (folder / INDEX).write_text(json.dumps(index, indent=2) + "\n")


def picture(sample: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return the channels of a sample side by side, each from black to white."""
    layers = sample.reshape(-1, *sample.shape[-2:])
    low = layers.min(axis=(1, 2), keepdims=True)
    spread = np.maximum(layers.max(axis=(1, 2), keepdims=True) - low, 1e-6)
    scaled = (255.0 * (layers - low) / spread).astype(np.uint8)
    return np.hstack([*scaled])
