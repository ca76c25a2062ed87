"""Take a picture of the workspace."""

from executive.core.outcome import failure, success
from executive.core.skill import Port, Skill, SkillRun
from perception.camera import Camera, CameraFrame
from skills.looking import new_frame


class ObserveWorkspace(Skill):
    """Take one frame with the overhead camera.

    SUCCESS: `frame` is fresh.
    FAILURE: `camera.dark` when the frame has no contrast at all (lens cap, lights off).
    A camera that gives its last frame for more than ten ticks is broken: `DeviceError`.
    """

    OUT = {"frame": Port(CameraFrame, "what the camera sees now")}
    REASONS = frozenset({"camera.dark"})
    CLAIMS = frozenset({"camera"})

    def __init__(self, camera: Camera) -> None:
        """Bind the camera."""
        self._camera = camera

    def run(self) -> SkillRun:
        """Capture one frame; the world may settle for one tick before."""
        yield
        frame = yield from new_frame(self._camera)
        spread = int(frame.image.max()) - int(frame.image.min())
        if spread < 16:
            return failure("camera.dark", "the frame has no contrast", grey_spread=spread)
        return success(frame=frame)
