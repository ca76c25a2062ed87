"""The thesis's knots in one cable.

What each closes to, its ends joined over everything:

- Overhand: the trefoil 3_1. Figure 8: the figure-8 knot 4_1.
- Overhand honda, a loop knot: an overhand knot whose end comes back, and passes through the
  ear of the knot that is nearest to the loop (a honda, the eye of a lasso). Passed through
  against the weave, so that it is locked, it is 5_2; the other way round it would be the
  unknot, a loop that slips.
- Figure-8 honda, a loop knot: the same on a figure 8; 6_1, the stevedore's knot by type.
- Bowline, a loop knot: the end comes up through the nip, round behind the standing part, and
  back down through the nip. It lies inside the loop then, as it should, and leaves over the
  loop's leg; 6_3. (Had it left under the leg it would close to another knot.)
- Linked overhand: no term of the books, and the thesis does not say. It is read as two
  overhand knots along one cable that are linked: an ear of the second one passes through an
  ear of the first, like links of a chain; 8_15.

Hondas and bowline have an end that passes through: pulled out again it leaves an overhand
knot, a figure 8, and no knot.
"""

from simulation.cable.knot_names import KnotName
from simulation.cable.knots.template import Corners, KnotTemplate, told


def _mirrored(half: Corners, y_sign: float) -> Corners:
    """Continue a half curve from the origin backwards: x turns over, y by `y_sign`."""
    return (*((-x, y_sign * y) for x, y in reversed(half)), (0.0, 0.0), *half)


# The trefoil as it is tied in a rope: two lobes, mirrored left and right.
_OVERHAND_HALF = (
    (1.0, -0.25), (1.75, -1.1), (2.0, -2.2), (1.5, -2.9), (0.65, -2.6), (-0.4, -1.5), (-1.3, -0.5),
    (-2.2, 0.4), (-3.2, 1.0),
)  # fmt: skip
# The figure-eight: an S through the middle, turned into itself by half a turn.
_FIGURE_8_HALF = (
    (0.75, -0.9), (1.6, -1.5), (2.45, -1.25), (2.7, -0.2), (2.35, 1.2), (1.6, 2.3), (0.4, 2.65),
    (-0.7, 1.9), (-1.5, 0.5), (-2.4, -0.7), (-3.4, -1.5),
)  # fmt: skip
# The overhand knot with a larger left lobe; the loop hangs from that side.
_OVERHAND_HONDA = (
    (2.9, 1.1), (2.16, 0.27), (1.7, -0.26), (0.48, -1.8), (-0.23, -2.61), (-0.77, -3.76),
    (-2.77, -3.4), (-3.2, -1.61), (-2.02, -0.39), (-1.32, 0.18), (-0.13, 0.45), (1.24, -0.22),
    (1.82, -0.87), (1.94, -2.21), (1.4, -2.82), (0.58, -2.65), (-0.27, -1.56), (-1.09, -0.56),
    (-1.98, 0.42), (-3.44, 1.13), (-4.72, 0.46), (-4.88, -0.91), (-4.83, -1.77), (-4.15, -2.44),
    (-2.82, -2.35), (-1.88, -2.21), (-1.19, -2.75), (-1.06, -3.66), (-0.68, -4.88),
)  # fmt: skip
# The figure-eight, its end back through the lower lobe.
_FIGURE_8_HONDA = (
    (3.55, 1.32), (2.2, 0.69), (1.93, -0.24), (1.38, -2.66), (-0.45, -3.3), (-2.25, -3.16),
    (-2.99, -1.44), (-3.3, -0.16), (-2.6, 1.18), (-1.52, 1.44), (-0.67, 0.96), (0.09, -0.17),
    (0.59, -0.83), (1.65, -1.38), (2.39, -1.18), (2.7, -0.39), (2.45, 1.26), (1.69, 2.23),
    (0.64, 2.58), (-0.8, 1.94), (-1.46, 0.5), (-2.12, -0.42), (-3.43, -0.81), (-4.22, -2.09),
    (-4.24, -3.51), (-3.65, -4.37), (-2.27, -3.94), (-1.78, -2.51), (-1.18, -1.67), (-0.36, -1.64),
    (0.32, -2.61), (0.5, -3.78), (0.86, -5.25),
)  # fmt: skip
# Down the standing part, once round the nip, round the loop, up and back.
_BOWLINE = (
    (1.35, 5.3), (1.1, 3.52), (0.35, 1.81), (0.03, 0.78), (-0.19, -0.54), (0.34, -1.82),
    (1.28, -2.67), (3.8, -1.75), (3.23, 0.63), (1.76, 0.86), (-0.12, 1.68), (-1.76, 1.78),
    (-3.12, 0.87), (-3.56, -1.71), (-3.26, -4.43), (-1.38, -4.74), (0.1, -4.75), (2.55, -3.98),
    (3.12, -2.11), (2.74, 0.37), (2.15, 2.48), (0.95, 3.43), (0.01, 3.51), (-0.69, 3.16),
    (-1.63, 2.17), (-1.73, 1.32), (-0.92, -0.18), (0.52, -0.84), (1.05, -2.12), (0.37, -3.12),
    (-0.78, -3.66), (-3.56, -3.58), (-5.15, -3.08),
)  # fmt: skip
# From above the middle through the right one of two overhand knots.
_LINKED_HALF = (
    (1.14, 0.22), (1.75, -0.39), (1.9, -1.67), (2.85, -2.92), (3.9, -2.79), (4.3, -2.08),
    (4.33, -1.19), (4.1, -0.2), (2.91, 0.35), (1.63, 0.16), (0.46, -0.99), (-0.21, -1.82),
    (-0.64, -2.47), (-0.29, -3.77), (1.77, -4.62), (3.45, -2.1), (3.91, -0.62), (4.65, -0.02),
    (5.76, 1.01),
)  # fmt: skip

# All but the bowline alternate: over and under take turns.
TEMPLATES: dict[KnotName, KnotTemplate] = {
    "overhand": KnotTemplate(_mirrored(_OVERHAND_HALF, 1.0), told("OU" * 3), 4.0, 1.97, "3_1"),
    "figure_8": KnotTemplate(_mirrored(_FIGURE_8_HALF, -1.0), told("OU" * 4), 5.4, 2.47, "4_1"),
    "overhand_honda": KnotTemplate(_OVERHAND_HONDA, told("OU" * 5), 6.88, 2.09, "5_2"),
    "bowline": KnotTemplate(_BOWLINE, told("OUUOOUOUUUOUOOUO"), 8.30, 2.02, "6_3"),
    "linked_overhand": KnotTemplate(
        _mirrored(_LINKED_HALF, 1.0), told("OU" * 8), 8.68, 2.16, "8_15"
    ),
    "figure_8_honda": KnotTemplate(_FIGURE_8_HONDA, told("OU" * 6), 7.02, 2.25, "6_1"),
}
