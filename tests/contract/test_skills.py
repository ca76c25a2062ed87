"""What every registered skill owes, whoever wrote it."""

import re

import pytest

from executive.app.catalogue import port_types, skills
from executive.core.skill import PausePolicy, Skill, device_types, input_ports

EVERY = [pytest.param(skills().get(name), id=name) for name in skills()]
DEVICES = {
    *("arms", "camera", "clock", "driver", "foresight", "processes", "rng", "vision", "worker"),
    *("detector", "search", "stock", "tool"),
}


@pytest.mark.parametrize("skill", EVERY)
def test_each_skill_says_what_it_does_and_when_it_succeeds(skill):
    assert skill.__doc__.strip().splitlines()[0].endswith(".")
    assert "SUCCESS:" in skill.__doc__


@pytest.mark.parametrize("skill", EVERY)
def test_each_port_says_what_it_carries(skill):
    for name, port in {**input_ports(skill), **skill.OUT}.items():
        assert port.about, f"{name} has no text"
        assert not name.endswith(("_m", "_s", "_rad")) or port.unit, f"{name} has no unit"


@pytest.mark.parametrize("skill", EVERY)
def test_reasons_are_codes_of_two_words(skill):
    assert all(re.fullmatch(r"[a-z]+\.[a-z_]+", code) for code in skill.REASONS)


@pytest.mark.parametrize("skill", EVERY)
def test_each_skill_that_moves_something_says_how_it_stops(skill):
    if skill.ACTS:
        assert "stop():" in skill.__doc__
        assert any("stop" in vars(base) for base in skill.__mro__[:-3])


@pytest.mark.parametrize("skill", EVERY)
def test_each_skill_binds_devices_that_the_cells_offer(skill):
    assert set(device_types(skill)) <= DEVICES


# What a device is part of; whoever commands the device needs it alone.
CLAIMED_BY_DEVICE = {
    "arms": {"left_arm", "right_arm"},
    "driver": {"left_arm", "right_arm"},
    "camera": {"camera"},
    "tool": {"tool"},
}


@pytest.mark.parametrize("skill", EVERY)
def test_each_skill_claims_what_it_commands(skill):
    needed = [CLAIMED_BY_DEVICE.get(device, set()) for device in device_types(skill)]
    assert set().union(*needed) == skill.CLAIMS
    assert skill.CLAIMS or not skill.ACTS


@pytest.mark.parametrize("skill", EVERY)
def test_each_skill_that_moves_something_comes_to_rest_when_it_is_paused(skill):
    if skill.ACTS and skill.PAUSE is PausePolicy.HOLD:
        for method in ("on_pause", "on_resume", "resting"):
            assert getattr(skill, method) is not getattr(Skill, method)


def test_types_of_ports_have_names_for_yaml():
    assert {"CableClaim", "CameraFrame", "Trace"} <= set(port_types())
