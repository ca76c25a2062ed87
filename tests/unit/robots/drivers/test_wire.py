"""Messages come out of a wire as they went in, or not at all."""

import socket
import struct
from contextlib import closing

import numpy as np
import pytest

from robots.drivers import messages
from robots.drivers.messages import Beat, Execute, Hello, WireError, numbers, row
from robots.drivers.wire import Wire

ROW = row(np.arange(14.0))
EVERY = [
    messages.Hello(version=1, session="s"),
    messages.Beat(time_s=1.0, seen_s=2.0),
    messages.Execute(number=1, period_s=0.004, samples=bytes(1 << 20)),
    messages.GripCommand(number=2, arm="left", grip="pinch"),
    messages.Hold(number=3),
    messages.GoOn(number=4),
    messages.Stop(number=5),
    messages.EmergencyStop(number=6),
    messages.Advance(until_s=0.004),
    messages.Welcome(
        version=1,
        resumed=False,
        now_s=0.0,
        cycle_s=0.004,
        silence_s=0.5,
        tolerance_rad=1e-4,
        lockstep=True,
    ),
    messages.Sorry(text="no"),
    messages.ControllerState(
        stamp_s=0.1,
        mode="rest",
        held=False,
        positions_rad=ROW,
        velocities_rad_s=ROW,
        accelerations_rad_s2=ROW,
        openings_m=(0.05, 0.0),
        gripping=(True, False),
        holding=(False, True),
        taken=3,
        refused=2,
        refusal="why",
        echo_s=None,
        fault="",
    ),
    messages.Advanced(now_s=0.004),
]


@pytest.fixture
def ends():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        near = socket.create_connection(listener.getsockname())
        far, _ = listener.accept()
    with closing(near), closing(far):
        yield near, far


def received(wire, others):
    """Return the next messages while the other end goes on sending."""
    got = []
    while not got:
        for other in others:
            other.receive()
        wire.wait(1.0)
        got = wire.receive()
    return got


def test_there_is_one_of_every_kind():
    assert {type(one) for one in EVERY} == {
        kind
        for kind in vars(messages).values()
        if isinstance(kind, type) and "kind" in getattr(kind, "model_fields", {})
    }


@pytest.mark.parametrize("message", EVERY, ids=lambda one: one.kind)
def test_a_message_comes_out_as_it_went_in(ends, message):
    near, far = map(Wire, ends)
    near.send(message)
    assert received(far, [near]) == [message]


def test_messages_come_in_order_whatever_the_pieces(ends):
    near, far = ends
    sent = [Beat(time_s=float(number), seen_s=0.0) for number in range(20)]
    bodies = [messages.to_bytes(message) for message in sent]
    data = b"".join(struct.pack("<I", len(body)) + body for body in bodies)
    wire, got = Wire(far), []
    for start in range(0, len(data), 7):
        near.sendall(data[start : start + 7])
        wire.wait(1.0)
        got += wire.receive()
    while len(got) < len(sent):
        assert wire.wait(1.0)
        got += wire.receive()
    assert got == sent


def test_what_was_sent_before_the_end_is_read_first(ends):
    near, far = ends
    with Wire(near) as sender:
        sender.send(Beat(time_s=1.0, seen_s=0.0))
    wire = Wire(far)
    wire.wait(1.0)
    assert wire.receive() == [Beat(time_s=1.0, seen_s=0.0)]
    with pytest.raises(WireError, match="the other end closed the connection"):
        wire.receive()


@pytest.mark.parametrize(
    ("data", "match"),
    [
        (struct.pack("<I", 3) + b"abc", "no MessagePack|none"),
        (struct.pack("<I", 1) + b"\xc1", "no MessagePack"),
        (struct.pack("<I", 1) + b"\x01", "a message that is none"),
        (struct.pack("<I", 0xFFFFFFFF), "expected .* at most"),
    ],
)
def test_what_is_no_message_ends_the_connection(ends, data, match):
    near, far = ends
    near.sendall(data)
    wire = Wire(far)
    wire.wait(1.0)
    with pytest.raises(WireError, match=match):
        wire.receive()


def test_a_message_with_a_field_too_many_is_none():
    data = messages.to_bytes(Hello(version=1, session="s")).replace(b"session", b"sessiom")
    with pytest.raises(WireError, match="session"):
        messages.from_bytes(data)


def test_a_row_is_fourteen_numbers():
    assert np.array_equal(numbers(ROW), np.arange(14.0))
    state = next(one for one in EVERY if one.kind == "state")
    short = state.model_copy(update={"positions_rad": ROW[:-1]})
    with pytest.raises(WireError, match="positions_rad: Data should have at least 112 bytes"):
        messages.from_bytes(messages.to_bytes(short))


def test_numbers_of_commands_begin_at_one():
    with pytest.raises(ValueError, match="greater than or equal to 1"):
        Execute(number=0, period_s=0.004, samples=b"")
