"""`cellwright train`: what it writes, and what it says about what cannot be."""

import json

import pytest
from typer.testing import CliRunner

from executive.cli import main, train_folders
from executive.core.errors import InputError
from perception.training import dataset
from perception.training.dataset import read_truth


def train(*arguments):
    return CliRunner().invoke(main.app, ["train", *map(str, arguments)])


def small(out, *more):
    return train("data", "--out", out, "--size", "96x120", "--width", "5", *more)


def test_data_are_images_with_their_truth_and_contact_sheets(tmp_path):
    result = small(tmp_path / "set", "--images", 3, "--cables", 2)
    assert result.exit_code == 0, result.output
    assert "3 images" in result.stderr
    names = {path.name for path in (tmp_path / "set").iterdir()}
    assert names == {
        *("data.json", "sheet.png", "truth.png"),
        *(f"{number:06d}.{kind}" for number in range(3) for kind in ("png", "json")),
    }
    truths = [read_truth(tmp_path / "set" / f"{number:06d}.json") for number in range(3)]
    assert all(truth.size_px == (96, 120) and len(truth.cables) <= 2 for truth in truths)


def test_data_that_were_stopped_go_on_to_the_same(tmp_path, monkeypatch):
    small(tmp_path / "whole", "--images", 3)
    with monkeypatch.context() as patch:
        real = dataset.draw_image

        def stopped(settings, number):
            if number == 1:
                raise KeyboardInterrupt
            return real(settings, number)

        patch.setattr(dataset, "draw_image", stopped)
        result = small(tmp_path / "set", "--images", 3)
    assert result.exit_code == 130
    assert "--resume" in result.stderr
    assert not (tmp_path / "set" / "000001.json").exists()
    assert small(tmp_path / "set", "--images", 3, "--resume").exit_code == 0
    for path in (tmp_path / "whole").iterdir():
        assert path.read_bytes() == (tmp_path / "set" / path.name).read_bytes(), path.name


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--family", "parallell"], "--family: unknown; got 'parallell'; did you mean 'parallel'"),
        (["--style", "shady"], "--style: unknown; got 'shady'; did you mean 'shaded'"),
        (["--cables", "0-2"], "--cables: .* greater than or equal to 1; got 0"),
        (["--cables", "3-1"], "--cables: got 3-1; expected the smaller one first"),
        (["--cables", "two"], "--cables: got 'two'; expected such as 2 or 1-3"),
        (["--size", "60x60"], "--size: got 60x60; expected at least 168 px each way"),
        (["--width", "14-4"], "--width: got 14-4; expected the smaller one first"),
        (["--renderer", "povray"], "--renderer: .*'own' or 'blender'; got 'povray'"),
        (["--crops", "tracr"], "--crops: unknown; got 'tracr'; did you mean 'tracer'"),
        (["--resume"], "--resume: .* has no data.json to go on with"),
    ],
)
def test_what_cannot_be_drawn_is_said_before_anything_is_written(tmp_path, arguments, message):
    out = tmp_path / "set"
    result = train("data", "--out", out, *arguments)
    assert isinstance(result.exception, InputError)
    with pytest.raises(InputError, match=message):
        raise result.exception
    assert not out.exists()


def test_no_images_are_refused(tmp_path):
    result = train("data", "--out", tmp_path / "set", "--images", 0)
    assert result.exit_code == 2
    assert "--images" in result.stderr


def test_what_lies_in_a_folder_is_not_written_over(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    for command in ("data", "tracer", "all"):
        result = train(command, "--out", tmp_path)
        assert isinstance(result.exception, InputError)
        assert "not empty; got 1 entries" in str(result.exception)
    result = train("data", "--out", tmp_path / "notes.txt")
    assert "a file; expected a folder" in str(result.exception)
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_other_settings_do_not_go_on(tmp_path):
    small(tmp_path / "set", "--images", 1)
    result = small(tmp_path / "set", "--images", 1, "--seed", 5, "--resume")
    assert "a set with other settings" in str(result.exception)


def test_a_full_disk_is_said_beforehand_and_on_the_way(tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(train_folders, "LEAST_FREE_MB", 10**9)
        result = small(tmp_path / "set")
        assert "disk full" in str(result.exception)

    def full(*_):
        raise OSError(28, "No space left on device", "000000.png")

    monkeypatch.setattr(dataset, "encoded", full)
    result = small(tmp_path / "set", "--images", 1)
    assert isinstance(result.exception, InputError)
    assert "cannot be written; No space left on device" in str(result.exception)


def test_training_needs_its_extra_and_drawing_does_not(tmp_path, monkeypatch):
    monkeypatch.setattr(train_folders, "find_spec", lambda name: None)
    for arguments in (["tracer"], ["all"], ["data", "--crops", "sight"]):
        result = train(*arguments, "--out", tmp_path / "set")
        assert "pip install 'cellwright[learn]'" in str(result.exception)
    assert small(tmp_path / "set", "--images", 1).exit_code == 0


RECIPE = """\
format: 1
task: tracer
about: Nothing but a test.
stages:
- {seed: 5, samples: 16000, batch: 8, held_out_batches: 20, workers: 0}
- {seed: 6, samples: 8000, batch: 8, held_out_batches: 20, workers: 0, start: previous}
after:
- {step: calibrate, batches: 40}
"""


@pytest.fixture
def quick(monkeypatch):
    """Mix few samples, and calibrate on small batches."""
    pytest.importorskip("torch")
    from perception.training import calibrate, tracer

    monkeypatch.setattr(tracer, "MIXED", 16)
    monkeypatch.setattr(calibrate, "BATCH", 8)


def test_all_is_trained_again_by_its_recipes(tmp_path, quick):
    from perception.models.store import load_network

    version = tmp_path / "recipes" / "tracer_v7"
    version.mkdir(parents=True)
    (version / "recipe.yaml").write_text(RECIPE)
    again = ["--recipes", tmp_path / "recipes", "--hours-scale", 0.001]
    result = train("all", "--out", tmp_path / "models", *again)
    assert result.exit_code == 0, result.output
    made = tmp_path / "models" / "tracer_v7"
    assert {path.name for path in made.iterdir()} == {
        *("weights.safetensors", "config.json", "recipe.yaml"),
        *("metrics.json", "card.md", "golden.safetensors", "weights.sha256"),
    }
    metrics = json.loads((made / "metrics.json").read_text())
    assert metrics["samples"] == 16 + 8
    assert metrics["calibration"]["n"] == 16
    assert "Nothing but a test." in (made / "card.md").read_text()
    assert sum(weight.numel() for weight in load_network(made).parameters()) > 1e5
    before = (made / "weights.safetensors").read_bytes()
    assert train("all", "--out", tmp_path / "models", *again, "--resume").exit_code == 0
    assert (made / "weights.safetensors").read_bytes() == before


def test_weights_to_start_from_are_looked_for_first(tmp_path):
    pytest.importorskip("torch")
    result = train("tracer", "--out", tmp_path / "v", "--start", "tracer_v0")
    assert "start: no weights; got 'tracer_v0'; expected a file or" in str(result.exception)
    assert not (tmp_path / "v").exists()
