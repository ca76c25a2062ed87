"""The perceptions that a mission may choose from, by name; each is built when it is chosen."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal

from perception.cable.interfaces import CableVision, Tracer
from perception.cable.selectable import SelectableVision
from perception.cable.types import Crossing, Endpoint, Points, Trace
from perception.camera import GreyImage

# The thesis's classifier of crossings, as `cellwright train` has kept it.
THESIS_CLASSIFIER = "thesis_crossing_v1"


@dataclass(frozen=True, slots=True)
class _AboveRows:
    """A tracer that does not see the lowest rows, which show the robot."""

    tracer: Tracer
    hidden_rows: int

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        return self.tracer.trace(image[: len(image) - self.hidden_rows], start_px, endpoints)


@dataclass(frozen=True, slots=True)
class _CrossingsOf:
    """The classifier of crossings that a whole perception has."""

    vision: CableVision

    def classify(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        return self.vision.crossings(image, traces)


# Builds our own perception, with networks or without; for None with them where they can run.
Own = Callable[[Literal["learned", "classic"] | None], CableVision]


def selectable_vision(own: Own, hidden_rows: int) -> SelectableVision:
    """Return all perceptions behind one interface, the classic one in use.

    Args:
        own: Builds ours, which the others see ends and cable pixels with.
        hidden_rows: Lowest image rows that show the robot instead of the table.
    """
    known: dict[str, Callable[[], CableVision]] = {
        "best": partial(own, None),
        "classic": partial(own, "classic"),
        "learned": partial(own, "learned"),
        "tusk": partial(_tusk, own, hidden_rows, learned=True, cancel=True),
        "tusk_uncancelled": partial(_tusk, own, hidden_rows, learned=True, cancel=False),
        "tusk_analytic": partial(_tusk, own, hidden_rows, learned=False, cancel=True),
        "sgtm2": partial(_sgtm2, own, hidden_rows),
        "ruled": partial(_ruled, own),
    }
    return SelectableVision(known, "classic")


def _tusk(own: Own, hidden_rows: int, *, learned: bool, cancel: bool) -> CableVision:
    """Build the thesis's perception; ends are seen as ours are."""
    parts = own("learned")  # says first if networks cannot run here
    from perception.cable.baselines.greedy_tracer import GreedyTracer
    from perception.cable.baselines.tusk import TuskConfig, TuskVision
    from perception.cable.classifiers.thesis import ThesisClassifier
    from perception.cable.parts import TRACER
    from perception.cable.tracers.analytic import AnalyticTracer
    from perception.models.store import FOLDER

    tracer: Tracer = GreedyTracer(FOLDER / TRACER) if learned else AnalyticTracer()
    classifier = ThesisClassifier(FOLDER / THESIS_CLASSIFIER)
    return TuskVision(parts, _AboveRows(tracer, hidden_rows), classifier, TuskConfig(cancel))


def _ruled(own: Own) -> CableVision:
    """Build our own perception with the thesis's rule in the place of proofs."""
    parts = own(None)
    from perception.cable.baselines.tusk import TuskVision

    return TuskVision(parts, parts, _CrossingsOf(parts))


def _sgtm2(own: Own, hidden_rows: int) -> CableVision:
    parts = own("learned")
    from perception.cable.baselines.sgtm2_steps import Sgtm2Vision
    from perception.cable.parts import SIGHT
    from perception.cable.sight.seen import Tangle
    from perception.cable.sight.sight import Sight
    from perception.cable.tracers.analytic import AnalyticTracer
    from perception.models.store import FOLDER

    sight = Sight(FOLDER / SIGHT)

    def detected(image: GreyImage) -> Sequence[Tangle]:
        return sight.look(image[: len(image) - hidden_rows]).tangles

    return Sgtm2Vision(parts, _AboveRows(AnalyticTracer(), hidden_rows), detected)
