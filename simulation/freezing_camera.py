"""A camera whose driver hangs after some frames, and hands out the last one ever after."""

from perception.camera import Camera, CameraFrame


class FreezingCamera:
    """`perception.camera.Camera` that freezes."""

    def __init__(self, camera: Camera, after: int) -> None:
        """Freeze a camera after that many frames, at least one."""
        self._camera, self._left = camera, after
        self._last: CameraFrame | None = None

    def capture(self) -> CameraFrame:
        """Take a frame, or hand out the last one.

        Raises:
            DeviceError: The camera gives no frame.
        """
        if self._last is None or self._left > 0:
            self._last = self._camera.capture()
            self._left -= 1
        return self._last
