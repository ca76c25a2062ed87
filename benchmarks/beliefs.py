"""Beliefs carried from crossings to knots, with crossings that are wrong as often as they say.

Smooth random cables with 3 to 14 crossings, half of them drawn in space, half laid down in
order with each crossing then exchanged once in seven times. Half of the crossings are seen
clearly, half poorly. Images play no part: the trace is exact, and over and under are stated
wrongly just as often as their probabilities say. That may be meant in two ways:

- `stated`: given what is seen, the truth is drawn from the stated probabilities. Beliefs must
  then be calibrated, up to what is lost by listing only the likeliest combinations.
- `cables`: given the true cable, what is seen is drawn. Cables are knotted more seldom than
  crossings by chance, so that beliefs that take crossings as independent may be off.

Then questions are answered truly, one at a time, until P(knotted) is beyond 0.95 either way:
the one that tells most, the crossing that is least sure, or any crossing. Looking one question
ahead is greedy: where only two answers together decide, neither tells much by itself.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.harness import Row, mean, median, share
from perception.cable.belief import diagram_probability, knot_types, knotted_share
from perception.cable.crossings import strand_of
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.telling import crossing_questions
from perception.cable.topology import (
    Strand,
    StrandCrossing,
    close_over,
    curve_crossings,
    knot_type,
)
from perception.cable.topology.names import UNKNOT, UNKNOWN
from perception.cable.types import Crossing, Reading, Trace, TraceEnd
from perception.training.calibration import expected_calibration_error, selective_error
from simulation.cable.knots.splines import smooth

Floats = NDArray[np.float64]

SEED = 980_211
FEWEST, MOST = 3, 14
EXCHANGED = 0.15
SPACING_PX = 12.0
SIZE_PX = 150.0
# A true answer is taken for this sure.
ANSWERED = 0.9999
DECIDED = 0.95


RESAMPLES = 400


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What is seen of a cable, and what is true.

    Attributes:
        reading: The exact trace; its crossings may be stated the wrong way round.
        wrong: Which of them are.
        knot: Name of the true knot.
    """

    reading: Reading
    wrong: frozenset[int]
    knot: str

    @property
    def knotted(self) -> float:
        """P(knotted)."""
        return diagram_probability(self.reading.trace, 0, self.reading.crossings)

    def answered(self, k: int) -> "Seen":
        """Return what is seen once a crossing is known."""
        crossings = list(self.reading.crossings)
        crossings[k] = replace(
            _exchanged(crossings[k]) if k in self.wrong else crossings[k], probability=ANSWERED
        )
        return Seen(Reading(self.reading.trace, tuple(crossings)), self.wrong - {k}, self.knot)


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Judge 1,000 cables (60 when quick) each way, then ask about 150 (10) others."""
    count, asked = (60, 10) if quick else (1000, 150)
    rng = np.random.default_rng([SEED, seed])
    rows = []
    for name, stated in (("stated", True), ("cables", False)):
        scenes = [look(rng, stated=stated) for _ in range(count)]
        rows += _calibration(name, scenes)
    rows += _asking([look(rng, stated=True) for _ in range(asked)], rng)
    return [*rows, *_speed(rng, 5 if quick else 30)]


def look(rng: np.random.Generator, *, stated: bool, crossings: int | None = None) -> Seen:
    """Draw a cable and what is seen of it.

    Args:
        rng: Where chance comes from.
        stated: Whether the truth is drawn given what is seen, or the other way round.
        crossings: How many crossings it has; any number by default.
    """
    while True:
        strand = random_strand(rng, laid=bool(rng.random() < 0.5))
        if crossings in (None, len(strand.crossings)):
            seen = _seen(rng, strand, stated=stated)
            if seen.knot != UNKNOWN:
                return seen


def random_strand(rng: np.random.Generator, *, laid: bool) -> Strand:
    """Draw a smooth open cable [px] with 3 to 14 crossings."""
    while True:
        corners = rng.normal(size=(int(rng.integers(6, 12)), 3)) * SIZE_PX
        corners[:, 2] = np.arange(len(corners)) if laid else corners[:, 2] / SIZE_PX
        strand = curve_crossings(smooth(corners, SPACING_PX))
        if FEWEST <= len(strand.crossings) <= MOST:
            exchanged = [laid and bool(rng.random() < EXCHANGED) for _ in strand.crossings]
            return Strand(
                strand.points,
                tuple(
                    replace(c, first_over=c.first_over != other)
                    for c, other in zip(strand.crossings, exchanged, strict=True)
                ),
            )


def _seen(rng: np.random.Generator, strand: Strand, *, stated: bool) -> Seen:
    points = strand.points * np.array([1.0, -1.0])  # Image rows grow downwards.
    probabilities = [_stated_probability(rng) for _ in strand.crossings]
    wrong = frozenset(k for k, p in enumerate(probabilities) if rng.random() > p)
    arcs = arc_lengths(points)
    crossings = [
        _crossing(points, arcs, c, p) for c, p in zip(strand.crossings, probabilities, strict=True)
    ]
    if not stated:
        crossings = [_exchanged(c) if k in wrong else c for k, c in enumerate(crossings)]
    diagram = close_over(strand_of(Trace(points, TraceEnd.ENDPOINT, 1.0), 0, crossings))
    return Seen(
        Reading(Trace(points, TraceEnd.ENDPOINT, 1.0), tuple(crossings)),
        wrong,
        knot_type(diagram.swapped(wrong)),
    )


def _stated_probability(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.97, 0.9999) if rng.random() < 0.5 else rng.uniform(0.55, 0.97))


def _crossing(points: Floats, arcs: Floats, at: StrandCrossing, probability: float) -> Crossing:
    places = np.interp([at.first, at.second], np.arange(len(arcs)), arcs)
    over, under = places if at.first_over else places[::-1]
    where = point_at(points, arcs, places[0])
    length = float(arcs[-1])
    return Crossing(where, 0, float(over) / length, 0, float(under) / length, probability)


def _exchanged(crossing: Crossing) -> Crossing:
    return replace(crossing, arc_over=crossing.arc_under, arc_under=crossing.arc_over)


def _calibration(name: str, scenes: Sequence[Seen]) -> list[Row]:
    knotted, typed = [], []
    for seen in scenes:
        types, is_knotted = knot_types([seen.reading]), seen.knot != UNKNOT
        p = knotted_share({one.name: one.probability for one in types})
        knotted.append((max(p, 1.0 - p), (p >= 0.5) == is_knotted))
        typed.append((types[0].probability, types[0].name == seen.knot))
    truly = sum(seen.knot != UNKNOT for seen in scenes)
    rows = [share(f"knotted_cables_{name}", truly, len(scenes))]
    for what, answers in (("knotted", knotted), ("type", typed)):
        pairs = np.array(answers, dtype=float)
        rows.append(share(f"{what}_right_{name}", int(pairs[:, 1].sum()), len(pairs)))
        goal = "<= 0.05" if name == "stated" else ""
        rows.append(_measured(f"{what}_calibration_error_{name}", _gap, pairs, goal))
        rows.append(_measured(f"{what}_error_of_surest_80_{name}", _surest, pairs, ""))
    return rows


def _gap(pairs: Floats) -> float:
    return expected_calibration_error(pairs[:, 0], pairs[:, 1])


def _surest(pairs: Floats) -> float:
    return selective_error(pairs[:, 0], pairs[:, 1])


def _measured(name: str, measure: Callable[[Floats], float], pairs: Floats, goal: str) -> Row:
    """Return a figure with its interval by resampling."""
    rng = np.random.default_rng(len(pairs))
    drawn = [measure(pairs[rng.integers(len(pairs), size=len(pairs))]) for _ in range(RESAMPLES)]
    low, high = np.percentile(drawn, [2.5, 97.5])
    return Row(name, measure(pairs), "1", len(pairs), float(low), float(high), goal)


# Says which of the crossings that are still open is asked for next.
Policy = Callable[[Seen, Sequence[int], np.random.Generator], int]


def _telling(seen: Seen, left: Sequence[int], rng: np.random.Generator) -> int:
    del rng
    bits = [question.bits for question in crossing_questions([seen.reading])]
    return max(left, key=lambda k: bits[k])


def _least_sure(seen: Seen, left: Sequence[int], rng: np.random.Generator) -> int:
    del rng
    return min(left, key=lambda k: seen.reading.crossings[k].probability)


def _any(seen: Seen, left: Sequence[int], rng: np.random.Generator) -> int:
    del seen
    return int(rng.choice(left))


POLICIES: dict[str, Policy] = {"telling": _telling, "least_sure": _least_sure, "random": _any}


def _asking(scenes: Sequence[Seen], rng: np.random.Generator) -> list[Row]:
    """Return how many questions it takes to be sure, and how often one is wrong meanwhile."""
    rows = []
    scenes = [seen for seen in scenes if not _decided(seen.knotted)]
    for name, policy in POLICIES.items():
        courses = [_course(seen, policy, rng) for seen in scenes]
        rows.append(mean(f"questions_{name}", [len(course) - 1 for course in courses], "1"))
        for after in (1, 2, 3):
            wrong = sum(
                (course[min(after, len(course) - 1)] >= 0.5) != (seen.knot != UNKNOT)
                for seen, course in zip(scenes, courses, strict=True)
            )
            rows.append(share(f"wrong_after_{after}_{name}", wrong, len(scenes)))
    return rows


def _decided(knotted: float) -> bool:
    return max(knotted, 1.0 - knotted) > DECIDED


def _course(seen: Seen, policy: Policy, rng: np.random.Generator) -> list[float]:
    """Return P(knotted) before the first question and after each."""
    left, course = list(range(len(seen.reading.crossings))), [seen.knotted]
    while left and not _decided(course[-1]):
        k = policy(seen, left, rng)
        left.remove(k)
        seen = seen.answered(k)
        course.append(seen.knotted)
    return course


def _speed(rng: np.random.Generator, count: int) -> list[Row]:
    """Time all that is believed about cables with 14 crossings [ms of one core]."""
    milliseconds = []
    for _ in range(count):
        reading = look(rng, stated=True, crossings=MOST).reading
        began_s = time.process_time()
        diagram_probability(reading.trace, 0, reading.crossings)
        knot_types([reading])
        crossing_questions([reading])
        milliseconds.append(1e3 * (time.process_time() - began_s))
    return [
        median("median_ms_14_crossings", milliseconds, "ms", "<= 50"),
        Row("worst_ms_14_crossings", max(milliseconds), "ms", count, 0.0, max(milliseconds)),
    ]
