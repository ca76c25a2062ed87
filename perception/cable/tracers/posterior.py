"""How likely each whole trace is, given all that speaks for and against it.

The odds of a trace are the exponential of a weighted sum of its features, those of "none of
these" of another one (conditional logit, McFadden 1974). The weights are fitted on drawn
scenes of known truth, `perception.training.trace_posterior`, so that beliefs come true as
often as they say.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path as FilePath

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from executive.core.errors import InputError
from executive.core.json_files import read_json
from perception.cable.eyes import LEAST_END
from perception.cable.observation import Observation, Observe
from perception.cable.plug_ends import find_ends
from perception.cable.polyline import pixels_of
from perception.cable.tracers.evidence import FEATURES, NONE_FEATURES, doubts, evidence
from perception.cable.tracers.hypotheses import Hypothesis, hypotheses
from perception.cable.tracers.outward import EndWeights, judged
from perception.cable.tracers.search import SearchConfig
from perception.cable.tracers.starts import from_start
from perception.cable.tracers.steps import StepModel
from perception.cable.tracers.stretches import stretches_px
from perception.cable.tracers.survey import Survey, View, survey, view_from
from perception.cable.tracers.walking import walked_ends
from perception.cable.types import Endpoint, Points, Trace, TraceEnd
from perception.camera import GreyImage
from perception.models.frames import Floats, scale_image
from perception.models.tracer_crop import WIDTH

FILE = "posterior.json"
# A start with no more points than this at a known end tells nothing more than that end.
MOST_AT_END = 2
# Widths that are tried, too, as shares of the seen one, where a trace is lost; so many looks each.
OTHER_WIDTHS, OTHER_LOOKS = (1.5, 0.7), 120


class Weights(BaseModel):
    """The file `posterior.json` of a trained version.

    Attributes:
        trace: Weight of each feature of a trace, by its name.
        none: Weight of each feature of "none of these".
        ends: Weights of what speaks for ends.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    trace: dict[str, float]
    none: dict[str, float]
    ends: EndWeights = EndWeights()

    def probabilities(self, features: Floats, none: Floats) -> Floats:
        """Return the probability of each trace and, last, of none, shape (K + 1,)."""
        weights = [*(self.trace[name] for name in FEATURES), *(self.none[k] for k in NONE_FEATURES)]
        return shares(stacked(features, none), np.array(weights))


@dataclass(frozen=True, slots=True, eq=False)
class TracePosterior:
    """Beliefs in whole traces of one cable.

    Attributes:
        traces: Distinct traces, likeliest first, each with its probability.
        none: Probability that none of them follows the cable.
    """

    traces: tuple[Trace, ...]
    none: float

    @property
    def best(self) -> Trace | None:
        """The likeliest trace."""
        return next(iter(self.traces), None)

    def sample(self, rng: np.random.Generator) -> Trace | None:
        """Draw a trace as often as it is likely; None for none of them."""
        odds = np.array([*(trace.probability for trace in self.traces), self.none])
        chosen = int(rng.choice(len(odds), p=odds / odds.sum()))
        return self.traces[chosen] if chosen < len(self.traces) else None


NOTHING = TracePosterior((), 1.0)


