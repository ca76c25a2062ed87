"""A camera that does not pass the last frame off as a new one.

Drivers that have lost their sensor go on handing out what is in their buffer. It looks right, and
a robot that acts on it acts on what was there long ago.
"""

from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from executive.core.clock import Clock
from executive.core.errors import DeviceError
from perception.camera import CameraFrame
from perception.rgbd import RgbdFrame

Frame = TypeVar("Frame", bound=CameraFrame | RgbdFrame)
Taken_co = TypeVar("Taken_co", bound=CameraFrame | RgbdFrame, covariant=True)


class FrozenError(DeviceError):
    """A camera gave a frame a second time."""


class _Looking(Protocol[Taken_co]):
    def capture(self) -> Taken_co: ...


class FreshCamera(Generic[Frame]):
    """A camera of a cell whose frames are held against the ones before."""

    def __init__(self, camera: _Looking[Frame], clock: Clock, *, noisy: bool) -> None:
        """Watch a camera.

        Args:
            camera: The camera.
            clock: The clock that its frames are stamped with.
            noisy: Whether two frames of one scene always differ, as those of a real sensor do.
        """
        self._camera, self._clock, self._noisy = camera, clock, noisy
        self._last: Frame | None = None
        self._asked_s = 0.0

    def capture(self) -> Frame:
        """Take a frame now.

        Raises:
            FrozenError: It is one that was there before.
            DeviceError: The camera gives no frame.
        """
        frame, now_s = self._camera.capture(), self._clock.now_s()
        before, waited = self._last, now_s > self._asked_s
        if before is not None and waited and frame.stamp_s <= before.stamp_s:
            raise FrozenError(
                f"camera: has frozen; got at {now_s:.2f} s the frame of {frame.stamp_s:.2f} s once "
                "more; expected a newer one; try: restart the camera or its driver"
            )
        if before is not None and waited and self._noisy and _same(frame, before):
            raise FrozenError(
                f"camera: has frozen; got at {now_s:.2f} s, pixel for pixel, the frame of "
                f"{before.stamp_s:.2f} s; expected the noise to differ at least; try: restart the "
                "camera or its driver"
            )
        self._last, self._asked_s = frame, now_s
        return frame


def _same(one: CameraFrame | RgbdFrame, other: CameraFrame | RgbdFrame) -> bool:
    if not np.array_equal(_pixels(one), _pixels(other)):
        return False
    return np.array_equal(one.depth_m, other.depth_m, equal_nan=True)


def _pixels(frame: CameraFrame | RgbdFrame) -> NDArray[np.uint8]:
    return frame.image if isinstance(frame, CameraFrame) else frame.colour
