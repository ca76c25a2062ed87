import subprocess
import sys

import pytest

from executive.core.errors import InputError
from simulation.table_cell_config import TableCellConfig, TableScenario, read_settings


def test_nothing_given_means_the_defaults():
    assert read_settings(TableScenario, {}, "scenario").cable.knot == "overhand"
    assert read_settings(TableCellConfig, {}, "cell").physics.step_hz == 240


def test_a_scenario_names_the_knot_or_the_file():
    scenario = read_settings(TableScenario, {"cable": {"knot": "none", "file": "a.json"}}, "s")
    assert (scenario.cable.knot, scenario.cable.file) == ("none", "a.json")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"cabel": {}},
            "scenario: cabel: unknown key; did you mean 'cable'? "
            "(known: arms, cable, cables, camera, tied)",
        ),
        (
            {"cables": [{}, {"knots": "none"}]},
            "scenario: cables.1.knots: unknown key; did you mean 'knot'? "
            "(known: file, knot, length_m)",
        ),
        (
            {"cables": [{"file": "a.json"}, {}]},
            "scenario: some cables come from files and some do not; try files for all",
        ),
        (
            {"tied": "square", "cables": [{"knot": "overhand"}, {}]},
            "scenario: tied is for two cables without knots or files; try leaving them out",
        ),
        (
            {"tied": "square", "cables": [{}]},
            "scenario: tied takes two cables, got 1; try leaving cables out",
        ),
        (
            {"cable": {"knots": "none"}},
            "scenario: cable.knots: unknown key; did you mean 'knot'? "
            "(known: file, knot, leaves_view, tier)",
        ),
        (
            {"cable": {"knot": "granny"}},
            "scenario: cable.knot: got 'granny'; expected 'none', 'overhand', "
            "'figure_8', 'overhand_honda', 'bowline', 'linked_overhand' or 'figure_8_honda'",
        ),
        (
            {"arms": {"mis_rate": 0.1}},
            "scenario: arms.mis_rate: unknown key; did you mean 'miss_rate'? "
            "(known: miss_rate, slip_rate, stop_rate)",
        ),
        (
            {"cable": {"tier": "c1"}},
            "scenario: cable.tier: got 'c1'; expected 'C1', 'C2' or 'C3'",
        ),
        (
            {"cable": {"tier": "C1", "file": "a.json"}},
            "scenario: cable: a cable comes from a file or is of a tier; try leaving one out",
        ),
        (
            {"cable": {"leaves_view": True}},
            "scenario: cable: leaves_view is for cables of a tier; try adding tier: C1",
        ),
    ],
)
def test_says_what_is_wrong_with_a_scenario(values, message):
    with pytest.raises(InputError) as caught:
        read_settings(TableScenario, values, "scenario")
    assert str(caught.value) == message


def test_says_everything_that_is_wrong_at_once():
    values = {"camera": {"height_m": 0.1}, "physics": {"hz": 1}}
    with pytest.raises(InputError) as caught:
        read_settings(TableCellConfig, values, "cell")
    first, second = str(caught.value).splitlines()
    assert first.startswith("cell: camera.height_m: got 0.1;")
    assert second.startswith("cell: physics.hz: unknown key;")


def test_loads_no_heavy_library():
    code = (
        "import sys, simulation.table_cell_config; "
        "heavy = {'numba', 'pybullet', 'pinocchio', 'cv2', 'scipy'} & set(sys.modules); "
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
