"""Fit the evidence of traces: `python -m perception.training.trace_posterior FOLDER`.

First what speaks for ends, see `perception.training.end_evidence`. Then a trained tracer follows
cables of drawn scenes from ends in view. Each scene gives the features of all traces that were
found and says which are right; the weights that make the right answers likeliest (conditional
logit, with a prior that they are small) go into `posterior.json`.
"""

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from perception.cable.following import followed_share
from perception.cable.observation import Observe
from perception.cable.parts import EYES
from perception.cable.tracers.evidence import FEATURES, NONE_FEATURES, doubts, evidence
from perception.cable.tracers.hypotheses import hypotheses
from perception.cable.tracers.outward import EndWeights
from perception.cable.tracers.posterior import FILE, Weights, shares, stacked, view_at
from perception.cable.tracers.search import SearchConfig
from perception.cable.tracers.steps import StepModel
from perception.cable.tracers.survey import survey
from perception.cable.types import Endpoint, TraceEnd
from perception.models.frames import Floats
from perception.training.calibration import expected_calibration_error, selective_error
from perception.training.end_evidence import FIT_SEED as END_FIT_SEED
from perception.training.end_evidence import MEASURE_SEED as END_MEASURE_SEED
from perception.training.end_evidence import end_figures, fit_ends, seen_ends
from perception.training.scenes import Scene, SceneConfig, make_scene

SEED, HELD_OUT_SEED = 970_001, 980_001
# Sides of scenes [cable widths] and of their images [px].
EXTENTS, LARGEST_PX = (40.0, 170.0), 1000.0
WIDTHS_PX = (4.0, 14.0)
# Nodes of a line are half a cable width apart.
START_NODES, DIRECTION_NODES = 16, 8
START_ERROR = 0.1
# A strand nearer than this to an end hides it [widths].
HIDDEN = 1.5
# What is known of ends: all of them, one of each cable, or only the start.
KNOWN = {"all": 0.5, "one_each": 0.3, "start": 0.2}
# Share of cables that are seen where they turn back tightly.
HAIRPINS = 0.15
PRIOR = 0.02
# What searches believe speaks for a trace, all else against it; doubt speaks for none.
FOR, AGAINST, EITHER = (0.0, None), (None, 0.0), (None, None)
SIGNS = [
    *(FOR if name in {"there", "back"} else AGAINST for name in FEATURES),
    *(EITHER if name == "one" else FOR for name in NONE_FEATURES),
]


