"""Wide images made as coarse as geometry needs them: text wants pixels, where boxes stand does not.

Poses of a target are cast into every pixel; what is gained by more of them is nothing.
"""

from dataclasses import replace

from perception.camera import CameraModel
from perception.rgbd import RgbdFrame
from perception.shelf.detections import Detections

# Images are not made narrower than this.
ENOUGH_PX = 160


def coarser_camera(camera: CameraModel) -> CameraModel:
    """Return the camera whose pixels are each n-th one of a camera's, in both directions."""
    step = _step(camera)
    first = step // 2
    return CameraModel(
        len(range(first, camera.width_px, step)),
        len(range(first, camera.height_px, step)),
        camera.focal_px / step,
        ((camera.centre_px[0] - first) / step, (camera.centre_px[1] - first) / step),
        camera.T_world_camera,
    )


def coarser(frame: RgbdFrame, detections: Detections) -> tuple[RgbdFrame, Detections]:
    """Return a look of `coarser_camera`; objects that fall between its pixels keep their number."""
    step = _step(frame.camera)
    if step == 1:
        return frame, detections
    pick = (slice(step // 2, None, step), slice(step // 2, None, step))
    return (
        replace(
            frame,
            colour=frame.colour[pick],
            depth_m=frame.depth_m[pick],
            camera=coarser_camera(frame.camera),
        ),
        replace(detections, segments=detections.segments[pick]),
    )


def _step(camera: CameraModel) -> int:
    return max(1, camera.width_px // ENOUGH_PX)
