"""What a search believes: which objects stand where, and where the target may be."""

from collections.abc import Mapping
from dataclasses import dataclass

from perception.rgbd import ColourImage
from perception.shelf.types import Bools, Box, Floats, Size

# `SeenObject.number` of an object that the latest view does not show.
OUT_OF_VIEW = -1


@dataclass(frozen=True, slots=True, eq=False)
class SeenObject:
    """One object that has been seen.

    Attributes:
        label: The name that it most likely has; `unknown 1` and so on where it has none.
        certainty: Probability of that name.
        probabilities: Of each name of the stock, from its best reading so far, shape (N,).
        box: Where it stands, as far as its known size completes what is seen.
        sure: The part of that box that is there whatever is hidden of it.
        loose_m: How far along x and y the box may stand elsewhere, to either side.
        first: Where it stood when it was first seen.
        number: Which segment of the latest detections shows it, or `OUT_OF_VIEW`.
        share: How much of it the latest view shows, in [0, 1].
        measured: How much of it the view showed in which its box was measured.
    """

    label: str
    certainty: float
    probabilities: Floats
    box: Box
    sure: Box
    loose_m: tuple[float, float]
    first: Box
    number: int
    share: float
    measured: float


@dataclass(frozen=True, slots=True)
class Refusal:
    """A way in which an object could not be moved from where it stood.

    Attributes:
        label: The object.
        box: Where it stood.
        sign: +1 for a push along x, -1 for one against it, 0 for the cup.
        lasting: Whether it holds wherever the object stands.
    """

    label: str
    box: Box
    sign: int
    lasting: bool


@dataclass(frozen=True, slots=True, eq=False)
class ShelfBelief:
    """Everything that a search knows; each look and each move gives a new one.

    Attributes:
        target: Name of what is searched for.
        target_m: Its size.
        objects: What has been seen and is still there.
        places_m: Cells of the floor in which the target's centre may be, shape (K, 2).
        plausible: How far looks have left it possible there, in (0, 1], shape (K,).
        weights: Probability of each cell, shape (K,); adds up to 1.
        belied: Share of its face by which a target in each cell should have shown in some look, by
            where everything was thought to stand, and did not, shape (K,).
        organisation: Estimated share of objects that stand where they belong, in [0, 1].
        unseen: Where a small thing may stand that no look has shown; see `planning.exploring`.
        floor: Which cells of the floor are known to be free, shape (nx, ny).
        met: Footprints of what moves have met and nothing seen explains, shape (M, 4).
        been: Where objects were moved from, or could not be moved to, label and box, in order.
        refusals: What could not be moved how, as far as that still holds.
        picture: The latest look with the belief drawn over it.
        looks: Looks so far.
    """

    target: str
    target_m: Size
    objects: tuple[SeenObject, ...]
    places_m: Floats
    plausible: Floats
    weights: Floats
    belied: Floats
    organisation: float
    unseen: Bools
    floor: Bools
    met: Floats
    been: tuple[tuple[str, Box], ...]
    refusals: tuple[Refusal, ...]
    picture: ColourImage
    looks: int

    @property
    def found(self) -> SeenObject | None:
        """The target, when it is in view or was seen to stand where it is."""
        return next((one for one in self.objects if one.label == self.target), None)

    @property
    def boxes(self) -> Mapping[str, Box]:
        """Where everything seen stands now."""
        return {one.label: one.box for one in self.objects}

    @property
    def first(self) -> Mapping[str, Box]:
        """Where everything seen stood at first, the target left out."""
        return {one.label: one.first for one in self.objects if one.label != self.target}


@dataclass(frozen=True, slots=True)
class SearchClaim:
    """What a mission says at its end.

    Attributes:
        target: Name of what was searched for.
        found: Whether it says that it has seen it.
        retrieved: Whether it says that it has taken it out.
        certainty: Probability that what it has seen is the target.
    """

    target: str
    found: bool
    retrieved: bool
    certainty: float
