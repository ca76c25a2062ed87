import cv2
import numpy as np
import pytest

from perception.cable.observation import observe
from perception.cable.polyline import arc_lengths
from perception.cable.tracers.stretches import Stretches, stretches_px
from perception.models.frames import ScaledImage
from perception.models.tracer_crop import STEP

WIDTH_PX = 6.0


def _drawn(*lines):
    image = np.full((300, 420), 40.0, np.float32)
    for line in lines:
        fixed = np.round(line * 8).astype(np.int32)[:, None]
        cv2.polylines(image, [fixed], False, 200.0, int(WIDTH_PX), cv2.LINE_AA, 3)
    image += np.random.default_rng(0).normal(0.0, 2.0, image.shape)
    return image.clip(0, 255).astype(np.uint8)


def _line(start, stop):
    return np.linspace(start, stop, 200)


ROW = _line((20.0, 150.0), (400.0, 150.0))
COLUMN = _line((210.0, 20.0), (210.0, 280.0))


def _found(*lines):
    observation = observe(_drawn(*lines))
    assert observation is not None
    return stretches_px(observation)


def test_strands_are_gone_along_up_to_where_others_cross():
    found = _found(ROW, COLUMN)
    assert len(found) == 4
    for line in found:
        # On one of both, and away from the crossing and from the ends.
        aside = np.minimum(np.abs(line[:, 1] - 150.0), np.abs(line[:, 0] - 210.0))
        assert aside.max() < 1.5
        assert np.linalg.norm(line - (210.0, 150.0), axis=1).min() > 4.0 * WIDTH_PX


@pytest.mark.parametrize(("apart_px", "alone"), [(8.0, False), (40.0, True)])
def test_a_strand_beside_another_one_is_left_to_the_network(apart_px, alone):
    beside, lonely = ROW + np.array([0.0, apart_px]), _line((20.0, 40.0), (400.0, 60.0))
    found = [line for line in _found(ROW, beside, lonely, lonely + 200.0) if line[0, 1] > 100.0]
    along = [line for line in found if abs(line[0, 1] - 150.0) < apart_px + 5.0]
    length_px = sum(float(arc_lengths(line)[-1]) for line in along)
    assert length_px > 500.0 if alone else length_px == 0.0


def _stretches():
    scaled = ScaledImage(np.zeros((300, 420), np.uint8), 1.0, 0.0)
    return Stretches([ROW[20:-20]], scaled)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_path_on_a_stretch_goes_on_to_its_end_in_even_steps(way):
    here = np.array([[210.0 - way * STEP, 151.0], [210.0, 149.0]])
    ahead = _stretches().ahead(here)
    far = ROW[-21, 0] if way > 0 else ROW[20, 0]
    assert abs(ahead[-1, 0] - far) <= STEP
    assert np.diff(ahead[:, 0]) * way == pytest.approx(STEP)
    assert (ahead[0, 0] - here[-1, 0]) * way == pytest.approx(STEP, abs=3.0)


@pytest.mark.parametrize(
    "here",
    [
        [[210.0, 140.0], [210.0, 149.0]],  # Across it.
        [[201.0, 158.0], [210.0, 158.0]],  # Beside it.
        [[28.0, 150.0], [37.0, 150.0]],  # Before it.
    ],
)
def test_a_path_that_is_not_on_a_stretch_is_left_alone(here):
    assert len(_stretches().ahead(np.array(here))) == 0
