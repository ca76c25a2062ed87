"""A plain client that speaks Groot2's protocol by its description, none of our code."""

import json
import struct

import zmq

HEADER = struct.Struct("<BBI")


def request(letter, *more, number=7):
    """Return the frames of a request."""
    return [HEADER.pack(2, ord(letter), number), *more]


def statuses_in(data):
    """Return the status of each node by its number."""
    assert len(data) % 3 == 0
    return dict(struct.iter_unpack("<HB", data))


def transitions_in(data):
    """Return microseconds, number of the node and status of each transition."""
    assert len(data) % 9 == 0
    return [
        (
            int.from_bytes(data[i : i + 6], "little"),
            *struct.unpack("<HB", data[i + 6 : i + 9]),
        )
        for i in range(0, len(data), 9)
    ]


def hook(uid, *, position=0, mode=0, status="SKIPPED", once=False, enabled=True):
    """Return a hook as Groot2 sends it."""
    return json.dumps(
        {
            "uid": uid,
            "position": position,
            "mode": mode,
            "desired_status": status,
            "once": once,
            "enabled": enabled,
        }
    ).encode()


def unlock(uid, *, position=0, status="SKIPPED", remove=False):
    """Return the request to go on from a breakpoint."""
    return json.dumps(
        {"uid": uid, "position": position, "desired_status": status, "remove_when_done": remove}
    ).encode()


class Client:
    """Asks a server over a socket; an answer that does not come is an error."""

    def __init__(self, port, wait_ms=20_000):
        self._context = zmq.Context()
        self._asking = self._context.socket(zmq.REQ)
        self._asking.setsockopt(zmq.RCVTIMEO, wait_ms)
        self._asking.connect(f"tcp://127.0.0.1:{port}")
        self._hearing = self._context.socket(zmq.SUB)
        self._hearing.setsockopt(zmq.RCVTIMEO, wait_ms)
        self._hearing.subscribe(b"")
        self._hearing.connect(f"tcp://127.0.0.1:{port + 1}")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._context.destroy(linger=0)

    def ask(self, letter, *more):
        """Return the frames after the header of the reply, `error` first for an error."""
        asked = request(letter, *more)
        self._asking.send_multipart(asked)
        head, *body = self._asking.recv_multipart()
        if head == b"error":
            return [head, *body]
        assert head[:6] == asked[0]
        assert len(head) == 22
        return body

    def heard(self):
        """Return the number of the node whose breakpoint is told next."""
        head, uid = self._hearing.recv_multipart()
        assert HEADER.unpack(head)[:2] == (2, ord("N"))
        return int(uid)
