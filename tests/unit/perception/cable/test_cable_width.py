import cv2
import numpy as np
import pytest

from perception.cable.width import cable_width, width_across


def _drawn(width_px, bright=True, slab=False):
    """Draw a slanted cable; returns image and centre line."""
    line = np.array([[30.0, 40.0], [270.0, 160.0]])
    image = np.full((200, 300), 60.0 if bright else 190.0, np.float32)
    if slab:
        # Something wide and bright that no cable lies on.
        image[:, :20] = 200.0
    fixed = np.round(line * 16).astype(np.int32)[:, None]
    cv2.polylines(image, [fixed], False, 170.0 if bright else 60.0, width_px, cv2.LINE_AA, 4)
    image += np.random.default_rng(1).normal(0.0, 2.0, image.shape)
    places = np.linspace(0.2, 0.4, 6)[:, None]
    return image.clip(0, 255).astype(np.uint8), line[0] + places * (line[1] - line[0])


@pytest.mark.parametrize("bright", [True, False])
@pytest.mark.parametrize("width_px", [5, 9, 13])
def test_the_profile_gives_the_width(width_px, bright):
    image, start = _drawn(width_px, bright)
    assert width_across(image, start) == pytest.approx(width_px + 1.0, abs=2.0)
    assert cable_width(image, start) == pytest.approx(width_px + 1.0, rel=0.25)


def test_no_cable_has_no_width():
    image = np.random.default_rng(0).normal(80.0, 3.0, (120, 160)).clip(0, 255).astype(np.uint8)
    assert width_across(image, np.array([[40.0, 50.0], [70.0, 60.0]])) is None
