"""What starting configurations have in common: how large, how tangled, where they lie."""

from dataclasses import dataclass

from simulation.cable.layout import Area

# What both arms can reach with their grippers pointing down.
REACHABLE = Area((-0.40, -0.20), (0.40, 0.17))


@dataclass(frozen=True, slots=True)
class ConfigurationRules:
    """What starting configurations have in common.

    Attributes:
        length_m: Length of the cable.
        diameter_m: Smallest and largest size of the knot; one that has no room for its crossings
            is laid somewhat larger.
        place: Between which fractions of the cable's length the (first) knot lies.
        area: Where the arms reach, and all of the cable lies.
        most_crossings: Most crossings of the whole cable; where the knot alone takes up as many,
            there may be one more than it has.
        shortest_end_m: Least length of a free end.
        still_m: No node moves farther once the cable is let go again. Tight knots, whose strands
            press upon each other, are let go several times until this holds.
        least_crossings: Least crossings of the whole cable.
        tails: Where the free ends lie; None for `area`.
        between_m: Least and greatest length of cable from one knot to the next.
        view: What is seen of the table where one end leaves it; None where none does.
        out_m: Least and greatest length of cable that is out of the view.
        drop_m: From how high the cable is dropped.
    """

    length_m: float = 3.0
    diameter_m: tuple[float, float] = (0.10, 0.20)
    place: tuple[float, float] = (0.25, 0.75)
    area: Area = REACHABLE
    most_crossings: int = 6
    shortest_end_m: float = 0.25
    still_m: float = 1.5e-3
    least_crossings: int = 0
    tails: Area | None = None
    between_m: tuple[float, float] = (0.10, 0.45)
    view: Area | None = None
    out_m: tuple[float, float] = (0.04, 0.35)
    drop_m: float = 0.0
