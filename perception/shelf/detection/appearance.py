"""What an object may be by its size and colours alone: P(C | I) of the thesis's section 6.2.

It stands where the thesis has ViLD: a linear classifier on what depth and colour tell of a front,
trained on rendered packages.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict
from scipy.optimize import minimize

from executive.core.errors import InputError
from executive.core.json_files import read_json
from perception.rgbd import ColourImage
from perception.shelf.detection.segmenting import STEP_M, ShelfPoints
from perception.shelf.types import Bools, Floats

HUES = 12
# Cloudier than this, or darker, a pixel has no hue to speak of.
LEAST_SATURATION = 0.18
# Weight of the squared weights in training.
PENALTY = 0.02


class _ModelFile(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    format: int
    domain: str
    about: str
    names: tuple[str, ...]
    mean: tuple[float, ...]
    scale: tuple[float, ...]
    weights: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class AppearanceModel:
    """A softmax of features.

    Attributes:
        names: Names of the products, N of them.
        mean: Of each feature in training, shape (F,).
        scale: Standard deviation of each feature in training, shape (F,).
        weights: Shape (F + 1, N); the last row is the bias.
    """

    names: tuple[str, ...]
    mean: Floats
    scale: Floats
    weights: Floats

    def probabilities(self, features: Floats) -> Floats:
        """Return P(name) for each row of features, shape (K, N)."""
        return _softmax(_extended((features - self.mean) / self.scale) @ self.weights)

    def save(self, path: Path, domain: str, about: str) -> None:
        """Write the model as JSON, with what it was trained on in words."""
        document = {
            "format": 1,
            "domain": domain,
            "about": about,
            "names": self.names,
            "mean": _rounded(self.mean),
            "scale": _rounded(self.scale),
            "weights": _rounded(self.weights),
        }
        path.write_text(json.dumps(document) + "\n", encoding="utf-8")


def load_appearance(path: Path) -> AppearanceModel:
    """Read a model that `AppearanceModel.save` has written.

    Raises:
        InputError: The file cannot be used.
    """
    document = read_json(path, _ModelFile, "an appearance model")
    mean, scale, weights = (
        np.array(values) for values in (document.mean, document.scale, document.weights)
    )
    if weights.shape != (len(mean) + 1, len(document.names)) or scale.shape != mean.shape:
        raise InputError(f"{path}: weights: got {weights.shape} values; expected features x names")
    return AppearanceModel(document.names, mean, scale, weights)


def features_of(colour: ColourImage, points: ShelfPoints, mask: Bools) -> Floats:
    """Return what is told of an object by its front, shape (F,).

    Args:
        colour: The image.
        points: Where its pixels lie.
        mask: Which of them show the object.
    """
    seen_m = points.points_m[mask]
    front = seen_m[:, 1] < np.quantile(seen_m[:, 1], 0.05) + STEP_M
    low_m, high_m = np.quantile(seen_m[front][:, [0, 2]], [0.01, 0.99], axis=0)
    width_m, height_m = high_m[0] - low_m[0], high_m[1]
    shown_m = high_m[1] - low_m[1]
    sizes = np.array([width_m, height_m, shown_m / max(height_m, 1e-3)]) * [10.0, 10.0, 1.0]
    products = [sizes[0] * sizes[1], sizes[0] ** 2, sizes[1] ** 2, sizes[0] / max(sizes[1], 0.1)]
    return np.concatenate([sizes, products, _colour_features(colour[mask][front])])


def trained(names: tuple[str, ...], features: Floats, labels: NDArray[np.int64]) -> AppearanceModel:
    """Fit a model by the likelihood of its labels with a penalty on its weights.

    Args:
        names: Names of the products.
        features: Shape (K, F).
        labels: Number of each row's name, shape (K,).
    """
    mean, scale = features.mean(axis=0), np.maximum(features.std(axis=0), 1e-6)
    inputs = _extended((features - mean) / scale)
    wanted = np.eye(len(names))[labels]
    shape = (inputs.shape[1], len(names))

    def loss(flat: Floats) -> tuple[float, Floats]:
        weights = flat.reshape(shape)
        chances = _softmax(inputs @ weights)
        penalised = weights.copy()
        penalised[-1] = 0.0
        cost = -np.log(chances[wanted > 0.0] + 1e-12).mean() + PENALTY * (penalised**2).mean()
        slope = inputs.T @ (chances - wanted) / len(inputs)
        slope += 2.0 * PENALTY * penalised / penalised.size
        return float(cost), slope.ravel()

    found = minimize(loss, np.zeros(shape).ravel(), jac=True, method="L-BFGS-B",
                     options={"maxiter": 400})  # fmt: skip
    return AppearanceModel(names, mean, scale, found.x.reshape(shape))


def _colour_features(pixels: ColourImage) -> Floats:
    """Return a histogram of hues, and how strong and how bright colours are."""
    rgb = pixels.astype(np.float64) / 255.0
    high, low = rgb.max(axis=1), rgb.min(axis=1)
    strength = (high - low) / np.maximum(high, 1e-6)
    strong = (strength > LEAST_SATURATION) & (high > 0.12)
    hues = _hues(rgb[strong], high[strong], low[strong])
    histogram = np.bincount((hues * HUES).astype(int) % HUES, minlength=HUES) / max(len(rgb), 1)
    summary = [strong.mean(), strength.mean(), high.mean(), high.std()]
    features: Floats = np.concatenate([np.sqrt(histogram), summary])
    return features


def _hues(rgb: Floats, high: Floats, low: Floats) -> Floats:
    """Return the hue of each pixel, in [0, 1)."""
    spread = high - low
    red, green, blue = rgb.T
    by_green, by_blue = 2.0 + (blue - red) / spread, 4.0 + (red - green) / spread
    by_red = ((green - blue) / spread) % 6.0
    sixths = np.select([high == red, high == green], [by_red, by_green], by_blue)
    hues: Floats = (sixths / 6.0) % 1.0
    return hues


def _extended(inputs: Floats) -> Floats:
    return np.hstack([inputs, np.ones((len(inputs), 1))])


def _softmax(logits: Floats) -> Floats:
    powers = np.exp(logits - logits.max(axis=1, keepdims=True))
    chances: Floats = powers / powers.sum(axis=1, keepdims=True)
    return chances


def _rounded(values: Floats) -> object:
    return np.round(values, 5).tolist()
