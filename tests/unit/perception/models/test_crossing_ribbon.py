import numpy as np
import pytest

from perception.models.crossing_ribbon import (
    ALONG,
    CHANNELS,
    DISTANCE,
    GREY,
    MARGIN,
    ON_CABLE,
    WIDTH,
    make_ribbons,
)
from perception.models.frames import ScaledImage, scale_image

SIDE = 160
MIDDLE = SIDE / 2.0
ALONG_UNITS = np.arange(ALONG + 2 * MARGIN) - (ALONG // 2 + MARGIN)


def _paths():
    """Return a strand along x and one along y that cross in the middle, shape (1, 2, K, 2)."""
    still = np.full(len(ALONG_UNITS), MIDDLE)
    along_x = np.column_stack([MIDDLE + ALONG_UNITS, still])
    return np.stack([along_x, along_x[:, ::-1]])[None]


def _cross(table: float, cable: float) -> ScaledImage:
    """Return a cross whose upper strand, along x, is ten grey values brighter."""
    image = np.full((SIDE, SIDE), table, np.uint8)
    low, high = int(MIDDLE - WIDTH / 2), int(MIDDLE + WIDTH / 2)
    image[:, low:high] = cable
    image[low:high] = cable + 10
    return scale_image(image, WIDTH, WIDTH, 1.0)


def test_what_differs_on_cables_stays_as_large_however_bright_the_table_is():
    pairs = [make_ribbons(_cross(table, 60.0), _paths())[0] for table in (10, 40)]
    on_cable = [pair[:, ON_CABLE, :, 10:15] for pair in pairs]
    assert np.allclose(*on_cable, atol=0.05)
    contrast = [np.ptp(pair[:, GREY, :, 10:15]) for pair in pairs]
    assert contrast[1] > 1.3 * contrast[0]


@pytest.mark.parametrize("channel", [GREY, ON_CABLE])
def test_dark_cables_on_a_bright_table_look_as_bright_ones_on_a_dark_table(channel):
    bright = make_ribbons(_cross(20.0, 100.0), _paths())
    mirrored = ScaledImage(255 - _cross(20.0, 100.0).pixels, 1.0, 1.0)
    dark = make_ribbons(mirrored, _paths())
    assert np.allclose(bright[:, :, channel], dark[:, :, channel], atol=1e-3)


def test_each_ribbon_runs_along_its_strand_and_knows_where_the_other_is():
    ribbons = make_ribbons(_cross(20.0, 100.0), _paths())
    assert ribbons.shape[:3] == (1, 2, CHANNELS)
    upper, lower = ribbons[0, :, GREY]
    # The upper strand is as bright all along its middle, the lower one brighter at the crossing.
    assert np.ptp(upper[:, 12]) < 0.1
    assert np.ptp(lower[:, 12]) > 0.1
    assert abs(ribbons[0, 0, DISTANCE, ALONG // 2, 12]) < 0.1
