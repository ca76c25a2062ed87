"""The sockets of Groot2's protocol: requests on one port, breakpoints on the next."""

import time
from contextlib import closing
from typing import Final

import zmq

from executive.core.errors import InputError
from executive.inspector.groot.answers import Answers

_POLL_MS: Final = 50
_LARGEST_REQUEST_BYTES: Final = 2**20
_TRIES: Final = 20


class GrootServer:
    """Serves one run until it is stopped.

    Attributes:
        port: Port of the requests; breakpoints are told on the next one.
    """

    def __init__(self, answers: Answers, host: str, port: int) -> None:
        """Take the ports; with port 0, two that are free.

        Raises:
            InputError: They cannot be had.
        """
        self._answers = answers
        self._stopping = False
        self._context = zmq.Context()
        # Not REP: its lockstep of requests and replies is brought out of step by garbage.
        self._requests = self._socket(zmq.ROUTER)
        self._news = self._socket(zmq.PUB)
        self._requests.setsockopt(zmq.MAXMSGSIZE, _LARGEST_REQUEST_BYTES)
        try:
            self.port = self._bound(host, port)
        except zmq.ZMQError as error:
            self._context.destroy(linger=0)
            shown = f"{port} and {port + 1}" if port else "two in a row"
            raise InputError(f"{host}: ports {shown} cannot be had: {error}") from None

    def serve(self) -> None:
        """Answer until `stop` is called or the process is interrupted; then let go."""
        with closing(self):
            told_s = 0.0
            while not self._stopping:
                if self._requests.poll(_POLL_MS):
                    self._answer()
                if time.monotonic() - told_s >= _POLL_MS / 1000:
                    told_s = time.monotonic()
                    for news in self._answers.tend():
                        self._news.send_multipart(news)

    def _answer(self) -> None:
        try:
            # What was announced may be dropped as garbage, and then there is nothing to wait for.
            client, *rest = self._requests.recv_multipart(zmq.NOBLOCK)
        except zmq.Again:
            return
        if len(rest) > 1 and rest[0] == b"":  # as REQ sockets ask
            self._requests.send_multipart([client, b"", *self._answers.reply(rest[1:])])

    def stop(self) -> None:
        """End `serve` soon; may be called from any thread."""
        self._stopping = True

    def close(self) -> None:
        """Take hooks back and give the ports free."""
        self._answers.close()
        self._context.destroy(linger=0)

    def _socket(self, kind: int) -> "zmq.Socket[bytes]":
        socket = self._context.socket(kind)
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.IPV6, 1)
        return socket

    def _bound(self, host: str, port: int) -> int:
        address = f"tcp://[{host}]" if ":" in host else f"tcp://{host}"
        if port:
            self._requests.bind(f"{address}:{port}")
            self._news.bind(f"{address}:{port + 1}")
            return port
        for tries_left in reversed(range(_TRIES)):
            free = self._requests.bind_to_random_port(address)
            try:
                self._news.bind(f"{address}:{free + 1}")
            except zmq.ZMQError:
                self._requests.unbind(f"{address}:{free}")
                if not tries_left:
                    raise
            else:
                return free
        raise AssertionError
