"""Replay certificates. Shares with what finds them only how diagrams are written down.

A move lifts a run, neighbouring visits that are all over or all under, and lays it elsewhere.
What is left of the diagram is an open curve. Its image is connected, so its signed code says
how it lies on the sphere, up to deformation; and two ways of laying a strand over (or under)
everything, from one end of the curve to the other, can be slid into each other. So it is
enough that both diagrams lie on the sphere, and are alike without their runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from perception.cable.topology.certificate import Certificate, Colouring
from perception.cable.topology.diagram import Diagram
from perception.cable.topology.simplify import Step
from perception.cable.topology.verdict import Knottedness

Visits = list[tuple[int, bool]]


@dataclass(frozen=True, slots=True)
class Checked:
    """What a certificate proves.

    Attributes:
        state: Unknot or knotted; undecided where it proves nothing.
        flaw: What is wrong with it, empty for nothing.
    """

    state: Knottedness
    flaw: str = ""


def replay(diagram: Diagram, certificate: Certificate) -> Checked:
    """Return what a certificate proves about a diagram."""
    if not _lies_on_sphere(diagram):
        return Checked(Knottedness.UNDECIDED, "the diagram does not lie on the sphere")
    for number, step in enumerate(certificate.steps):
        flaw = _flaw(diagram, step)
        if flaw:
            return Checked(Knottedness.UNDECIDED, f"move {number}: {flaw}")
        diagram = step.after
    if certificate.colouring is None:
        if diagram.visits:
            return Checked(Knottedness.UNDECIDED, "crossings are left")
        return Checked(Knottedness.UNKNOT)
    flaw = _miscoloured(diagram, certificate.colouring)
    return Checked(Knottedness.UNDECIDED if flaw else Knottedness.KNOTTED, flaw)


def _flaw(before: Diagram, step: Step) -> str:
    """Return what is wrong with a move, empty for nothing."""
    fresh = len(step.after) - len(before) + step.run.length
    if not 0 <= fresh <= len(step.after) or not 0 < step.run.length <= len(before):
        return "no run of such a length"
    if not _lies_on_sphere(step.after):
        return "its diagram does not lie on the sphere"
    lifted, rest_before = _parted(before, step.run.start, step.run.length)
    laid, rest_after = _parted(step.after, 0, fresh)
    if len({on_top for _, on_top in lifted + laid}) != 1:
        return "its run is neither all over nor all under"
    if _named(rest_before, before.signs) != _named(rest_after, step.after.signs):
        return "it changes what it should leave"
    return ""


def _parted(diagram: Diagram, start: int, length: int) -> tuple[Visits, Visits]:
    """Return a run, and what follows it without the crossings of the run."""
    code = list(zip(diagram.visits, diagram.over, strict=True))
    turned = code[start:] + code[:start]
    crossed = {crossing for crossing, _ in turned[:length]}
    return turned[:length], [visit for visit in turned[length:] if visit[0] not in crossed]


def _named(visits: Visits, signs: Sequence[int]) -> list[tuple[int, bool, int]]:
    """Return visits with crossings numbered as they are met, and their signs."""
    names: dict[int, int] = {}
    return [
        (names.setdefault(crossing, len(names)), on_top, signs[crossing])
        for crossing, on_top in visits
    ]


def _lies_on_sphere(diagram: Diagram) -> bool:
    """Count faces by Euler's formula, walking round corners of the four-valent map.

    Half-edges leave each crossing, counter-clockwise: over outwards, then the under strand's
    way out where the crossing is positive (its way in where negative), over backwards, and the
    other of the under strand.
    """
    count, crossings = len(diagram.visits), len(diagram.signs)
    if sorted(diagram.visits) != sorted([*range(crossings), *range(crossings)]):
        return False
    place = {(c, on_top): k for k, (c, on_top) in _numbered(diagram)}
    if len(place) != count:
        return False
    following: dict[tuple[int, int], tuple[int, int]] = {}
    for crossing, sign in enumerate(diagram.signs):
        over, under = place[crossing, True], place[crossing, False]
        corners = [(over, 1), (under, sign), (over, -1), (under, -sign)]
        for k in range(4):
            following[corners[k]] = corners[(k + 1) % 4]
    faces, seen = 0, set[tuple[int, int]]()
    for half in following:
        faces += half not in seen
        while half not in seen:
            seen.add(half)
            visit, way = half
            half = following[(visit + way) % count, -way]
    return not count or faces == crossings + 2


def _numbered(diagram: Diagram) -> list[tuple[int, tuple[int, bool]]]:
    return list(enumerate(zip(diagram.visits, diagram.over, strict=True)))


def _miscoloured(diagram: Diagram, colouring: Colouring) -> str:
    """Return what is wrong with a colouring, empty for nothing."""
    prime, t, colours = colouring.prime, colouring.t, colouring.colours
    if prime < 3 or any(prime % k == 0 for k in range(2, int(prime**0.5) + 1)):
        return "colours are not counted modulo an odd prime"
    if t % prime in (0, 1) or len(colours) != len(diagram):
        return "no colouring of this diagram"
    if len({colour % prime for colour in colours}) < 2:
        return "all arcs have one colour"
    arc, top, below = 0, {}, {}
    for crossing, on_top in zip(diagram.visits, diagram.over, strict=True):
        if on_top:
            top[crossing] = colours[arc]
        else:
            below[crossing] = (colours[arc], colours[(arc + 1) % len(colours)])
            arc = (arc + 1) % len(colours)
    for crossing, sign in enumerate(diagram.signs):
        enters, leaves = below[crossing] if sign > 0 else below[crossing][::-1]
        if (t * enters + (1 - t) * top[crossing] - leaves) % prime:
            return f"the colours at crossing {crossing} do not fit"
    return ""
