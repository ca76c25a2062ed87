"""The overhead camera of the table cell: sees the arms and the cables, and nothing else."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from executive.core.errors import DeviceError
from perception.camera import CameraFrame, CameraModel
from robots.placement import TABLE_SIZE_M, Rectangle
from simulation.poses import pose_matrices
from simulation.render.primitives import join
from simulation.render.renderer import Renderer
from simulation.render.sensor import SensorParameters, expose, measure_depth
from simulation.render.shapes import cable_shapes, robot_shapes
from simulation.table_cell_config import CameraConfig
from simulation.table_world import TableWorld

_WIDTH_PX, _HEIGHT_PX = 1032, 773
# After so many lost frames in a row the camera is taken to be broken.
MOST_LOST = 20


def overhead_camera_model(config: CameraConfig) -> CameraModel:
    """Return the camera over the table's centre, looking straight down, world x to the right."""
    T_world_camera = np.diag([1.0, -1.0, -1.0, 1.0])
    T_world_camera[2, 3] = config.height_m
    return CameraModel(
        width_px=_WIDTH_PX,
        height_px=_HEIGHT_PX,
        focal_px=config.height_m / config.scale_m_px,
        centre_px=(0.5 * (_WIDTH_PX - 1), 0.5 * (_HEIGHT_PX - 1)),
        T_world_camera=T_world_camera,
    )


def seen_rectangle(config: CameraConfig) -> Rectangle:
    """Return what the overhead camera sees of the table."""
    half_m = [
        min(0.5 * pixels * config.scale_m_px, 0.5 * size)
        for pixels, size in zip((_WIDTH_PX, _HEIGHT_PX), TABLE_SIZE_M, strict=True)
    ]
    return Rectangle((-half_m[0], -half_m[1]), (half_m[0], half_m[1]))


def miscalibrated(
    camera: CameraModel, config: CameraConfig, rng: np.random.Generator
) -> CameraModel:
    """Return what a calibration with errors takes a camera for.

    Args:
        camera: What it is.
        config: Sizes of the errors; without any, the camera itself is returned.
        rng: Draws them.
    """
    if not (config.calibration_error_m or config.calibration_error_rad or config.focal_error):
        return camera
    T_world_camera = camera.T_world_camera.copy()
    turn = Rotation.from_rotvec(config.calibration_error_rad * rng.standard_normal(3))
    T_world_camera[:3, :3] = T_world_camera[:3, :3] @ turn.as_matrix()
    T_world_camera[:3, 3] += config.calibration_error_m * rng.standard_normal(3)
    focal_px = camera.focal_px * (1.0 + config.focal_error * float(rng.standard_normal()))
    return replace(camera, focal_px=focal_px, T_world_camera=T_world_camera)


class OverheadCamera:
    """`perception.camera.Camera` of a table world.

    Attributes:
        model: What the calibration takes the camera for; frames carry it.
    """

    def __init__(
        self,
        world: TableWorld,
        config: CameraConfig,
        rng: np.random.Generator,
        faults_rng: np.random.Generator | None = None,
    ) -> None:
        """Mount the camera.

        Args:
            world: What it looks at.
            config: What it is like.
            rng: The cloth under it and all noise come from here.
            faults_rng: Errors of the calibration and lost frames come from here; a generator of
                their own, so that images are the same with them and without.
        """
        self._world, self._rng = world, rng
        self._faults_rng = faults_rng or np.random.default_rng(0)
        self._drop_rate = config.drop_rate
        true_model = overhead_camera_model(config)
        self.model = miscalibrated(true_model, config, self._faults_rng)
        self._renderer = Renderer(true_model, TABLE_SIZE_M, rng)
        self._sensor = SensorParameters(
            blur_px=config.blur_px,
            read_noise=config.read_noise,
            speckle=config.speckle,
            depth_noise_m=config.depth_noise_m,
        )

    @property
    def noisy(self) -> bool:
        """Whether two frames of one scene differ."""
        sensor = self._sensor
        return max(sensor.read_noise, sensor.speckle, sensor.depth_noise_m) > 0.0

    @property
    def noise_state(self) -> Mapping[str, Any]:
        """State of the generators behind all noise and lost frames to come."""
        return {**self._rng.bit_generator.state, "faults": self._faults_rng.bit_generator.state}

    def take_noise_state(self, state: Mapping[str, Any]) -> None:
        """Go on with the noise of that state; the cloth and the calibration stay."""
        noise = dict(state)
        faults = noise.pop("faults", None)
        self._rng.bit_generator.state = noise
        if faults is not None:
            self._faults_rng.bit_generator.state = faults

    def capture(self) -> CameraFrame:
        """Take a frame now.

        Raises:
            DeviceError: Frame after frame was lost.
        """
        self._wait_for_one()
        world = self._world
        names, rod = world.body.link_names, world.rod
        poses = pose_matrices(*world.body.link_poses(names))
        links = dict(zip(names, poses, strict=True))
        plugs = rod.connector_poses().reshape(-1, 2, 4, 4)
        cables = [
            cable_shapes(line_m, rod.parameters.radius_m, ends)
            for line_m, ends in zip(rod.lines_m, plugs, strict=True)
        ]
        rendering = self._renderer.render(join([robot_shapes(world.robot, links), *cables]))
        return CameraFrame(
            image=expose(rendering, self._sensor, self._rng),
            depth_m=measure_depth(rendering, self._sensor, self._rng),
            stamp_s=world.now_s(),
            camera=self.model,
        )

    def _wait_for_one(self) -> None:
        if self._drop_rate == 0.0:
            return
        if all(self._faults_rng.random() < self._drop_rate for _ in range(MOST_LOST)):
            raise DeviceError(
                f"camera: {MOST_LOST} frames in a row were lost; expected one now and then; "
                f"drop_rate is {self._drop_rate:g}"
            )
