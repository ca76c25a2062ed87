"""A camera that gives a frame twice is found out, one that is asked twice at once is not."""

from dataclasses import replace

import numpy as np
import pytest

from perception.camera import CameraFrame, CameraModel
from perception.fresh_camera import FreshCamera, FrozenError

MODEL = CameraModel(4, 3, 5.0, (1.5, 1.0), np.eye(4))


class Hands:
    """A clock that is set by hand, also back."""

    def __init__(self):
        self.time_s = 0.0

    def now_s(self):
        return self.time_s

    def sleep_until(self, time_s):
        self.time_s = max(self.time_s, time_s)


class Sensor:
    """Takes noisy frames until it hangs; then hands out the last one, perhaps with a new stamp."""

    def __init__(self, clock, *, restamps=False, noise=True):
        self.clock, self.restamps, self.noise, self.hangs = clock, restamps, noise, False
        self.rng, self.last = np.random.default_rng(0), None

    def capture(self):
        if self.hangs:
            stamp_s = self.clock.now_s() if self.restamps else self.last.stamp_s
            return replace(self.last, stamp_s=stamp_s)
        grey = self.rng.integers(0, 255 if self.noise else 1, (3, 4)).astype(np.uint8)
        depth_m = np.full((3, 4), np.nan, np.float32)
        self.last = CameraFrame(grey, depth_m, self.clock.now_s(), MODEL)
        return self.last


@pytest.fixture
def clock():
    return Hands()


def test_new_frames_pass_as_they_are(clock):
    sensor = Sensor(clock)
    camera = FreshCamera(sensor, clock, noisy=True)
    for _ in range(5):
        clock.time_s += 0.1
        assert camera.capture() is sensor.last


@pytest.mark.parametrize("restamps", [False, True])
def test_a_frame_that_comes_again_later_is_refused_until_there_is_a_new_one(clock, restamps):
    sensor = Sensor(clock, restamps=restamps)
    camera = FreshCamera(sensor, clock, noisy=True)
    camera.capture()
    sensor.hangs = True
    for _ in range(3):
        clock.time_s += 0.5
        with pytest.raises(
            FrozenError, match=r"camera: has frozen; got at .* the frame of 0\.00 s"
        ):
            camera.capture()
    sensor.hangs = False
    assert camera.capture().stamp_s == 1.5


def test_a_camera_that_is_asked_twice_in_one_moment_may_give_one_frame_twice(clock):
    sensor = Sensor(clock)
    camera = FreshCamera(sensor, clock, noisy=True)
    first = camera.capture()
    sensor.hangs = True
    assert camera.capture().stamp_s == first.stamp_s


def test_frames_of_a_world_without_noise_may_be_the_same(clock):
    camera = FreshCamera(Sensor(clock, noise=False), clock, noisy=False)
    camera.capture()
    clock.time_s = 1.0
    assert camera.capture().stamp_s == 1.0


def test_a_clock_that_was_put_back_is_no_frozen_camera(clock):
    clock.time_s = 10.0
    sensor = Sensor(clock)
    camera = FreshCamera(sensor, clock, noisy=True)
    camera.capture()
    clock.time_s = 0.0
    assert camera.capture().stamp_s == 0.0