class PosteriorTracer:
    """Implements `Tracer` by searches from all ends and a posterior over whole traces.

    It also implements `perception.cable.eyes.EndJudge`.

    Args:
        folder: A trained version with `posterior.json`.
        observe: Gives mask and width of the cables; where it gives none at a start, they are
            looked for there.
        config: Settings of the searches.

    Raises:
        InputError: The version has no weights of evidence, or others than this code knows.
    """

    def __init__(
        self, folder: FilePath, observe: Observe | None = None, config: SearchConfig | None = None
    ) -> None:
        self._weights = read_weights(folder / FILE)
        self._model = StepModel(folder)
        self._observe, self._config = observe, config or SearchConfig()
        looks = min(self._config.most_looks, OTHER_LOOKS)
        self._briefly = replace(self._config, most_looks=looks)
        # Traces from all ends of one image come from one survey.
        self._surveyed = lru_cache(maxsize=4)(self._survey_ends)

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow the cable that starts at `start_px`; see `Tracer.trace`."""
        return self.posterior(image, start_px, endpoints).best

    def hypotheses(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> tuple[Trace, ...]:
        """Return distinct traces, likeliest first; their beliefs add up to less than 1."""
        return self.posterior(image, start_px, endpoints).traces

    def posterior(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> TracePosterior:
        """Return all beliefs about the cable that starts at `start_px`; see `Tracer.trace`.

        Where a trace is lost or nothing is believed in, cables may be wider or thinner than they
        seem, so that is tried as well.
        """
        start_px = np.atleast_2d(np.asarray(start_px, dtype=float))
        view = view_at(self._observe, image, start_px)
        if view is None:
            return NOTHING
        first = self._asked(image, start_px, endpoints, view)
        if not _is_doubtful(first):
            return first
        other = [view.wider(by) for by in OTHER_WIDTHS]
        again = [self._asked_again(image, start_px, endpoints, each) for each in other]
        return max([first, *again], key=_best_belief)

    def judged(self, image: GreyImage, endpoints: Sequence[Endpoint]) -> tuple[Endpoint, ...]:
        """Return ends, the surest first, believed in as far as the cable is seen to stop there.

        Where none is left, cables are followed to their ends from where they lie alone.
        """
        view = view_at(self._observe, image, endpoints[0].position_px[None] if endpoints else None)
        if view is None:
            return tuple(endpoints)
        scaled = scale_image(image, view.width_px, WIDTH, self._model.zoom)
        told = judged(self._model, scaled, endpoints, self._weights.ends)
        if view.stretches and not any(end.probability >= LEAST_END for end in told):
            longest = max(view.stretches, key=len)
            sketch = view.sketch(scaled)
            found = walked_ends(self._model, self._config, scaled, longest, sketch)
            told = (*judged(self._model, scaled, found, self._weights.ends), *told)
        return tuple(sorted(told, key=lambda end: -end.probability))

    def _asked(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint], view: View
    ) -> TracePosterior:
        number = _end_at(start_px, endpoints, view.width_px)
        if number is not None:
            found = self._surveyed(image.tobytes(), image.shape, tuple(endpoints))
            return posterior_of(found, number, self._weights) if found else NOTHING
        found = survey(self._model, self._config, image, view, [start_px], endpoints)
        return posterior_of(found, 0, self._weights)

    def _asked_again(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint], view: View
    ) -> TracePosterior:
        """Follow the cable from its start alone."""
        number = _end_at(start_px, endpoints, view.width_px)
        start = start_px if number is None else endpoints[number].position_px[None]
        found = survey(self._model, self._briefly, image, view, [start], endpoints, from_all=False)
        return posterior_of(found, 0, self._weights)

    def _survey_ends(
        self, pixels: bytes, shape: tuple[int, int], endpoints: tuple[Endpoint, ...]
    ) -> Survey | None:
        """Follow cables from all ends; endpoints are told apart by being the same objects."""
        image = np.frombuffer(pixels, dtype=np.uint8).reshape(shape)
        starts = [end.position_px[None] for end in endpoints]
        view = view_at(self._observe, image, starts[0])
        if view is None:
            return None
        return survey(self._model, self._config, image, view, starts, endpoints)


def view_at(observe: Observe | None, image: GreyImage, start_px: Points | None) -> View | None:
    """Return what is seen of the cable at a start, by other means where that is not observed.

    Args:
        observe: Looks at the image, if anything does.
        image: Grey image.
        start_px: Points on the cable, shape (N, 2); None takes what is observed as it is.
    """
    observation = observe(image) if observe is not None else None
    if observation is not None and (start_px is None or _holds(observation.mask.cable, start_px)):
        return view_of(observation)
    return view_from(image, start_px) if start_px is not None else None


def view_of(observation: Observation) -> View:
    """Return what the searches need of an observation."""
    mask, graph = observation.mask, observation.graph
    return View(
        mask.width_px,
        mask.cable,
        stretches=stretches_px(observation),
        dead_ends=find_ends(mask, graph),
    )


def _best_belief(posterior: TracePosterior) -> float:
    return posterior.best.probability if posterior.best is not None else 0.0


def _is_doubtful(posterior: TracePosterior) -> bool:
    best = posterior.best
    return best is None or best.end in {TraceEnd.LOST, TraceEnd.RETRACE}


def _holds(cable: NDArray[np.bool_], points_px: Points) -> bool:
    """Say whether at least half of some points lie on a mask or beside it."""
    near = cv2.dilate(cable.astype(np.uint8), np.ones((3, 3), np.uint8))
    return float(near[pixels_of(points_px, cable.shape)].mean()) >= 0.5


def _end_at(start_px: Points, endpoints: Sequence[Endpoint], width_px: float) -> int | None:
    """Return the end that a start without a way of its own is at, None for none."""
    if len(start_px) > MOST_AT_END or not endpoints:
        return None
    gaps = np.array([np.linalg.norm(end.position_px - start_px[0]) for end in endpoints])
    return int(gaps.argmin()) if gaps.min() < width_px else None


def posterior_of(found: Survey, start: int, weights: Weights) -> TracePosterior:
    """Return all beliefs about the cable at one end of a survey."""
    candidates = hypotheses(found, start)
    features, none = evidence(found, start, candidates), doubts(found, start)
    beliefs = weights.probabilities(features, none)
    order = np.argsort(-beliefs[:-1], kind="stable")
    traces = tuple(_as_trace(found, start, candidates[k], float(beliefs[k])) for k in order)
    return TracePosterior(traces, float(beliefs[-1]))


def stacked(features: Floats, none: Floats) -> Floats:
    """Return the features of traces and, last, of none of them as rows of one table."""
    table = np.zeros((len(features) + 1, features.shape[1] + len(none)))
    table[:-1, : features.shape[1]], table[-1, features.shape[1] :] = features, none
    return table


def shares(table: Floats, weights: Floats) -> Floats:
    """Return the probability of each row of a table of features."""
    odds = table @ weights
    odds = np.exp(odds - odds.max())
    parts: Floats = odds / odds.sum()
    return parts


def read_weights(path: FilePath) -> Weights:
    """Read weights of evidence.

    Raises:
        InputError: There is no such file, it is damaged, or it names other features.
    """
    if not path.exists():
        raise InputError(
            f"{path}: no weights of evidence; expected a fitted version; "
            f"try python -m perception.training.trace_posterior {path.parent}"
        )
    weights = read_json(path, Weights, "weights of evidence")
    if set(weights.trace) != set(FEATURES) or set(weights.none) != set(NONE_FEATURES):
        raise InputError(
            f"{path}: got features {sorted({*weights.trace, *weights.none})}; "
            f"expected {sorted({*FEATURES, *NONE_FEATURES})}; fit them again"
        )
    return weights


def _as_trace(found: Survey, start: int, one: Hypothesis, belief: float) -> Trace:
    points = found.image.back(from_start(found.ends.points[start], one.points))
    return Trace(points, one.end, belief)