@dataclass(frozen=True, slots=True, eq=False)
class TraceTask:
    """A scene and a cable in it.

    Attributes:
        scene: The scene.
        line_px: The cable from an end to its other end, or to where it leaves the view.
        width_px: Its width.
        leaves: Whether it leaves the view.
        start_px: First points, with small errors.
        endpoints: Ends that are known.
    """

    scene: Scene
    line_px: Floats
    width_px: float
    leaves: bool
    start_px: Floats
    endpoints: tuple[Endpoint, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """The traces of one task: features of each and of none, and which are right."""

    features: Floats
    none: Floats
    right: NDArray[np.bool_]


def draw_task(rng: np.random.Generator) -> TraceTask:
    """Draw a scene in which some end of a cable is in view, and choose that cable."""
    while True:
        scene = make_scene(rng, _scene_config(rng))
        lines = [cable.points_px for cable in scene.cables]
        lines += [line[::-1] for line in lines]
        seen = [k for k in range(len(lines)) if _end_is_seen(scene, lines, k)]
        if seen:
            return _task(rng, scene, lines, seen)


def _scene_config(rng: np.random.Generator) -> SceneConfig:
    extent = float(np.exp(rng.uniform(*np.log(EXTENTS))))
    widest = min(WIDTHS_PX[1], LARGEST_PX / extent)
    return SceneConfig(
        extent,
        narrowest_px=WIDTHS_PX[0],
        widest_px=max(widest, WIDTHS_PX[0]),
        hairpins=HAIRPINS,
    )


def _end_is_seen(scene: Scene, lines: Sequence[Floats], number: int) -> bool:
    """Say whether the first node of a line is in view and no strand lies near it."""
    end, limits = lines[number][0], np.array(scene.image.shape[::-1])
    if len(_in_view(scene, lines[number])) < 3 * START_NODES:
        return False
    if (end < 2.0 * scene.width_px).any() or (end > limits - 2.0 * scene.width_px).any():
        return False
    half = len(lines) // 2
    rest = [line for k, line in enumerate(lines[:half]) if k != number % half]
    others = np.vstack([lines[number][DIRECTION_NODES:], *rest])
    return bool(np.linalg.norm(others - end, axis=1).min() > HIDDEN * scene.width_px)


def _in_view(scene: Scene, line: Floats) -> Floats:
    """Return a line up to where it leaves the view."""
    limits = np.array(scene.image.shape[::-1]) - 1.0
    outside = np.flatnonzero(((line < 0.0) | (line > limits)).any(axis=1))
    return line[: outside[0]] if len(outside) else line


def _task(
    rng: np.random.Generator, scene: Scene, lines: Sequence[Floats], seen: Sequence[int]
) -> TraceTask:
    chosen = int(rng.choice(seen))
    line, half = lines[chosen], len(lines) // 2
    visible = _in_view(scene, line)
    known = str(rng.choice(list(KNOWN), p=list(KNOWN.values())))
    ends = [
        _endpoint(lines[k])
        for k in seen
        if known == "all" or (known == "one_each" and (k < half) != (chosen < half))
    ]
    first = line[:START_NODES:2] if rng.random() < 0.5 else line[: 2 * DIRECTION_NODES : 14]
    error_px = rng.normal(0.0, START_ERROR * scene.width_px, first.shape)
    return TraceTask(
        scene,
        visible,
        scene.cables[chosen % half].width_px,
        len(visible) < len(line),
        first + error_px,
        tuple(ends),
    )


def _endpoint(line: Floats) -> Endpoint:
    inwards = line[DIRECTION_NODES] - line[0]
    return Endpoint(line[0], inwards / np.linalg.norm(inwards), 1.0)


def is_right(task: TraceTask, points_px: Floats, end: TraceEnd) -> bool:
    """Say whether a trace follows its cable to the end, or to where it leaves the view."""
    width_px = task.width_px
    if len(points_px) < 2 or (end is TraceEnd.EDGE) != task.leaves:
        return False
    if float(np.linalg.norm(points_px[-1] - task.line_px[-1])) > 5.0 * width_px:
        return False
    truth = task.line_px[DIRECTION_NODES:-DIRECTION_NODES]
    return followed_share(truth, points_px, 1.3 * width_px, 5.0 * width_px) >= 1.0


def examples(model: StepModel, observe: Observe, seed: int, wanted: int) -> Iterator[Example]:
    """Yield what searches found in scenes of a seed, as they are observed."""
    for number in range(wanted):
        rng = np.random.default_rng([seed, number])
        task = draw_task(rng)
        view = view_at(observe, task.scene.image, task.start_px)
        if view is None:
            continue
        found = survey(
            model, SearchConfig(), task.scene.image, view, [task.start_px], task.endpoints
        )
        candidates = hypotheses(found, 0)
        right = [is_right(task, found.image.back(one.points), one.end) for one in candidates]
        yield Example(evidence(found, 0, candidates), doubts(found, 0), np.array(right, dtype=bool))


def fit(seen: Sequence[Example], ends: EndWeights | None = None) -> Weights:
    """Return the likeliest weights beside those of ends."""
    count, each = len(FEATURES), [_stacked(one) for one in seen]

    def loss(flat: Floats) -> tuple[float, Floats]:
        total, slope = PRIOR * float(flat @ flat), 2.0 * PRIOR * flat
        for features, right in each:
            beliefs = shares(features, flat)
            believed = max(float(beliefs[right].sum()), 1e-12)
            total -= float(np.log(believed))
            slope += (beliefs - beliefs * right / believed) @ features
        return total, slope

    first = np.zeros(count + len(NONE_FEATURES))
    found = minimize(loss, first, jac=True, method="L-BFGS-B", bounds=SIGNS)
    flat = found.x.round(4).tolist()
    return Weights(
        trace=dict(zip(FEATURES, flat[:count], strict=True)),
        none=dict(zip(NONE_FEATURES, flat[count:], strict=True)),
        ends=ends or EndWeights(),
    )


def _stacked(one: Example) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the features of all answers, "none" last, and which are right."""
    right = np.append(one.right, not one.right.any())
    return stacked(one.features, one.none), right


def figures(seen: Sequence[Example], weights: Weights) -> dict[str, float]:
    """Return how well the best trace's belief holds."""
    believed = [weights.probabilities(one.features, one.none)[:-1] for one in seen]
    kept = [pair for pair in zip(believed, seen, strict=True) if len(pair[0])]
    belief = np.array([float(beliefs.max()) for beliefs, _ in kept])
    right = np.array([float(one.right[int(beliefs.argmax())]) for beliefs, one in kept])
    return {
        "n": len(right),
        "right": float(right.mean()),
        "among_hypotheses": float(np.mean([one.right.any() for _, one in kept])),
        "calibration_error": expected_calibration_error(belief, right),
        "error_of_surest_80": selective_error(belief, right),
    }


def main(arguments: Sequence[str] | None = None) -> None:
    """Fit the weights, write them, and the figures on scenes of another seed."""
    parser = argparse.ArgumentParser(prog="python -m perception.training.trace_posterior")
    parser.add_argument("folder", type=Path, help="folder of a trained tracer")
    parser.add_argument("--scenes", type=int, default=400, help="to fit with, default 400")
    parser.add_argument("--held-out", type=int, default=200, help="to measure on, default 200")
    options = parser.parse_args(arguments)
    model, eye = StepModel(options.folder), EYES["learned"]()
    ends = fit_ends(seen_ends(model, eye, END_FIT_SEED, options.scenes))
    weights = fit(list(examples(model, eye.observe, SEED, options.scenes)), ends)
    (options.folder / FILE).write_text(weights.model_dump_json(indent=2) + "\n")
    held_out = list(examples(model, eye.observe, HELD_OUT_SEED, options.held_out))
    told = seen_ends(model, eye, END_MEASURE_SEED, options.held_out)
    path = options.folder / "metrics.json"
    metrics = json.loads(path.read_text())
    metrics["ends"] = {
        "fit_seed": END_FIT_SEED,
        "measure_seed": END_MEASURE_SEED,
        **end_figures(told, ends),
    }
    metrics["traces"] = {
        "fit_seed": SEED,
        "measure_seed": HELD_OUT_SEED,
        **figures(held_out, weights),
    }
    path.write_text(json.dumps(metrics, indent=2) + "\n")


if __name__ == "__main__":
    main()
