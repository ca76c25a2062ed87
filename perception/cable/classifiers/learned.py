"""Over and under by a network that sees both strands of a crossing at once."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch

from perception.cable.classifiers.passes import StrandPass, passes_of, path_through
from perception.cable.crossings import CrossingSite, decide, find_sites
from perception.cable.observation import Observe
from perception.cable.types import Crossing, Points, Trace
from perception.cable.width import width_under
from perception.camera import GreyImage
from perception.models.crossing_ribbon import REACH, make_ribbons, scale_for_ribbons
from perception.models.store import load_network, read_config

# Where traces cross themselves they have gone over to another strand far less often than lines in
# training: 222 of 1,536 places there, about 1 in 30 crossings of traces that are believed in.
USUAL_ODDS = (1.0 / 29.0) / (222.0 / 1314.0)
# Ways of less belief are as good as none.
LEAST_BELIEF = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class JudgedSite:
    """What a network says of a place where traces cross.

    Attributes:
        site: The place.
        a_over: Belief that strand a is on top, if strands cross there.
        real: Belief that strands cross there; else traces go over from one strand to the other.
    """

    site: CrossingSite
    a_over: float
    real: float


@dataclass(frozen=True, slots=True, eq=False)
class _Remembered:
    """What has been judged of the latest image, by the points of traces."""

    image: tuple[tuple[int, ...], bytes] | tuple[()]
    judged: dict[tuple[bytes, ...], tuple[JudgedSite, ...]]


class LearnedClassifier:
    """Implements `CrossingClassifier` and `TraceDoubter` with a trained network.

    P(a over b) = 1 - P(b over a) by construction, see `CrossingRibbonNet`; the temperature of
    the trained version makes beliefs as high as answers are often right.

    Args:
        folder: A trained version, see `perception.models.store`.
        observe: Tells how wide cables are; where it does not, that is measured along traces.
    """

    def __init__(self, folder: Path, observe: Observe | None = None) -> None:
        self._observe = observe
        self._network = load_network(folder)
        self._temperature = read_config(folder).temperature
        # Steps of perception ask again about the same image and traces.
        self._remembered = _Remembered((), {})

    def classify(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Return every crossing; see `CrossingClassifier.classify`."""
        return tuple(decide(judged.site, judged.a_over) for judged in self.judge(image, traces))

    def doubted(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Trace, ...]:
        """Return ways to trace one cable, believed less; see `TraceDoubter.doubted`."""
        told = [
            replace(trace, probability=trace.probability * self._stays(image, trace))
            if trace.probability >= LEAST_BELIEF
            else trace
            for trace in traces
        ]
        return tuple(sorted(told, key=lambda trace: -trace.probability))

    def _stays(self, image: GreyImage, trace: Trace) -> float:
        """Return the belief that a trace crosses itself wherever it seems to."""
        real = np.array([judged.real for judged in self.judge(image, [trace])])
        return float(np.prod(real / (real + USUAL_ODDS * (1.0 - real))))

    def judge(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[JudgedSite, ...]:
        """Return both beliefs about every crossing of the traces, all in one pass."""
        if not traces:
            return ()
        seen = (image.shape, image.tobytes())
        remembered = self._remembered
        if remembered.image != seen:
            remembered = self._remembered = _Remembered(seen, {})
        judged = remembered.judged
        lines = tuple(trace.points_px.tobytes() for trace in traces)
        if lines not in judged:
            judged[lines] = self._judge(image, traces)
        return judged[lines]

    def _judge(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[JudgedSite, ...]:
        width_px = self._width(image, traces)
        sites = find_sites(traces, width_px)
        if not sites:
            return ()
        scaled = scale_for_ribbons(image, width_px)
        paths = np.array(
            [[_path(strand, scaled.scale) for strand in passes_of(site, traces)] for site in sites]
        )
        beliefs = self._beliefs(torch.from_numpy(make_ribbons(scaled, paths)))
        return tuple(
            JudgedSite(site, a_over, real)
            for site, (a_over, real) in zip(sites, beliefs, strict=True)
        )

    def _width(self, image: GreyImage, traces: Sequence[Trace]) -> float:
        observation = self._observe(image) if self._observe is not None else None
        if observation is not None:
            return observation.mask.width_px
        return width_under(image, [trace.points_px for trace in traces])

    @torch.inference_mode()
    def _beliefs(self, ribbons: torch.Tensor) -> list[tuple[float, float]]:
        logits = self._network(ribbons).double()
        logits[:, 0] /= self._temperature
        beliefs: list[tuple[float, float]] = torch.sigmoid(logits).tolist()
        return beliefs


def _path(strand: StrandPass, scale: float) -> Points:
    return (path_through(strand, REACH / scale, 1.0 / scale) + 0.5) * scale - 0.5
