"""How skills take a frame: a camera that repeats its last one gets a little time for a new one."""

from collections.abc import Generator
from typing import Protocol, TypeVar

from perception.fresh_camera import FrozenError

# Ticks; a camera that has merely stuttered has a new frame by then.
PATIENCE = 10

Frame_co = TypeVar("Frame_co", covariant=True)


class _Looking(Protocol[Frame_co]):
    def capture(self) -> Frame_co: ...


def new_frame(camera: _Looking[Frame_co]) -> Generator[None, None, Frame_co]:
    """Take a frame that was not there before.

    Raises:
        FrozenError: None came in time.
        DeviceError: The camera gives no frame.
    """
    for _ in range(PATIENCE):
        try:
            return camera.capture()
        except FrozenError:
            yield
    return camera.capture()
