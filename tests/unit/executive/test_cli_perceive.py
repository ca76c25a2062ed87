"""`cellwright perceive cable`: its JSON contract, and what it says about bad images."""

import json

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from executive.app import compose
from executive.cli import main
from executive.cli.images import read_grey
from executive.core.errors import InputError
from perception.cable.types import CableScene, Crossing, Endpoint, Knot, Trace, TraceEnd

POINT = np.array([10.123456, 20.0])


class FixedVision:
    """Sees the same scene in every image."""

    def scene(self, image, start_px=None):
        self.start_px = start_px
        trace = Trace(np.array([[1.0, 2.0], [3.0, 4.0]]), TraceEnd.ENDPOINT, 0.9)
        crossing = Crossing(POINT, 0, 0.2, 0, 0.7, np.float64(0.8))
        knot = Knot(0, (0.2, 0.7), POINT, POINT, POINT, POINT, POINT)
        end = Endpoint(POINT, np.array([1.0, 0.0]), 0.95)
        return CableScene((trace,), (end,), (crossing,), (knot,), 0.75, 0.01)


@pytest.fixture
def vision(monkeypatch):
    fixed = FixedVision()
    monkeypatch.setattr(compose, "cable_vision", lambda kind: fixed)
    return fixed


@pytest.fixture
def image(tmp_path):
    path = tmp_path / "a.png"
    Image.fromarray(np.arange(4800, dtype=np.uint8).reshape(60, 80)).save(path)
    return path


def perceive(*arguments):
    return CliRunner().invoke(main.app, ["perceive", "cable", *map(str, arguments)])


def test_json_is_one_line_an_image_with_the_keys_of_the_contract(vision, image):
    result = perceive(image, image, "--json")
    assert result.exit_code == 0
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    assert len(lines) == 2
    assert lines[0] == {
        "image": str(image),
        "traces": [{"points_px": [[1.0, 2.0], [3.0, 4.0]], "end": "endpoint", "probability": 0.9}],
        "endpoints_px": [[10.12, 20.0]],
        "crossings": [
            {
                "position_px": [10.12, 20.0],
                "trace_over": 0,
                "arc_over": 0.2,
                "trace_under": 0,
                "arc_under": 0.7,
                "probability": 0.8,
            }
        ],
        "knots": [
            {
                "interval": [0.2, 0.7],
                "first_undercrossing_px": [10.12, 20.0],
                "cage_px": [10.12, 20.0],
                "pinch_px": [10.12, 20.0],
            }
        ],
        "knotted_probability": 0.75,
        "knot_types": {},
        "telling": None,
        "seconds": 0.01,
    }


def test_people_get_a_table(vision, image):
    result = perceive(image)
    assert "P(knotted)" in result.stdout
    assert "0.750" in result.stdout


def test_a_start_is_handed_on(vision, image):
    perceive(image, "--start", "31.5,24", "--json")
    assert vision.start_px.tolist() == [[31.5, 24.0]]


def test_one_bad_image_does_not_cost_the_answer_for_the_others(vision, image, tmp_path):
    result = perceive(tmp_path / "missing.png", image, "--json")
    assert result.exit_code == 2
    assert json.loads(result.stdout)["image"] == str(image)
    assert "missing.png: no such file" in result.stderr


def test_a_drawing_is_written(vision, image, tmp_path, monkeypatch):
    from perception.cable import draw

    drawn = np.zeros((60, 80, 3), np.uint8)
    monkeypatch.setattr(draw, "draw_scene", lambda image, scene: drawn)
    perceive(image, "--out", tmp_path / "out" / "b.png")
    with Image.open(tmp_path / "out" / "b.png") as written:
        assert written.size == (80, 60)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--start", "12"], "expected X,Y"),
        (["--start", "900,10"], "lies outside"),
        (["a", "--out", "b.png"], "expected one"),
    ],
)
def test_bad_arguments_exit_with_2(vision, image, arguments, message, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["cellwright", "perceive", "cable", str(image), *arguments])
    with pytest.raises(SystemExit) as end:
        main.main()
    assert end.value.code == 2
    assert message in capsys.readouterr().err


def test_colour_16_bit_and_rotated_images_become_upright_grey(tmp_path):
    grey = np.arange(4800, dtype=np.uint8).reshape(60, 80)
    Image.fromarray(np.repeat(grey[:, :, None], 3, axis=2)).save(tmp_path / "rgb.png")
    Image.fromarray(grey.astype(np.uint16) * 256).save(tmp_path / "deep.png")
    turned = Image.fromarray(np.rot90(grey))
    exif = turned.getexif()
    exif[0x0112] = 6  # shown after a quarter turn clockwise
    turned.save(tmp_path / "turned.png", exif=exif)
    for name in ("rgb.png", "deep.png", "turned.png"):
        assert np.array_equal(read_grey(tmp_path / name), grey), name


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"no image", "not an image"),
        (b"\x89PNG\r\n\x1a\n cut off", "image"),
        (None, "no such file"),
    ],
)
def test_files_that_are_no_images_are_refused(tmp_path, content, message):
    path = tmp_path / "a.png"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_grey(path)


def test_a_truncated_image_and_a_tiny_one_are_refused(tmp_path, image):
    cut = tmp_path / "cut.png"
    cut.write_bytes(image.read_bytes()[:-40])
    with pytest.raises(InputError, match=r"cut\.png"):
        read_grey(cut)
    Image.new("L", (5, 5)).save(tmp_path / "tiny.png")
    with pytest.raises(InputError, match="too small; got 5 x 5"):
        read_grey(tmp_path / "tiny.png")
