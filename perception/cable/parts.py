"""The parts that cable vision is put together from, by name."""

from collections.abc import Callable
from typing import Literal

from perception.cable.classifiers.continuity import ContinuityClassifier
from perception.cable.classifiers.edges import EdgeClassifier
from perception.cable.eyes import Eye, ThresholdEye
from perception.cable.interfaces import CrossingClassifier, Tracer
from perception.cable.tracers.accountable import AccountableTracer
from perception.cable.tracers.analytic import AnalyticTracer
from perception.cable.tracers.skeleton import SkeletonTracer

EyeName = Literal["thresholds", "learned"]
TracerName = Literal["skeleton", "analytic", "learned"]
ClassifierName = Literal["edges", "continuity", "learned"]

SIGHT, TRACER, CROSSING = "sight_v2", "tracer_v4", "crossing_v4"


# Networks need the extra `learn`; who does not ask for them does without.
def _learned_eye() -> Eye:
    from perception.cable.sight.eye import SightEye
    from perception.models.store import FOLDER

    return SightEye(FOLDER / SIGHT)


def _learned_tracer(eye: Eye) -> Tracer:
    from perception.cable.tracers.posterior import PosteriorTracer
    from perception.models.store import FOLDER

    return PosteriorTracer(FOLDER / TRACER, eye.observe)


def _learned_classifier(eye: Eye) -> CrossingClassifier:
    from perception.cable.classifiers.learned import LearnedClassifier
    from perception.models.store import FOLDER

    return LearnedClassifier(FOLDER / CROSSING, eye.observe)


EYES: dict[EyeName, Callable[[], Eye]] = {"thresholds": ThresholdEye, "learned": _learned_eye}
TRACERS: dict[TracerName, Callable[[Eye], Tracer]] = {
    "skeleton": lambda eye: AccountableTracer(SkeletonTracer(observe=eye.observe), eye.observe),
    "analytic": lambda eye: AccountableTracer(AnalyticTracer(observe=eye.observe), eye.observe),
    "learned": _learned_tracer,
}
CLASSIFIERS: dict[ClassifierName, Callable[[Eye], CrossingClassifier]] = {
    "edges": lambda _: EdgeClassifier(),
    "continuity": lambda _: ContinuityClassifier(),
    "learned": _learned_classifier,
}
