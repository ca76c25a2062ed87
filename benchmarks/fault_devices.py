"""Devices that hang: a camera that freezes, a controller that falls silent or lags."""

import json
import time
from contextlib import closing
from pathlib import Path

import numpy as np

from benchmarks.fault_missions import BROKEN, call
from benchmarks.fault_trials import Answer
from executive.core.errors import DeviceError
from executive.engine.recording.reader import Recording
from robots.drivers.socket_arms import SocketArms
from robots.dual_arm import PlannedDualArm
from robots.interfaces import MotionFailure
from simulation.loopback.process import LoopbackProcess
from simulation.loopback.settings import LoopbackSettings


def frozen_camera(folder: Path, rng: np.random.Generator) -> Answer:
    """Let the camera hand out its first frame for ever: no second look may act on it."""
    answer = call(
        folder,
        *("run", "untangle", "--timeout", "60", "--seed", int(rng.integers(1000))),
        *("--set", "camera.freezes_after=1", "--record", "frozen.mcap", "--json"),
    )
    told = json.loads(answer.stdout.strip().splitlines()[-1])["reason"]
    ended = Recording.open(folder / "frozen.mcap").result is not None
    held = answer.returncode == BROKEN and "camera: has frozen" in told and ended
    return Answer(held, "said so, stopped in order, exit code 3")


def frozen_driver(_: Path, rng: np.random.Generator) -> Answer:
    """Let a controller hang while its arms move: the driver says so, and nothing waits for it."""
    with LoopbackProcess() as controller, closing(_connected(controller)) as driver:
        arms = _under_way(driver)
        driver.clock.sleep_until(driver.clock.now_s() + float(rng.uniform(0.0, 0.3)))
        controller.freeze()
        try:
            _watched(arms)
        except DeviceError:
            return Answer(True, "DeviceError; the arms stop by themselves")
        finally:
            controller.thaw()
    return Answer(False, "waited for it")


def lagging_driver(_: Path, rng: np.random.Generator) -> Answer:
    """Delay all messages: a motion goes on as planned, or the driver says that it lags too much."""
    latency_s = float(10.0 ** rng.uniform(-2.0, -0.3))
    lags = LoopbackSettings(latency_s=latency_s, jitter_s=0.1 * latency_s, seed=1)
    with LoopbackProcess(lags) as controller:
        try:
            with closing(_connected(controller)) as driver:
                arms = _under_way(driver)
                over = _watched(arms)
        except DeviceError as error:
            told = "no answer" in str(error) or "heard nothing" in str(error)
            too_much = 2.0 * latency_s > 0.5 * lags.silence_s
            return Answer(told and too_much, "DeviceError: it lags too much")
    return Answer(over, "moved as planned, later by the lag")


def _connected(controller: LoopbackProcess) -> SocketArms:
    """Return a driver of a controller."""
    return SocketArms(controller.host, controller.port)


def _under_way(driver: SocketArms) -> PlannedDualArm:
    """Start a motion."""
    arms = PlannedDualArm(driver, seed=0)
    motion = arms.plan_line({"left": np.array([0.0, 0.0, 0.05])})
    assert not isinstance(motion, MotionFailure)
    arms.start(motion)
    return arms


def _watched(arms: PlannedDualArm) -> bool:
    """Watch a motion; return whether it came to its end in time."""
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        time.sleep(0.02)
        if not arms.moving():
            return True
    return False
