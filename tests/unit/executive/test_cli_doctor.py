"""`cellwright doctor` tries everything, says what is broken, and how to mend it."""

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from executive.cli import cmd_doctor, main
from executive.cli.doctor_checks import CHECKS, Check, CheckError
from executive.engine.loading.library import packaged_trees
from robots import layout
from robots.interfaces import ARMS
from robots.reach import ReachMap


def broken():
    raise CheckError("a ball does not fall")


def missing():
    raise ImportError("No module named 'gravity'")


def doctor(monkeypatch, *checks):
    monkeypatch.setattr(cmd_doctor, "CHECKS", checks)
    return CliRunner().invoke(main.app, ["doctor"])


def test_a_machine_that_is_well_exits_with_0(monkeypatch):
    result = doctor(monkeypatch, Check("gravity", lambda: "9.81 m/s2", "look down"))
    assert result.exit_code == 0
    assert "✓  gravity  9.81 m/s2" in result.stdout
    assert "look down" not in result.stdout


@pytest.mark.parametrize(
    ("attempt", "message"), [(broken, "a ball does not fall"), (missing, "ImportError: No module")]
)
def test_what_is_broken_is_named_with_its_remedy_and_the_rest_is_tried(
    monkeypatch, attempt, message
):
    checks = (Check("gravity", attempt, "look down"), Check("light", lambda: "on", ""))
    result = doctor(monkeypatch, *checks)
    assert result.exit_code == 3
    assert message in result.stdout
    assert "look down" in result.stdout
    assert "✓  light" in result.stdout


def test_a_warning_breaks_nothing(monkeypatch):
    result = doctor(monkeypatch, Check("threads", broken, "export OMP_NUM_THREADS=1"))
    assert result.exit_code == 0
    assert "export OMP_NUM_THREADS=1" in result.stdout


@pytest.mark.parametrize(
    "check", [check for check in CHECKS if check.name not in ("threads", "table cell")],
    ids=lambda check: check.name,
)  # fmt: skip
def test_every_library_passes_its_own_check(check, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert check.attempt()


@pytest.fixture
def quick_reach(monkeypatch):
    """Let both arms reach everything, without measuring it."""

    def reach_map(_scene, x_m, y_m, **_):
        return ReachMap(x_m, y_m, dict.fromkeys(ARMS, np.ones((len(y_m), len(x_m)))))

    monkeypatch.setattr(layout, "reach_map", reach_map)


def test_a_cell_is_judged_and_drawn(quick_reach, tmp_path):
    picture = tmp_path / "reach.png"
    result = CliRunner().invoke(main.app, ["doctor", "yumi_table", "--picture", str(picture)])
    assert result.exit_code == 0
    assert "within reach of left 100 %" in result.stdout
    assert "BBBB" in result.stdout
    with Image.open(picture) as image:
        assert image.format == "PNG"


def test_a_cell_whose_robot_stands_in_its_table_exits_with_3(quick_reach, tmp_path):
    cell = tmp_path / "sunken.yaml"
    layout_of = "config: {layout: {robot_y_m: -0.36, body_z_m: -0.3}}"
    cell.write_text(f"format: 1\ncell: sunken\nworld: table_cell\n{layout_of}\n")
    picture = str(tmp_path / "reach.png")
    result = CliRunner().invoke(main.app, ["doctor", str(cell), "--picture", picture])
    assert result.exit_code == 3
    assert "at home, " in result.stdout


def test_every_cell_that_ships_is_judged(quick_reach, tmp_path):
    for file in sorted((packaged_trees() / "cells").glob("*.yaml")):
        picture = tmp_path / f"{file.stem}.png"
        result = CliRunner().invoke(main.app, ["doctor", file.stem, "--picture", str(picture)])
        assert result.exit_code == 0, result.output
        assert file.stem in result.stdout
        assert picture.is_file() == (file.stem not in ("dry", "yumi_socket"))


def test_a_shelf_without_a_cup_is_warned_of(tmp_path):
    cell = tmp_path / "bare.yaml"
    cell.write_text(
        "format: 1\ncell: bare\nworld: shelf_kinematic\nconfig: {tool: {suction: false}}\n"
    )
    picture = str(tmp_path / "reach.png")
    result = CliRunner().invoke(main.app, ["doctor", str(cell), "--picture", picture])
    assert result.exit_code == 0
    assert "nothing can be taken out" in result.stdout


def test_a_cell_that_is_not_known_is_refused():
    result = CliRunner().invoke(main.app, ["doctor", "yumi_tabel"])
    assert result.exit_code != 0
    assert "did you mean 'yumi_table'" in str(result.exception)
