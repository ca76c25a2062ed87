"""Two closed curves: are they linked? Answered with a proof, or not at all.

Linked curves are told by their linking number, or by a Jones polynomial other than that of the
same two curves far apart (for unlinked ones the bracket of the pair is -A^2 - A^-2 times the
product of both, L. Kauffman 1987). Unlinked ones are told by moves that lead to a diagram in
which one curve lies over the other everywhere, so that it can be lifted off.
"""

from dataclasses import dataclass
from enum import StrEnum

from perception.cable.topology.diagram import Diagram, compact
from perception.cable.topology.jones import Ends, ends_of, writhe_free_bracket
from perception.cable.topology.moves import MoveKind
from perception.cable.topology.polynomial import Laurent

# The bracket of one more loop that crosses nothing, in A.
LOOP = Laurent(-2, (-1, 0, 0, 0, -1))
Visit = tuple[int, bool]


@dataclass(frozen=True, slots=True)
class Link:
    """Two closed curves with n crossings, of each with itself and of both.

    Attributes:
        curves: For each curve the crossings in its order, and whether it is on top there.
        signs: +1 or -1 for each crossing, by the ways that the curves run.
    """

    curves: tuple[tuple[Visit, ...], tuple[Visit, ...]]
    signs: tuple[int, ...]

    def shared(self) -> set[int]:
        """Return the crossings of one curve with the other."""
        first, second = ({crossing for crossing, _ in curve} for curve in self.curves)
        return first & second

    def curve(self, which: int) -> Diagram:
        """Return one of the curves without the other."""
        own = [visit for visit in self.curves[which] if visit[0] not in self.shared()]
        visits, over = [crossing for crossing, _ in own], [on_top for _, on_top in own]
        return compact(visits, over, dict(enumerate(self.signs)))

    def without(self, crossings: set[int]) -> "Link":
        """Return the link without some crossings; the others keep their numbers."""
        first, second = (
            tuple(visit for visit in curve if visit[0] not in crossings) for curve in self.curves
        )
        return Link((first, second), self.signs)


class Linkedness(StrEnum):
    """What is known about two closed curves."""

    LINKED = "linked"
    UNLINKED = "unlinked"
    UNDECIDED = "undecided"


class LinkProof(StrEnum):
    """Why it is known."""

    LINKING_NUMBER = "linking number"
    JONES = "jones polynomial"
    MOVES = "moves"
    NONE = "none"


@dataclass(frozen=True, slots=True)
class LinkStep:
    """Reidemeister I or II on a link.

    Attributes:
        kind: Which of them.
        crossings: What it takes out.
        after: The link after.
    """

    kind: MoveKind
    crossings: frozenset[int]
    after: Link


@dataclass(frozen=True, slots=True)
class LinkVerdict:
    """The answer for two curves.

    Attributes:
        state: Linked or not.
        proof: What proves it.
        linking_number: Half the sum of the signs where they cross.
        steps: The moves, where they are the proof; then one curve lies over the other.
    """

    state: Linkedness
    proof: LinkProof
    linking_number: int
    steps: tuple[LinkStep, ...] = ()


def classify_link(link: Link) -> LinkVerdict:
    """Say whether two closed curves are linked."""
    number = linking_number(link)
    if number:
        return LinkVerdict(Linkedness.LINKED, LinkProof.LINKING_NUMBER, number)
    steps = link_reduction(link)
    reduced = steps[-1].after if steps else link
    if lies_over(reduced):
        return LinkVerdict(Linkedness.UNLINKED, LinkProof.MOVES, number, steps)
    if link_bracket(reduced) != bracket_far_apart(reduced):
        return LinkVerdict(Linkedness.LINKED, LinkProof.JONES, number)
    return LinkVerdict(Linkedness.UNDECIDED, LinkProof.NONE, number)


def linking_number(link: Link) -> int:
    """Return how often one curve winds through the other."""
    return sum(link.signs[crossing] for crossing in link.shared()) // 2


def lies_over(link: Link) -> bool:
    """Say whether one curve is on top wherever they cross; true where they never do."""
    shared = link.shared()
    tops = {on_top for crossing, on_top in link.curves[0] if crossing in shared}
    return len(tops) < 2


def link_bracket(link: Link) -> Laurent:
    """Return the bracket of both curves times (-A^3)^-writhe, in A; they must cross."""
    place: dict[Visit, tuple[int, int]] = {}
    first_edge = 0
    for curve in link.curves:
        for k, visit in enumerate(curve):
            place[visit] = first_edge + (k - 1) % len(curve), first_edge + k
        first_edge += len(curve)
    return writhe_free_bracket(
        [
            Ends(*place[crossing, True], *place[crossing, False], link.signs[crossing])
            for crossing in sorted({crossing for crossing, _ in place})
        ]
    )


def bracket_far_apart(link: Link) -> Laurent:
    """Return what `link_bracket` would be if the same curves were not linked."""
    first, second = (writhe_free_bracket(ends_of(link.curve(which))) for which in (0, 1))
    return LOOP * first * second


def link_reduction(link: Link) -> tuple[LinkStep, ...]:
    """Return Reidemeister I and II as long as there are any."""
    steps: list[LinkStep] = []
    while (step := _first_loop(link) or _first_bigon(link)) is not None:
        steps.append(step)
        link = step.after
    return tuple(steps)


def _first_loop(link: Link) -> LinkStep | None:
    for curve in link.curves:
        for k, (crossing, _) in enumerate(curve):
            if len(curve) > 1 and curve[k - 1][0] == crossing:
                out = frozenset({crossing})
                return LinkStep(MoveKind.REIDEMEISTER_1, out, link.without(set(out)))
    return None


def _first_bigon(link: Link) -> LinkStep | None:
    place = {
        visit: (which, k)
        for which, curve in enumerate(link.curves)
        for k, visit in enumerate(curve)
    }
    for curve in link.curves:
        for k, (b, on_top) in enumerate(curve):
            a, also_on_top = curve[k - 1]
            if a == b or not (on_top and also_on_top) or link.signs[a] == link.signs[b]:
                continue
            (which_a, at_a), (which_b, at_b) = place[a, False], place[b, False]
            length = len(link.curves[which_a])
            if which_a == which_b and (at_a - at_b) % length in (1, length - 1):
                out = frozenset({a, b})
                return LinkStep(MoveKind.REIDEMEISTER_2, out, link.without(set(out)))
    return None
