"""The overhead camera of the table cell: sees the arms and the cable, and nothing else."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from perception.camera import CameraFrame, CameraModel
from robots.placement import TABLE_SIZE_M
from simulation.poses import pose_matrices
from simulation.render.primitives import join
from simulation.render.renderer import Renderer
from simulation.render.sensor import SensorParameters, expose, measure_depth
from simulation.render.shapes import cable_shapes, robot_shapes
from simulation.table_cell_config import CameraConfig
from simulation.table_world import TableWorld

_WIDTH_PX, _HEIGHT_PX = 1032, 773


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


class OverheadCamera:
    """`perception.camera.Camera` of a table world."""

    def __init__(self, world: TableWorld, config: CameraConfig, rng: np.random.Generator) -> None:
        """Mount the camera; the cloth under it and all noise come from `rng`."""
        self._world, self._rng = world, rng
        self.model = overhead_camera_model(config)
        self._renderer = Renderer(self.model, TABLE_SIZE_M, rng)
        self._sensor = SensorParameters(
            blur_px=config.blur_px,
            read_noise=config.read_noise,
            speckle=config.speckle,
            depth_noise_m=config.depth_noise_m,
        )

    @property
    def noise_state(self) -> Mapping[str, Any]:
        """State of the generator behind all noise to come."""
        return self._rng.bit_generator.state

    def take_noise_state(self, state: Mapping[str, Any]) -> None:
        """Go on with the noise of that state; the cloth stays."""
        self._rng.bit_generator.state = state

    def capture(self) -> CameraFrame:
        """Take a frame now."""
        world = self._world
        names, rod = world.body.link_names, world.rod
        poses = pose_matrices(*world.body.link_poses(names))
        links = dict(zip(names, poses, strict=True))
        cable = cable_shapes(rod.positions_m, rod.parameters.radius_m, rod.connector_poses())
        rendering = self._renderer.render(join([robot_shapes(world.robot, links), cable]))
        return CameraFrame(
            image=expose(rendering, self._sensor, self._rng),
            depth_m=measure_depth(rendering, self._sensor, self._rng),
            stamp_s=world.now_s(),
            camera=self.model,
        )
