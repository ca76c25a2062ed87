"""What to look at next: the question whose answer tells most about the knot.

How much an answer tells is the mutual information of answer and knot: by how many bits the
entropy of the belief falls on average (D. V. Lindley, "On a measure of the information
provided by an experiment", 1956). It follows exactly from the listed combinations of crossings.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from perception.cable.belief import Chances, knotted_share, listings, mixed, sureness, told
from perception.cable.outcomes import Outcomes
from perception.cable.parting import parting_arc
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology.names import UNKNOWN
from perception.cable.types import Crossing, Points, Question, QuestionKind, Reading

# Readings of one cable see the same crossing within this distance.
SAME_PLACE_PX = 12.0
# Ways that part from one within so much of its length part at one place.
SAME_FORK_PX = 20.0

# Turns chances of knots into chances of what is asked for.
About = Callable[[Chances], Chances]


def about_knottedness(knots: Chances) -> Chances:
    """Ask whether there is a knot."""
    knotted = knotted_share(knots)
    return {"knotted": knotted, "unknotted": math.fsum(knots.values()) - knotted}


def about_type(knots: Chances) -> Chances:
    """Ask which knot it is."""
    return knots


@dataclass(frozen=True, slots=True, eq=False)
class Opinion:
    """One reading, or none of them, with what it makes of the knot.

    Attributes:
        weight: Belief in it.
        knots: Probabilities of the knots, given that it is right.
        answers: The same times the probability of each answer to the question; None where the
            question means nothing to it.
    """

    weight: float
    knots: Chances
    answers: tuple[Chances, Chances] | None = None


def telling_question(
    readings: Sequence[Reading], about: About = about_knottedness
) -> Question | None:
    """Return the question about one cable whose answer tells most; None where nothing is open."""
    asked = [*crossing_questions(readings, about), *path_questions(readings, about)]
    return max(asked, key=lambda question: question.bits, default=None)


def crossing_questions(
    readings: Sequence[Reading], about: About = about_knottedness
) -> tuple[Question, ...]:
    """Return for each crossing of the likeliest reading how much its answer tells.

    Other readings that have a crossing of the same strands there learn from the answer, too.
    """
    if not readings:
        return ()
    listed = listings(readings)
    leader = max(range(len(readings)), key=lambda k: sureness(readings[k]))
    return tuple(
        Question(
            QuestionKind.CROSSING,
            crossing.position_px,
            information(_opinions_on(readings, listed, leader, crossing), about),
        )
        for crossing in listed[leader].crossings
    )


def _opinions_on(
    readings: Sequence[Reading], listed: Sequence[Outcomes], leader: int, asked: Crossing
) -> list[Opinion]:
    """Return what each reading makes of the knot for either answer at a crossing."""
    over, under = _tangents(readings[leader], asked)
    found = []
    for reading, outcomes in zip(readings, listed, strict=True):
        answers = None
        for k, crossing in enumerate(outcomes.crossings):
            if np.linalg.norm(crossing.position_px - asked.position_px) <= SAME_PLACE_PX:
                own, _ = _tangents(reading, crossing)
                alike = abs(float(own @ over)) >= abs(float(own @ under))
                answers = _split(outcomes, k, alike)
                break
        found.append(Opinion(sureness(reading), told(outcomes), answers))
    return [*found, _nothing(found)]


def _split(outcomes: Outcomes, k: int, alike: bool) -> tuple[Chances, Chances]:
    """Return chances of knots where crossing k is as the question puts it, and where not."""
    rows = list(zip(outcomes.flipped[:, k] != alike, outcomes.weights, outcomes.knots, strict=True))
    as_put, other = (
        mixed((float(weight), {name: 1.0}) for side, weight, name in rows if bool(side) == wanted)
        for wanted in (True, False)
    )
    return as_put, other


def _nothing(found: Sequence[Opinion]) -> Opinion:
    """Return the opinion that no reading is right."""
    return Opinion(max(0.0, 1.0 - math.fsum(one.weight for one in found)), {UNKNOWN: 1.0})


def _tangents(reading: Reading, crossing: Crossing) -> tuple[Points, Points]:
    points = reading.trace.points_px
    arcs = arc_lengths(points)
    ways = []
    for arc in (crossing.arc_over, crossing.arc_under):
        chord = np.diff(point_at(points, arcs, arc * arcs[-1] + np.array([-5.0, 5.0])), axis=0)[0]
        ways.append(chord / max(float(np.linalg.norm(chord)), 1e-9))
    return ways[0], ways[1]


def path_questions(
    readings: Sequence[Reading], about: About = about_knottedness
) -> tuple[Question, ...]:
    """Return for each place where readings part how much the right way would tell."""
    if len(readings) < 2:
        return ()
    knots = [told(listed) for listed in listings(readings)]
    questions = []
    for position_px, going, turning in _forks(readings, list(range(len(readings)))):
        opinions = [
            Opinion(sureness(reading), knots[k], _answers(knots[k], k in going, k in turning))
            for k, reading in enumerate(readings)
        ]
        bits = information([*opinions, _nothing(opinions)], about)
        questions.append(Question(QuestionKind.PATH, position_px, bits))
    return tuple(questions)


def _answers(knots: Chances, going: bool, turning: bool) -> tuple[Chances, Chances] | None:
    if not going and not turning:
        return None
    return (knots, {}) if going else ({}, knots)


def _forks(
    readings: Sequence[Reading], among: list[int]
) -> Iterator[tuple[Points, frozenset[int], frozenset[int]]]:
    """Yield where readings part from the likeliest, who goes on with it, and who turns off."""
    leader = max(among, key=lambda k: sureness(readings[k]))
    line = readings[leader].trace.points_px
    parted: list[tuple[float, int]] = []
    for k in among:
        arc_px = parting_arc(line, readings[k].trace.points_px) if k != leader else None
        if arc_px is not None:
            parted.append((arc_px, k))
    going = set(among)
    parted.sort()
    while parted:
        fork_px = parted[0][0]
        turning = [k for arc_px, k in parted if arc_px <= fork_px + SAME_FORK_PX]
        parted = [item for item in parted if item[1] not in turning]
        going -= set(turning)
        position_px = point_at(line, arc_lengths(line), fork_px)
        yield position_px, frozenset(going), frozenset(turning)
        if len(turning) > 1:
            yield from _forks(readings, turning)


def information(opinions: Sequence[Opinion], about: About = about_knottedness) -> float:
    """Return by how many bits an answer lowers the entropy of the belief on average.

    Those to whom the question means nothing expect the answers that the others expect.

    Args:
        opinions: All readings and none of them, with weights that add up to 1.
        about: What the belief is about.
    """
    heard = [one for one in opinions if one.answers is not None]
    share = math.fsum(one.weight for one in heard)
    if share <= 0.0:
        return 0.0
    told_bits = entropy(about(mixed((one.weight, one.knots) for one in opinions)))
    for side in (0, 1):
        parts = [(one.weight, one.answers[side]) for one in heard if one.answers is not None]
        chance = math.fsum(w * math.fsum(part.values()) for w, part in parts) / share
        parts += [(chance * one.weight, one.knots) for one in opinions if one.answers is None]
        told_bits -= _weighted_entropy(mixed(parts), about)
    return max(0.0, told_bits)


def entropy(shares: Chances) -> float:
    """Return the entropy of probabilities in bits."""
    return -math.fsum(p * math.log2(p) for p in shares.values() if p > 0.0)


def _weighted_entropy(knots: Chances, about: About) -> float:
    """Return the entropy of chances that add up to less than 1, times what they add up to."""
    total = math.fsum(knots.values())
    if total <= 0.0:
        return 0.0
    return total * entropy(about({name: p / total for name, p in knots.items()}))
