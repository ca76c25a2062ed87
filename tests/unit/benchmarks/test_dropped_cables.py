import numpy as np
import pytest

from benchmarks.dropped_cables import KNOT_WIDTHS, LENGTHS, draw_tier, draw_tier_images
from benchmarks.laying import CONFIG, laid
from benchmarks.tied_cables import tied
from perception.cable.topology import Knottedness, classify_curve
from perception.training.scenes import lay_scene


@pytest.mark.parametrize("tier", ["B1", "B2", "B3"])
def test_cables_of_a_tier_are_whole_and_in_view(tier):
    scene = draw_tier(np.random.default_rng([3, 1]), tier)
    size = np.array(scene.image.shape[::-1])
    for cable, length in zip(scene.cables, LENGTHS, strict=True):
        assert len(cable.points_px) / 2.0 == pytest.approx(length, rel=0.1)
        assert (cable.points_px > 0.0).all()
        assert (cable.points_px < size).all()
    assert len(scene.crossings) > 4


def test_three_images_show_the_same_cables_with_noise_of_their_own():
    scenes = draw_tier_images(np.random.default_rng([3, 2]), "B1")
    alone = draw_tier(np.random.default_rng([3, 2]), "B1")
    assert len(scenes) == 3
    assert np.array_equal(scenes[0].image, alone.image)
    for first, second in zip(scenes, [*scenes[1:], scenes[0]], strict=True):
        assert first.crossings == second.crossings
        for one, other in zip(first.cables, second.cables, strict=True):
            assert np.array_equal(one.points_px, other.points_px)
        gaps = first.image.astype(float) - second.image.astype(float)
        assert 0.0 < np.abs(gaps).mean() < 40.0


def test_every_cable_of_the_second_tier_is_knotted():
    scene = draw_tier(np.random.default_rng([3, 1]), "B2")
    for cable in scene.cables:
        line = np.column_stack([cable.points_px * (1.0, -1.0), cable.heights])
        assert classify_curve(line).state is Knottedness.KNOTTED


@pytest.mark.parametrize("knots", [1, 3])
def test_tied_cables_go_over_and_under_as_their_knots_say(knots):
    rng = np.random.default_rng([4, knots])
    found = None
    while found is None:
        cores, ties = tied(rng, knots, KNOT_WIDTHS)
        found = laid(rng, cores, LENGTHS, ties)
    lines, known = found
    assert 2 * len(known.pairs) == sum(len(part.over) for parts in ties for part in parts)
    assert [[part.cable for part in parts] for parts in ties] == [[0, 1], [1, 2], [0, 2]][:knots]
    starts = np.cumsum([0, *(len(line) for line in lines)])
    scene = lay_scene(rng, lines, CONFIG, known)
    seen = np.array(
        [[starts[cable] + at for cable, at in (c.over, c.under)] for c in scene.crossings]
    )
    met = 0
    for pair, first_over in known.pairs.items():
        wanted = pair if first_over else pair[::-1]
        # Parting the strands moves a crossing a little.
        right = np.abs(seen - wanted).max(axis=1).min()
        wrong = np.abs(seen[:, ::-1] - wanted).max(axis=1).min()
        assert right < 4.0 or wrong > 4.0
        met += right < 4.0
    assert met >= 0.8 * len(known.pairs)
