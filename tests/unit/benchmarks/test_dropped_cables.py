import numpy as np
import pytest

from benchmarks.dropped_cables import BIGHT, BIGHT_OVER, LENGTHS, draw_tier
from perception.cable.topology import Diagram, StrandCrossing
from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.curve import Strand, close_over, self_intersections
from perception.training.waypoints import resample, through


def _joined_square_knot() -> Diagram:
    """Both bights, joined over the top and under the bottom to one closed curve."""
    first, second = through(10.0 * BIGHT, 0.8), through(-10.0 * BIGHT, 0.8)
    above, below = ([[-40.0, y], [40.0, y]] for y in (40.0, -40.0))
    # The first ends below on the left, the second one begins there on the right.
    ring = np.vstack([first, resample(np.array(below)), second, resample(np.array(above[::-1]))])
    a, b, turn = self_intersections(ring)
    visits = sorted([(at, k) for k, at in enumerate(a)] + [(at, k) for k, at in enumerate(b)])
    # The first six visits are those of the first bight, whose order the knot prescribes.
    over = {k: on_top for (_, k), on_top in zip(visits[:6], BIGHT_OVER, strict=True)}
    crossings = [
        StrandCrossing(float(a[k]), float(b[k]), int(turn[k]), over[k]) for k in range(len(a))
    ]
    return close_over(Strand(ring, tuple(sorted(crossings, key=lambda c: c.first))))


def test_the_square_knot_is_one():
    diagram = _joined_square_knot()
    assert len(diagram) == 6
    assert diagram.is_planar()
    # The sum of a left and a right trefoil: squared polynomial, and as many crossings of
    # either sign; the granny knot, its false friend, has six of one.
    assert alexander_polynomial(diagram) == (1, -2, 3, -2, 1)
    assert sum(diagram.signs) == 0


@pytest.mark.parametrize("tier", ["B1", "B2", "B3"])
def test_cables_of_a_tier_are_whole_and_in_view(tier):
    scene = draw_tier(np.random.default_rng([3, 1]), tier)
    size = np.array(scene.image.shape[::-1])
    for cable, length in zip(scene.cables, LENGTHS, strict=True):
        assert len(cable.points_px) / 2.0 == pytest.approx(length, rel=0.1)
        assert (cable.points_px > 0.0).all()
        assert (cable.points_px < size).all()
    assert len(scene.crossings) > 4
