"""Boxes that nobody touches, and worlds of one seed."""

import numpy as np
import pytest
from shelf_rigs import Rig, heavy

from robots.shelf_tool import LookFrom, PushAlong
from simulation.shelf_cell.cell import ShelfCell

SCENARIO = {"count": 12}


def _worked(seed: int) -> np.ndarray:
    """Return where everything is after a look and some waiting."""
    cell = ShelfCell({}, SCENARIO, seed)
    try:
        cell.tool.start(LookFrom("left"))
        while cell.tool.result() is None:
            cell.clock.sleep_until(cell.clock.now_s() + 0.1)
        frame = cell.camera.capture()
        poses = [pose for _, pose in sorted(cell.truth().poses.items())]
        return np.concatenate(
            [
                np.ravel(poses),
                cell.driver.state().positions_rad,
                np.nan_to_num(frame.depth_m.ravel()),
            ]
        )
    finally:
        cell.close()


def test_boxes_at_rest_stay_where_they_are_without_energy() -> None:
    rig = Rig(
        heavy("low", (0.2, 0.1), (0.1, 0.06, 0.04)),
        heavy("tall", (0.4, 0.2), (0.04, 0.04, 0.25)),
        heavy("beside", (0.441, 0.2), (0.04, 0.06, 0.1), mass_kg=0.8),
    )
    before = rig.physics.box_poses()
    for _ in range(240 * 20):
        rig.physics.step()
    assert np.abs(rig.physics.box_poses() - before).max() < 2e-3
    assert rig.physics.kinetic_energy_j() < 1e-7


def test_energy_of_a_moved_box_is_gone_when_it_rests() -> None:
    rig = Rig(heavy("a", (0.4, 0.15), (0.06, 0.06, 0.12)))
    rig.do(PushAlong(rig.thing("a"), 0.05))
    rig.wait(2.0)
    assert rig.physics.kinetic_energy_j() < 1e-7


def test_same_seed_gives_the_same_world() -> None:
    assert np.array_equal(_worked(3), _worked(3))


def test_other_seeds_give_other_worlds() -> None:
    first, other = (ShelfCell({}, SCENARIO, seed) for seed in (3, 4))
    assert first.truth().poses.keys() != other.truth().poses.keys()
    for cell in (first, other):
        cell.close()


def test_both_worlds_have_the_same_scene() -> None:
    from simulation.shelf.cell import KinematicShelfCell

    real, plain = ShelfCell({}, SCENARIO, 5), KinematicShelfCell({}, SCENARIO, 5)
    assert real.stock == plain.stock
    assert set(real.truth().poses) <= set(plain.stock.names)
    assert real.truth().target == plain.truth().target
    real.close()


def test_target_is_hidden_at_first_and_everything_stands() -> None:
    cell = ShelfCell({}, SCENARIO, 6)
    truth = cell.truth()
    assert not truth.found
    assert not truth.retrieved
    assert truth.toppled == 0
    assert truth.fallen == ()
    assert truth.wrong == ()
    assert truth.disorder_m == pytest.approx(0.0, abs=1e-3)
    cell.close()
