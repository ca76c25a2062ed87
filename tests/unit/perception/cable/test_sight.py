import cv2
import numpy as np
import pytest

pytest.importorskip("torch")

pytest.importorskip("safetensors.torch")

from executive.core.errors import InputError
from perception.cable.parts import SIGHT
from perception.cable.sight.scales import BEST_PX, better_scale
from perception.cable.sight.sight import Sight
from perception.models.sight_input import CHANNELS, MULTIPLE, prepare
from perception.models.store import FOLDER

# What OpenCV draws with a thickness of 7 and smooth borders, by area over length.
WIDTH_PX = 8.8
ENDS = np.array([[120.0, 90.0], [380.0, 260.0]])


@pytest.fixture(scope="module")
def sight():
    return Sight(FOLDER / SIGHT)


def _drawn(cable=190.0, table=50.0, width=7, seed=0):
    """Draw a loose S from one end to the other, without connectors."""
    t = np.linspace(0.0, 1.0, 200)[:, None]
    line = ENDS[0] + t * (ENDS[1] - ENDS[0])
    line = line + np.sin(2.0 * np.pi * t) * np.array([40.0, -60.0])
    image = np.full((352, 480), table, np.float32)
    fixed = np.round(line * 8).astype(np.int32)[:, None]
    cv2.polylines(image, [fixed], False, cable, width, cv2.LINE_AA, 3)
    truth = image != table
    image = cv2.GaussianBlur(image, (0, 0), 0.7)
    image += np.random.default_rng(seed).normal(0.0, 2.0, image.shape)
    return image.clip(0, 255).astype(np.uint8), truth


def _overlap(seen, truth):
    return (seen & truth).sum() / (seen | truth).sum()


def _gaps(seen, places):
    found = np.array([end.position_px for end in seen.endpoints]).reshape(-1, 2)
    return np.linalg.norm(found[:, None] - places[None], axis=2)


@pytest.mark.parametrize(("cable", "table"), [(190.0, 50.0), (40.0, 200.0), (120.0, 85.0)])
def test_sees_cable_and_both_ends_bright_or_dark_or_faint(sight, cable, table):
    image, truth = _drawn(cable, table)
    seen = sight.look(image)
    assert _overlap(seen.cable_pixels, truth) > 0.7
    assert seen.width_px == pytest.approx(WIDTH_PX, rel=0.3)
    gaps = _gaps(seen, ENDS)
    assert gaps.shape == (2, 2)
    assert gaps.min(axis=0).max() < 10.0
    for end, nearest in zip(seen.endpoints, gaps.argmin(axis=1), strict=True):
        inwards = ENDS[1 - nearest] - ENDS[nearest]
        assert np.linalg.norm(end.direction) == pytest.approx(1.0)
        assert 0.5 <= end.probability <= 1.0
        x, y = np.round(ENDS[nearest] + 10.0 * end.direction).astype(int)
        assert truth[y - 4 : y + 5, x - 4 : x + 5].any(), inwards


def test_what_is_seen_turns_with_the_mirror(sight):
    image, _ = _drawn()
    plain, mirrored = sight.look(image), sight.look(np.ascontiguousarray(image[:, ::-1]))
    assert _overlap(plain.cable_pixels, mirrored.cable_pixels[:, ::-1]) > 0.8
    places = np.array([end.position_px for end in plain.endpoints])
    places[:, 0] = image.shape[1] - 1 - places[:, 0]
    assert _gaps(mirrored, places).min(axis=0).max() < 6.0


@pytest.mark.parametrize("scale", [3.0, 0.5])
def test_sees_cables_of_other_widths_by_another_look(sight, scale):
    image, truth = _drawn()
    size = (round(480 * scale), round(352 * scale))
    way = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_CUBIC
    other = cv2.resize(image, size, interpolation=way)
    seen = sight.look(other)
    assert seen.cable.shape == seen.connector.shape == other.shape
    assert seen.width_px == pytest.approx(WIDTH_PX * scale, rel=0.35)
    assert _gaps(seen, (ENDS + 0.5) * scale - 0.5).min(axis=0).max() < 10.0 * max(scale, 1.0)
    wanted = cv2.resize(truth.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST) > 0
    assert _overlap(seen.cable_pixels, wanted) > 0.6


@pytest.mark.parametrize("grey", [0, 60, 255])
def test_sees_nothing_on_an_empty_table(sight, grey):
    noise = np.random.default_rng(1).normal(0.0, 2.0, (300, 400))
    seen = sight.look((grey + noise).clip(0, 255).astype(np.uint8))
    assert seen.width_px is None
    assert seen.endpoints == ()
    assert seen.tangles == ()
    assert seen.cable_pixels.mean() < 1e-3


def test_cable_that_leaves_the_view_has_no_end_there(sight):
    image, _ = _drawn()
    left = np.ascontiguousarray(image[:, :300])
    seen = sight.look(left)
    assert len(seen.endpoints) == 1
    assert _gaps(seen, ENDS[:1]).max() < 10.0


def test_the_same_image_gives_the_same_answer(sight):
    image, _ = _drawn()
    first, again = sight.look(image), Sight(FOLDER / SIGHT).look(image.copy())
    assert (first.cable == again.cable).all()
    assert [end.probability for end in first.endpoints] == [
        end.probability for end in again.endpoints
    ]


@pytest.mark.parametrize(
    "image",
    [
        np.zeros((200, 200), np.float32),
        np.zeros((200, 200, 3), np.uint8),
        np.zeros((10, 200), np.uint8),
        [[1, 2], [3, 4]],
    ],
)
def test_anything_but_a_grey_image_is_refused(sight, image):
    with pytest.raises(InputError, match=r"sight: image: got shape .* expected a grey image"):
        sight.look(image)


@pytest.mark.parametrize("shape", [(64, 64), (65, 97), (100, 40)])
def test_inputs_are_padded_and_know_no_brightness(shape):
    image = np.random.default_rng(2).integers(60, 120, shape).astype(np.uint8)
    maps = prepare(image)
    assert maps.shape[0] == CHANNELS
    assert maps.shape[1] % MULTIPLE == maps.shape[2] % MULTIPLE == 0
    assert np.allclose(maps, prepare(image + 50), atol=1e-3)
    # Twice the contrast looks the same, where there is contrast at all.
    assert np.allclose(maps, prepare(image * 2), atol=1e-3)


def test_other_scales_are_asked_for_only_where_widths_are_unusual():
    shape = (700, 1000)
    assert better_scale(1.0, 7.0, shape) is None
    assert better_scale(1.0, 20.0, shape) == pytest.approx(BEST_PX / 20.0)
    assert better_scale(1.0, 3.0, (400, 500)) == pytest.approx(2.0)
    assert better_scale(0.4, 20.0, shape) is None
    assert better_scale(1.0, None, shape) is None
    assert better_scale(1.0, None, (1500, 2000)) == pytest.approx(0.5)
