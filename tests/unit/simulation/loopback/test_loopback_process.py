"""A driver and a controller in another process: what each notices about the other, and when."""

import subprocess
import sys
import time
from contextlib import suppress

import numpy as np
import pytest

from executive.core.errors import DeviceError
from robots.drivers.link import LinkSettings
from robots.drivers.messages import Hello, Sorry, Stop
from robots.drivers.socket_arms import SocketArms
from robots.drivers.wire import Wire
from robots.limits import yumi_limits
from robots.motion.timing import rest_to_rest
from robots.placement import HOME_RAD
from simulation.loopback.process import LoopbackProcess
from simulation.loopback.settings import LoopbackSettings

LIMITS = yumi_limits()
AWAY_RAD = HOME_RAD + 0.3
SLOW = rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS.slowed(0.3))


@pytest.fixture
def start(request):
    """Start controllers that end with the test, and drivers of them."""

    def started(**settings):
        process = LoopbackProcess(LoopbackSettings(**settings))
        request.addfinalizer(process.close)
        return process, connected(process)

    def connected(process):
        driver = SocketArms(process.host, process.port)
        request.addfinalizer(driver.close)
        return driver

    started.another = connected
    return started


def run(driver, time_s):
    """Let a controller in lock-step go on and return the states on the way."""
    states = []
    end_s = driver.clock.now_s() + time_s
    while driver.clock.now_s() < end_s - 1e-9:
        driver.clock.sleep_until(driver.clock.now_s() + driver.cycle_s)
        states.append(driver.state())
    return states


def trouble(driver, time_s):
    """Wait for the driver to say what is wrong, in real time, and return that."""
    end_s = time.monotonic() + time_s
    while time.monotonic() < end_s:
        try:
            driver.state()
        except DeviceError as error:
            return str(error)
        time.sleep(0.01)
    raise AssertionError("nothing was noticed")


def test_a_controller_needs_no_simulator():
    code = "import sys, simulation.loopback.server; print('pybullet' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_a_wrong_setting_is_named():
    command = [sys.executable, "-m", "simulation.loopback", "los=0.1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "los: unknown key; did you mean 'loss'?" in done.stderr


def test_in_real_time_it_moves_by_the_clock_and_death_is_noticed(start):
    process, driver = start(silence_s=3.0, overrun_s=3.0)
    begun_s, stamp_s = time.monotonic(), driver.state().stamp_s
    driver.execute(rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS))
    while driver.state().moving:
        time.sleep(0.01)
    passed_s = driver.state().stamp_s - stamp_s
    assert driver.state().positions_rad == pytest.approx(AWAY_RAD)
    assert passed_s == pytest.approx(time.monotonic() - begun_s, abs=0.5)
    assert abs(driver.state().stamp_s - driver.clock.now_s()) < 0.5
    process.kill()
    text = trouble(driver, 20.0)
    assert "the connection is lost" in text
    assert "got no answer to anything sent in the last 3.0" in text


def test_a_controller_that_hangs_is_noticed_within_the_stated_time(start):
    process, driver = start(silence_s=1.0, overrun_s=9.0)
    driver.execute(SLOW)
    process.freeze()
    began_s = time.monotonic()
    text = trouble(driver, 20.0)
    assert 0.5 < time.monotonic() - began_s < 5.0
    assert "expected one within 1 s" in text
    with pytest.raises(DeviceError, match="got no answer"):
        driver.stop()
    process.thaw()


def test_arms_whose_driver_has_gone_stop_by_themselves(start):
    process, driver = start(silence_s=0.8, overrun_s=9.0)
    driver.execute(rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS.slowed(0.1)))
    driver.close()
    another = None
    end_s = time.monotonic() + 20.0
    while another is None and time.monotonic() < end_s:
        with suppress(DeviceError):  # as long as its arms move
            another = start.another(process)
        time.sleep(0.05)
    here_rad = another.state().positions_rad
    assert not another.state().moving
    assert np.abs(here_rad - AWAY_RAD).max() > 0.02
    another.execute(rest_to_rest(here_rad, HOME_RAD, LIMITS))
    while another.state().moving:
        time.sleep(0.01)
    assert another.state().positions_rad == pytest.approx(HOME_RAD)


