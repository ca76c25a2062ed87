"""What a real camera has besides noise: a calibration with errors, and frames that never come."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from executive.core.errors import DeviceError
from simulation.freezing_camera import FreezingCamera
from simulation.overhead_camera import OverheadCamera, miscalibrated, overhead_camera_model
from simulation.table_cell import TableCell
from simulation.table_cell_config import CameraConfig
from simulation.table_world import TableWorld

TRUE = overhead_camera_model(CameraConfig())
LAID_M = np.column_stack([np.linspace(-0.1, 0.1, 21), np.full(21, 0.1), np.full(21, 4e-3)])


@pytest.fixture(scope="module")
def world():
    world = TableWorld(LAID_M, 240)
    yield world
    world.body.close()


def camera(world, noise=1, faults=2, **config):
    rngs = np.random.default_rng(noise), np.random.default_rng(faults)
    return OverheadCamera(world, CameraConfig(**config), *rngs)


def test_without_errors_the_camera_is_what_it_is_taken_for(world):
    assert miscalibrated(TRUE, CameraConfig(), np.random.default_rng(0)) is TRUE


def test_errors_of_the_calibration_have_the_size_that_is_asked_for():
    config = CameraConfig(calibration_error_m=0.003, calibration_error_rad=0.01, focal_error=0.02)
    rng = np.random.default_rng(0)
    drawn = [miscalibrated(TRUE, config, rng) for _ in range(400)]
    moved = np.array([one.T_world_camera[:3, 3] - TRUE.T_world_camera[:3, 3] for one in drawn])
    turned = np.array([
        Rotation.from_matrix(
            TRUE.T_world_camera[:3, :3].T @ one.T_world_camera[:3, :3]
        ).as_rotvec()
        for one in drawn
    ])  # fmt: skip
    zoomed = np.array([one.focal_px / TRUE.focal_px - 1.0 for one in drawn])
    for sample, size in ((moved, 0.003), (turned, 0.01), (zoomed, 0.02)):
        assert sample.std(axis=0) == pytest.approx(size, rel=0.15)
        assert np.abs(sample.mean(axis=0)).max() < 0.2 * size


def test_a_wrong_calibration_moves_what_is_measured_and_not_the_image(world):
    right, wrong = camera(world), camera(world, calibration_error_m=0.004)
    frames = right.capture(), wrong.capture()
    assert np.array_equal(frames[0].image, frames[1].image)
    pixel = np.array([[500.0, 400.0]])
    places = [frame.camera.on_plane(pixel) for frame in frames]
    assert 1e-4 < np.linalg.norm(places[0] - places[1]) < 0.02


def test_lost_frames_are_waited_for_and_change_no_image(world):
    steady, losing = camera(world), camera(world, drop_rate=0.5)
    for _ in range(3):
        assert np.array_equal(steady.capture().image, losing.capture().image)


def test_a_camera_that_loses_every_frame_says_so(world):
    with pytest.raises(DeviceError, match="20 frames in a row were lost"):
        camera(world, drop_rate=1.0).capture()


def test_noise_goes_on_from_its_state(world):
    one = camera(world, drop_rate=0.5)
    one.capture()
    state = one.noise_state
    after = one.capture().image
    one.take_noise_state(state)
    assert np.array_equal(one.capture().image, after)


def test_the_cell_passes_its_settings_on():
    cell = TableCell({"camera": {"calibration_error_m": 0.01}}, {"cable": {"knot": "none"}}, 0)
    try:
        assert not np.allclose(cell.camera.model.T_world_camera, TRUE.T_world_camera)
    finally:
        cell.close()


def test_a_camera_that_freezes_gives_its_last_frame_for_ever(world):
    frozen = FreezingCamera(camera(world), 2)
    frames = [frozen.capture() for _ in range(4)]
    assert frames[0] is not frames[1]
    assert frames[1] is frames[2] is frames[3]
