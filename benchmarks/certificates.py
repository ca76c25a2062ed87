"""Knotted or not, with perfect crossings: verdicts, their proofs, and the thesis's rule beside.

Random open curves with 4 to 20 crossings, closed over everything: half of them drawn in space,
half laid down in order with each crossing then exchanged once in seven times. Who is right is
said by the certificates, which a checker replays that shares nothing with what found them, and
apart from that by curves whose knots are known: ones that only climb, and knots of the tables,
both turned at random.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.harness import Row, median, share
from benchmarks.knot_truth import visits_of
from perception.cable.topology import Knottedness, Strand, close_over, curve_crossings
from perception.cable.topology.certificate import certify
from perception.cable.topology.checker import replay
from perception.cable.topology.rule import knot_intervals

Floats = NDArray[np.float64]

SEED = 980_001
FEWEST, MOST = 4, 20
EXCHANGED = 0.15
KNOWN_KNOTS = ((2, 3, 3), (2, 5, 5), (2, 7, 7), (3, 4, 4), (3, 2, 4))


@dataclass(frozen=True, slots=True)
class Answer:
    """What was said about one curve.

    Attributes:
        state: The verdict.
        proved: What its certificate proves when it is replayed.
        rule: Whether the thesis's rule sees a knot.
        seconds: Time of verdict and certificate.
    """

    state: Knottedness
    proved: Knottedness
    rule: bool
    seconds: float


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Judge 2,000 random curves (200 when quick), and a quarter as many of either known kind."""
    wanted = 200 if quick else 2000
    rng = np.random.default_rng([SEED, seed])
    answers = [answer(random_strand(rng, laid=bool(k % 2))) for k in range(wanted)]
    unknots = [a for a in answers if a.proved is Knottedness.UNKNOT]
    knots = [a for a in answers if a.proved is Knottedness.KNOTTED]
    climbing = [answer(turned(rng, climbing_curve(rng))) for _ in range(wanted // 4)]
    tied = [answer(turned(rng, known_knot(rng))) for _ in range(wanted // 4)]
    everything = answers + climbing + tied
    milliseconds = [1e3 * a.seconds for a in answers]
    return [
        share("false_knots", _said(unknots, Knottedness.KNOTTED), len(unknots), "= 0"),
        share("missed_knots", _said(knots, Knottedness.UNKNOT), len(knots), "= 0"),
        share("undecided", _said(answers, Knottedness.UNDECIDED), wanted, "= 0"),
        share(
            "certificates_replayed",
            sum(a.proved is a.state for a in everything),
            len(everything),
            "= 1",
        ),
        share("false_knots_known", _said(climbing, Knottedness.KNOTTED), len(climbing), "= 0"),
        share("missed_knots_known", _said(tied, Knottedness.UNKNOT), len(tied), "= 0"),
        median("median_ms", milliseconds, "ms", "< 2"),
        Row("worst_ms", max(milliseconds), "ms", wanted, max(milliseconds), max(milliseconds)),
        share("rule_false_knots", sum(a.rule for a in unknots), len(unknots)),
        share("rule_missed_knots", sum(not a.rule for a in knots), len(knots)),
    ]


def _said(answers: Sequence[Answer], state: Knottedness) -> int:
    return sum(a.state is state for a in answers)


def answer(strand: Strand) -> Answer:
    """Judge one open curve."""
    diagram = close_over(strand)
    began_s = time.perf_counter()
    verdict, certificate = certify(diagram)
    seconds = time.perf_counter() - began_s
    proved = Knottedness.UNDECIDED
    if certificate is not None:
        proved = replay(diagram, certificate).state
    return Answer(verdict.state, proved, bool(knot_intervals(visits_of(strand))), seconds)


def random_strand(rng: np.random.Generator, *, laid: bool) -> Strand:
    """Draw an open curve with 4 to 20 crossings."""
    while True:
        nodes = rng.normal(size=(int(rng.integers(6, 13)), 3))
        if laid:
            nodes[:, 2] = np.arange(len(nodes))
        strand = curve_crossings(nodes)
        if FEWEST <= len(strand.crossings) <= MOST:
            return _exchanged(rng, strand) if laid else strand


def _exchanged(rng: np.random.Generator, strand: Strand) -> Strand:
    """Return the curve with some of its crossings exchanged."""
    crossings = tuple(
        replace(c, first_over=c.first_over != bool(rng.random() < EXCHANGED))
        for c in strand.crossings
    )
    return replace(strand, crossings=crossings)


def climbing_curve(rng: np.random.Generator) -> Floats:
    """Return a curve in space that only climbs, which is never knotted."""
    nodes = rng.normal(size=(int(rng.integers(8, 14)), 3))
    nodes[:, 2] = np.arange(len(nodes))
    return nodes


def known_knot(rng: np.random.Generator, count: int = 160) -> Floats:
    """Return a torus knot T(2, 3), T(2, 5), T(2, 7) or T(3, 4), or a figure-8 knot."""
    t = np.linspace(0.0, 2.0 * np.pi, count)[:-1]
    # Turns round the middle, waves in and out, waves up and down; figure-8 is (3, 2, 4).
    around, across, upwards = KNOWN_KNOTS[int(rng.integers(len(KNOWN_KNOTS)))]
    ring = 2.0 + np.cos(across * t)
    return np.column_stack(
        [ring * np.cos(around * t), ring * np.sin(around * t), np.sin(upwards * t)]
    )


def turned(rng: np.random.Generator, nodes: Floats) -> Strand:
    """Return a curve, joined to a ring that is cut at one place, as seen from any side."""
    # So narrow a gap that no strand is seen to pass through it.
    ring = np.vstack([nodes, nodes[0] + 1e-6 * (nodes[-1] - nodes[0])])
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    rotation[:, 0] *= np.linalg.det(rotation)
    return curve_crossings(ring @ rotation)
