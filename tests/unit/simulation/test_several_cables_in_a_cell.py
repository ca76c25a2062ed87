"""A table cell with several cables: seeds, files, the camera, what is recorded, snapshots."""

import json

import numpy as np
import pytest

from executive.core.errors import InputError
from simulation.table_cell import TableCell


@pytest.fixture
def opened():
    cells = []

    def open_cell(scenario, seed=1):
        cells.append(TableCell({}, scenario, seed))
        return cells[-1]

    yield open_cell
    for cell in cells:
        cell.close()


@pytest.fixture
def crossed(tmp_path):
    """Two cables in files, the second one across the first."""
    first = [[-0.3, 0.0, 0.004], [-0.1, 0.0, 0.004], [0.1, 0.0, 0.004], [0.3, 0.0, 0.004]]
    second = [[0.0, -0.2, 0.004], [0.0, -0.04, 0.012], [0.0, 0.04, 0.012], [0.0, 0.2, 0.004]]
    return [written(tmp_path / f"{k}.json", line) for k, line in enumerate((first, second))]


def written(file, line):
    file.write_text(json.dumps({"nodes_m": line}), encoding="utf-8")
    return {"file": str(file)}


def last_scene(cell):
    return json.loads([m for m in cell.drain_streams() if m.topic == "/scene"][-1].data)


def test_cables_come_from_files_and_lie_as_they_were_drawn(opened, crossed):
    cell = opened({"cables": crossed})
    truth = cell.truth()
    assert (truth.untangled, truth.crossings) == (True, 1)
    scene = last_scene(cell)
    (second,) = np.array(scene["more_cables_m"])
    middle = np.abs(second[:, 1]).argmin()
    assert second[middle, 2] > 0.008
    assert np.abs(np.array(scene["cable_nodes_m"])[:, 1]).max() < 0.01


def test_cables_that_run_through_each_other_are_refused_with_the_place(opened, crossed, tmp_path):
    low = [[0.0, -0.2, 0.004], [0.0, -0.04, 0.004], [0.0, 0.04, 0.004], [0.0, 0.2, 0.004]]
    flat = written(tmp_path / "flat.json", low)
    with pytest.raises(InputError, match=r"0\.json: nodes_m: runs through that of .*flat\.json at"):
        opened({"cables": [crossed[0], flat]})


def test_the_camera_sees_all_cables(opened, crossed):
    both, one = opened({"cables": crossed}), opened({"cable": crossed[0]})
    bright = [(cell.camera.capture().image > 120).sum() for cell in (both, one)]
    assert 1.3 < bright[0] / bright[1] < 2.2


def test_the_same_seed_gives_the_same_cables(opened):
    first, second = (opened({"tied": "sheet_bend"}, seed=4) for _ in range(2))
    assert last_scene(first) == last_scene(second)
    assert not first.truth().untangled


def test_a_cell_with_one_cable_records_no_others(opened):
    assert "more_cables_m" not in last_scene(opened({"cable": {"knot": "none"}}))


def test_a_snapshot_holds_all_cables(opened, crossed):
    cell, other = (opened({"cables": crossed}) for _ in range(2))
    cell.advance(48)
    other.restore(cell.snapshot())
    for each in (cell, other):
        each.drain_streams()
        each.advance(24)
    assert cell.snapshot() == other.snapshot()
    with pytest.raises(InputError, match="another cable"):
        opened({"cable": crossed[0]}).restore(cell.snapshot())
