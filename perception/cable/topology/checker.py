"""Replay certificates. Shares with what finds them only how diagrams are written down.

A move lifts a run, neighbouring visits that are all over or all under, and lays it elsewhere.
What is left of the diagram is an open curve. Its image is connected, so its signed code says
how it lies on the sphere, up to deformation; and two ways of laying a strand over (or under)
everything, from one end of the curve to the other, can be slid into each other. So it is
enough that both diagrams lie on the sphere, and are alike without their runs.

What a move is called is held to its faces: Reidemeister I takes out a face with one edge, II one
with two, and III turns one with three round a crossing; all others are pass moves.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import comb

from perception.cable.topology.certificate import Certificate, Colouring
from perception.cable.topology.diagram import Diagram
from perception.cable.topology.moves import MoveKind, Step
from perception.cable.topology.polynomial import Laurent
from perception.cable.topology.verdict import Knottedness

Visits = list[tuple[int, bool]]
# An edge as it is walked: the visit it is left from, and whether forwards (1) or backwards (-1).
Half = tuple[int, int]
# Opening all crossings in all ways takes twice as long with each.
MOST_OPENED = 16


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
    if certificate.jones is not None:
        flaw = _misadded(diagram, certificate.jones)
        return Checked(Knottedness.UNDECIDED if flaw else Knottedness.KNOTTED, flaw)
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
    kind = _kind(before, step, fresh)
    return "" if step.kind is kind else f"it is called {step.kind} and is {kind}"


def _kind(before: Diagram, step: Step, fresh: int) -> MoveKind:
    """Return what a sound move is called that lays its run along `fresh` edges."""
    count = len(before.visits)
    first, shape = step.run.start % count, (step.run.length, fresh)
    edges = [{_edge(half, count) for half in face} for face in _faces(before)]
    if shape == (1, 0) and ({first} in edges or {(first - 1) % count} in edges):
        return MoveKind.REIDEMEISTER_1
    if shape == (2, 0) and any(first in face and len(face) == 2 for face in edges):
        return MoveKind.REIDEMEISTER_2
    if shape == (2, 2):
        _, rest_before = _parted(before, first, 2)
        _, rest_after = _parted(step.after, 0, 2)
        triangles = _triangles(before, first, rest_before)
        turned = {(far, not on_top) for far, on_top in _triangles(step.after, 0, rest_after)}
        if triangles & turned:
            return MoveKind.REIDEMEISTER_3
    return MoveKind.PASS


def _triangles(diagram: Diagram, first: int, rest: Visits) -> set[tuple[int, bool]]:
    """Return the corner opposite of a run of two visits in each triangle that has it as a side.

    Returns:
        The name of the corner in what the run leaves, and whether the strand that the run meets
        first is on top there.
    """
    names: dict[int, int] = {}
    for crossing, _ in rest:
        names.setdefault(crossing, len(names))
    count, found = len(diagram.visits), set()
    for face in _faces(diagram):
        for k in range(3 * (len(face) == 3)):
            side, second, third = face[k], face[(k + 1) % 3], face[(k + 2) % 3]
            far = names.get(diagram.visits[third[0]])
            if _edge(side, count) == first and far is not None:
                met_first = third[0] if side[1] > 0 else sum(second) % count
                found.add((far, diagram.over[met_first]))
    return found


def _edge(half: Half, count: int) -> int:
    """Return the edge of a half: the visit that it leaves forwards."""
    visit, way = half
    return visit if way > 0 else (visit - 1) % count


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
    """Say whether each crossing is met once on top and once below, and Euler's formula holds."""
    crossings = len(diagram.signs)
    met = sorted(zip(diagram.visits, diagram.over, strict=True))
    if met != list(product(range(crossings), (False, True))):
        return False
    return not crossings or len(_faces(diagram)) == crossings + 2


def _faces(diagram: Diagram) -> list[list[Half]]:
    """Return the faces, walking round corners of the four-valent map.

    Half-edges leave each crossing, counter-clockwise: over outwards, then the under strand's
    way out where the crossing is positive (its way in where negative), over backwards, and the
    other of the under strand.
    """
    count = len(diagram.visits)
    place = {(c, on_top): k for k, (c, on_top) in _numbered(diagram)}
    following: dict[Half, Half] = {}
    for crossing, sign in enumerate(diagram.signs):
        over, under = place[crossing, True], place[crossing, False]
        corners = [(over, 1), (under, sign), (over, -1), (under, -sign)]
        for k in range(4):
            following[corners[k]] = corners[(k + 1) % 4]
    faces, seen = list[list[Half]](), set[Half]()
    for half in following:
        face = []
        while half not in seen:
            seen.add(half)
            face.append(half)
            visit, way = half
            half = following[(visit + way) % count, -way]
        faces += [face] if face else []
    return faces


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


def _misadded(diagram: Diagram, claimed: Laurent) -> str:
    """Return what is wrong with a Jones polynomial other than 1, empty for nothing.

    All crossings are opened in all ways at once, one loop count each, by the definition.
    """
    size, count = len(diagram.signs), len(diagram.visits)
    if size > MOST_OPENED:
        return f"more than {MOST_OPENED} crossings are too many to add up"
    place = {(c, on_top): k for k, (c, on_top) in _numbered(diagram)}
    writhe, powers = sum(diagram.signs), dict[int, int]()
    for openings in product((1, -1), repeat=size):
        joints = list[tuple[int, int]]()
        for crossing, opening in enumerate(openings):
            o, u = place[crossing, True], place[crossing, False]
            before_o, before_u = (o - 1) % count, (u - 1) % count
            along = opening == diagram.signs[crossing]
            joints += [(before_o, u), (before_u, o)] if along else [(before_o, before_u), (o, u)]
        for power, times in _loops_opened(_pieces(joints, count) - 1):
            power += sum(openings) - 3 * writhe
            powers[power] = powers.get(power, 0) + times * (-1) ** writhe
    found = {-power // 4: times for power, times in powers.items() if times}
    stated = {claimed.lowest + k: value for k, value in enumerate(claimed.coefficients) if value}
    if stated == {0: 1}:
        return "the unknot has this polynomial, too"
    return "" if found == stated else "the Jones polynomial is another"


def _pieces(joints: Sequence[tuple[int, int]], count: int) -> int:
    """Return how many pieces edges make when they are joined."""
    root = list(range(count))
    pieces = count
    for a, b in joints:
        while root[a] != a:
            a = root[a]
        while root[b] != b:
            b = root[b]
        pieces -= a != b
        root[a] = b
    return pieces


def _loops_opened(loops: int) -> Iterator[tuple[int, int]]:
    """Yield powers of A and coefficients of (-A^2 - A^-2)^loops."""
    for k in range(loops + 1):
        yield 4 * k - 2 * loops, (-1) ** loops * comb(loops, k)