def test_a_stall_is_an_error_that_says_what_happened(start):
    _, driver = start(lockstep=True, stall_at_s=0.4, stall_s=0.4)
    driver.execute(SLOW)
    with pytest.raises(DeviceError, match=r"stopped the arms by itself: a cycle came 0.40 s late"):
        run(driver, 2.0)
    assert driver.clock.now_s() < 0.81


def test_a_long_stall_is_noticed_while_it_lasts(start):
    _, driver = start(lockstep=True, silence_s=0.2, stall_at_s=0.4, stall_s=5.0)
    driver.execute(SLOW)
    with pytest.raises(DeviceError, match=r"expected one within 0.2 s"):
        run(driver, 2.0)
    assert driver.clock.now_s() < 0.4 + 0.2 + 0.05


def test_cuts_are_bridged_and_nothing_is_lost(start):
    _, driver = start(lockstep=True, cuts_s=(0.1, 0.104, 0.5, 1.2), latency_s=0.01)
    driver.execute(SLOW)
    driver.grip("left", "cage")
    states = run(driver, 3.0)
    assert states[-1].positions_rad == pytest.approx(AWAY_RAD)
    assert states[-1].openings_m["left"] == pytest.approx(0.011)


def test_a_link_that_loses_a_fifth_still_serves(start):
    _, driver = start(lockstep=True, loss=0.2, jitter_s=0.02, seed=3)
    driver.execute(SLOW)
    assert run(driver, 3.0)[-1].positions_rad == pytest.approx(AWAY_RAD)


def test_the_same_seed_gives_the_same_run(start):
    def story(seed):
        _, driver = start(lockstep=True, loss=0.2, jitter_s=0.02, seed=seed)
        driver.execute(SLOW)
        driver.hold()
        return [(one.stamp_s, one.positions_rad.tobytes()) for one in run(driver, 1.0)]

    assert story(1) == story(1) != story(2)


def test_time_stands_still_while_nobody_waits(start):
    _, driver = start(lockstep=True)
    driver.execute(SLOW)
    time.sleep(0.05)
    assert driver.state().stamp_s == 0.0
    assert driver.clock.now_s() == 0.0


def test_the_death_of_a_controller_in_lockstep_ends_the_wait(start):
    process, driver = start(lockstep=True)
    process.kill()
    with pytest.raises(DeviceError, match="its time does not go on"):
        driver.clock.sleep_until(1.0)


def test_a_second_driver_is_refused(start):
    process, driver = start(lockstep=True)
    with pytest.raises(DeviceError, match="it serves another driver; expected one at a time"):
        start.another(process)
    assert not driver.state().moving


def test_a_refusal_that_comes_later_is_raised_once(start):
    _, driver = start(lockstep=True)
    driver.execute(rest_to_rest(HOME_RAD, HOME_RAD + 0.3, LIMITS.slowed(4.0)))
    with pytest.raises(DeviceError, match="a joint faster than it may be"):
        run(driver, 0.1)
    assert not driver.state().moving


def test_a_new_driver_may_move_after_an_emergency_stop(start):
    process, driver = start(lockstep=True)
    driver.execute(SLOW)
    run(driver, 0.5)
    driver.emergency_stop()
    stopped_rad = run(driver, 1.0)[-1].positions_rad
    driver.close()
    another = start.another(process)
    assert np.array_equal(another.state().positions_rad, stopped_rad)
    another.execute(rest_to_rest(stopped_rad, HOME_RAD, LIMITS))
    assert run(another, 1.0)[-1].positions_rad == pytest.approx(HOME_RAD)


@pytest.mark.parametrize(
    ("first", "match"),
    [(Hello(version=99, session="s"), "got version 99"), (Stop(number=1), "got no hello")],
)
def test_a_stranger_is_sent_away(start, first, match):
    process, _ = start(lockstep=True)
    with Wire.connect(process.host, process.port, 5.0) as wire:
        wire.send(first)
        assert wire.wait(5.0)
        (answer,) = wire.receive()
    assert isinstance(answer, Sorry)
    assert match in answer.text


def test_where_nobody_listens_the_message_says_so():
    with pytest.raises(DeviceError, match=r"cannot connect to 127.0.0.1:1: .*try: see that"):
        SocketArms("127.0.0.1", 1, settings=LinkSettings(answer_s=1.0))
