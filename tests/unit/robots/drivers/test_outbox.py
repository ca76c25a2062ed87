"""No command is lost, and none that was given up comes back."""

import pytest

from robots.drivers.messages import EmergencyStop, Execute, GoOn, GripCommand, Hold, Stop
from robots.drivers.outbox import Outbox


@pytest.fixture
def outbox():
    return Outbox(resend_s=0.1, resend_stop_s=0.02)


def kinds(commands):
    return [type(command) for command in commands]


def test_commands_go_once_in_order_and_again_when_overdue(outbox):
    outbox.execute(0.004, b"")
    outbox.hold()
    outbox.go_on()
    assert kinds(outbox.due(0.0)) == [Execute, Hold, GoOn]
    assert not outbox.due(0.09)
    outbox.taken(1)
    assert [command.number for command in outbox.due(0.1)] == [2, 3]
    outbox.taken(3)
    assert not outbox.due(9.0)


def test_stops_are_repeated_sooner(outbox):
    outbox.stop()
    assert kinds(outbox.due(0.0)) == [Stop]
    assert not outbox.due(0.01)
    assert kinds(outbox.due(0.02)) == [Stop]


def test_everything_goes_again_over_another_connection(outbox):
    outbox.hold()
    outbox.due(0.0)
    outbox.send_anew()
    assert kinds(outbox.due(0.0)) == [Hold]


def test_a_stop_gives_motions_up_and_lets_grips_come_after_it(outbox):
    outbox.execute(0.004, b"")
    outbox.grip("left", "pinch")
    outbox.hold()
    outbox.stop()
    due = outbox.due(0.0)
    assert kinds(due) == [Stop, GripCommand]
    assert [command.number for command in due] == [4, 5]
    assert outbox.may_move  # until the stop is taken, the motion may have begun
    outbox.taken(4)
    assert not outbox.may_move
    assert outbox.grips("left")
    assert not outbox.grips("right")


def test_an_emergency_stop_gives_everything_up(outbox):
    outbox.execute(0.004, b"")
    outbox.grip("left", "pinch")
    outbox.stop()
    outbox.emergency_stop()
    assert kinds(outbox.due(0.0)) == [EmergencyStop]
    assert not outbox.grips("left")


def test_says_what_is_on_its_way(outbox):
    outbox.grip("right", "cage")
    assert not outbox.commands_motion
    assert not outbox.may_move
    outbox.execute(0.004, b"")
    assert outbox.commands_motion
    assert outbox.may_move
    outbox.taken(2)
    assert not any([outbox.commands_motion, outbox.may_move, outbox.grips("right")])
