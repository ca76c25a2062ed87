"""The camera on the tool: colour and depth by ray casting, with what cameras get wrong."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from executive.core.errors import DeviceError
from perception.camera import CameraModel
from perception.rgbd import ColourImage, RgbdFrame
from perception.shelf.types import NOTHING, Floats
from robots.descriptions.kinova import CAMERA_FRAME
from simulation.poses import pose_matrices
from simulation.shelf_cell.config import CameraConfig
from simulation.shelf_cell.physics import ShelfPhysics
from simulation.shelf_cell.seeing import Seen, see

# Boards, the tool, and what is beyond all of them.
_BOARD, _TOOL, _BACKDROP = (150.0, 150.0, 150.0), (230.0, 115.0, 30.0), (35.0, 35.0, 38.0)
# Focal length in image widths: from 0.75 m the image is just wider than a shelf of 0.8 m.
FOCAL_SHARE = 0.97 * 0.75 / 0.8
# Light comes from beside the camera: a face seen at a slant is darker.
_AMBIENT = 0.45


class ToolCamera:
    """`perception.rgbd.RgbdCamera` on the arm."""

    def __init__(
        self,
        physics: ShelfPhysics,
        colours: Mapping[str, tuple[int, int, int]],
        config: CameraConfig,
        now_s: Callable[[], float],
        moving: Callable[[], bool],
        viewpoint: Callable[[], str],
        rng: np.random.Generator,
    ) -> None:
        """Mount the camera.

        Args:
            physics: What there is to see.
            colours: Of the boxes, by name.
            config: What the camera gets wrong.
            now_s: Tells the time.
            moving: Tells whether the arm moves.
            viewpoint: Tells at which viewpoint the camera rests.
            rng: Of all that is wrong.
        """
        self._physics, self._config, self._rng = physics, config, rng
        self._now_s, self._moving, self._viewpoint = now_s, moving, viewpoint
        self._colours = np.array([colours[name] for name in physics.box_names], dtype=np.float64)
        # How the camera really sits on the tool; nobody knows.
        self._error = np.eye(4)
        self._error[:3, :3] = Rotation.from_rotvec(
            rng.normal(0.0, 1.0, 3) * config.calibration_rad
        ).as_matrix()
        self._error[:3, 3] = rng.normal(0.0, 1.0, 3) * config.calibration_m

    def capture(self) -> RgbdFrame:
        """Take a frame from where the camera is now.

        Raises:
            DeviceError: The camera moves, or gives no frame.
        """
        if self._moving():
            raise DeviceError("tool camera: got an arm that moves; expected it at rest")
        if self._rng.random() < self._config.drop_share:
            raise DeviceError("tool camera: the frame was dropped; try: capture again")
        told = self.model()
        seen = see(self._physics, self.model(self._error))
        return RgbdFrame(
            self._colour(seen), self._depth(seen), self._now_s(), told, self._viewpoint()
        )

    def model(self, error: Floats | None = None) -> CameraModel:
        """Return the camera where it is now, or where it is off by an error, shape (4, 4)."""
        T_world_camera = self._frame(CAMERA_FRAME)
        width_px = self._config.width_px
        height_px = 3 * width_px // 4
        centre_px = (0.5 * (width_px - 1), 0.5 * (height_px - 1))
        T = T_world_camera if error is None else T_world_camera @ error
        return CameraModel(width_px, height_px, FOCAL_SHARE * width_px, centre_px, T)

    def _frame(self, name: str) -> Floats:
        pose = self._physics.link_pose(name)
        matrix: Floats = pose_matrices(pose[None, :3], pose[None, 3:])[0]
        return matrix

    def _colour(self, seen: Seen) -> ColourImage:
        plain = np.full((*seen.box.shape, 3), _BOARD)
        is_box = seen.box != NOTHING
        plain[is_box] = self._colours[seen.box[is_box]]
        plain[seen.tool] = _TOOL
        plain = plain * (_AMBIENT + (1.0 - _AMBIENT) * seen.facing)[..., None]
        plain[np.isnan(seen.depth_m)] = _BACKDROP
        noise = self._rng.normal(0.0, self._config.colour_noise, plain.shape)
        return np.clip(plain + noise, 0.0, 255.0).astype(np.uint8)

    def _depth(self, seen: Seen) -> NDArray[np.float32]:
        """Return measured depth; where the tool, which is known, is in the way, there is none."""
        config = self._config
        depth_m = seen.depth_m + self._rng.normal(0.0, config.depth_noise_m, seen.depth_m.shape)
        lost = self._rng.random(depth_m.shape) < config.lost_share
        return np.where(lost | seen.tool, np.nan, depth_m).astype(np.float32)
