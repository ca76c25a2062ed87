"""Whatever is asked over whatever link: limits hold, stops stop, nothing is done unasked."""

import numpy as np
import pytest

from executive.core.errors import DeviceError
from robots.drivers.socket_arms import SocketArms
from robots.limits import yumi_limits
from robots.motion.timing import rest_to_rest
from robots.placement import HOME_RAD
from simulation.loopback.process import LoopbackProcess
from simulation.loopback.settings import LoopbackSettings

LIMITS = yumi_limits()
LENGTH_S = 4.0
# A command may be lost a few times over, and then a stop takes as long as one does.
STOPPED_S = 1.5
COMMANDS = ("nothing", "execute", "hold", "go_on", "stop", "grip")
SHARES = (0.95, 0.0175, 0.01, 0.01, 0.0075, 0.005)


def link(rng):
    return {
        "latency_s": float(rng.uniform(0.0, 0.06)),
        "jitter_s": float(rng.choice([0.0, 0.05])),
        "loss": float(rng.choice([0.0, 0.1, 0.3])),
        "cuts_s": tuple(rng.uniform(0.0, LENGTH_S, 3)),
    }


def move(driver, rng):
    """Start a motion, which must be refused while one is under way; return whether it began."""
    state = driver.state()
    slower = LIMITS.slowed(rng.uniform(0.3, 1.0))
    motion = rest_to_rest(state.positions_rad, HOME_RAD + rng.uniform(-0.4, 0.4), slower)
    if state.moving:
        with pytest.raises(DeviceError, match="is under way"):
            driver.execute(motion)
    else:
        driver.execute(motion)
    return not state.moving


def story(driver, rng):
    """Ask for things at random; return the states, and whether each was long after a stop."""
    states, calm, stopped_s = [driver.state()], [False], np.inf
    while driver.clock.now_s() < LENGTH_S:
        command = rng.choice(COMMANDS, p=SHARES)
        if command == "execute" and move(driver, rng):
            stopped_s = np.inf
        elif command == "stop":
            driver.stop()
            stopped_s = min(stopped_s, driver.clock.now_s())
        elif command == "grip":
            driver.grip("left", str(rng.choice(["open", "cage", "pinch"])))
        elif command in ("hold", "go_on"):
            getattr(driver, command)()
        driver.clock.sleep_until(driver.clock.now_s() + driver.cycle_s)
        state = driver.state()
        if state.stamp_s > states[-1].stamp_s:
            states.append(state)
            calm.append(state.stamp_s > stopped_s + STOPPED_S)
    return states, calm


@pytest.mark.parametrize("seed", range(3))
def test_limits_hold_and_stops_stop_over_any_link(seed):
    rng = np.random.default_rng(seed)
    settings = LoopbackSettings(lockstep=True, seed=seed, **link(rng))
    with LoopbackProcess(settings) as process:
        driver = SocketArms(process.host, process.port)
        states, calm = story(driver, rng)
        driver.close()
    steps_s = np.diff([state.stamp_s for state in states])[:, None]
    positions, velocities, accelerations = (
        np.array([getattr(state, name) for state in states])
        for name in ("positions_rad", "velocities_rad_s", "accelerations_rad_s2")
    )
    assert (np.abs(np.diff(positions, axis=0) / steps_s) <= LIMITS.velocity * 1.001).all()
    assert (np.abs(velocities) <= LIMITS.velocity * 1.001).all()
    assert (np.abs(accelerations) <= LIMITS.acceleration * 1.001).all()
    assert (np.abs(np.diff(accelerations, axis=0) / steps_s) <= LIMITS.jerk * 1.001).all()
    assert np.abs(positions - HOME_RAD).max() > 0.05
    assert not any(state.moving for state, rests in zip(states, calm, strict=True) if rests)
