"""The reply to each request of Groot2's protocol: frames in, frames out, whatever comes in."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Final

from executive.core.errors import CellwrightError, InputError, RecordingError
from executive.engine.running.remote import send
from executive.inspector.groot.hooks import Hooks, Send
from executive.inspector.groot.run_view import RunView
from executive.inspector.groot.wire import (
    Header,
    Request,
    read_header,
    write_header,
    write_statuses,
    write_transitions,
)

Frames = list[bytes]

QUIET_S: Final = 5.0
"""After so long without a request the client is taken to be gone, and its hooks with it."""

_NOT_FROM_ELSEWHERE: Final = (
    "hooks are refused: this protocol has no password, so only a server that no other machine "
    "reaches takes them; try cellwright groot without --host"
)


class Answers:
    """Answers the requests of clients that watch one run."""

    def __init__(
        self,
        view: RunView,
        *,
        steering: bool,
        send_command: Send | None = None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """Answer out of a view of a run.

        Args:
            view: The run.
            steering: Whether clients may set breakpoints and force answers.
            send_command: How commands reach the mission; over its socket by default.
            now: The machine's clock [s].
        """
        self._view, self._steering, self._now = view, steering, now
        self._send: Send = send_command or partial(send, view.path)
        self._hooks = Hooks(view.tree, self._send)
        self._heard_s, self._present = now(), True
        self._answers: Mapping[Request, Callable[[bytes], Frames]] = {
            Request.FULLTREE: lambda _: [view.tree.xml.encode()],
            Request.STATUS: lambda _: [write_statuses(view.statuses())],
            Request.BLACKBOARD: self._blackboard,
            Request.HOOK_INSERT: self._steered(lambda data: self._hooks.insert(data)),
            Request.HOOK_REMOVE: self._steered(lambda data: self._hooks.remove(data)),
            Request.BREAKPOINT_UNLOCK: self._steered(lambda data: self._hooks.unlock(data)),
            Request.HOOKS_DUMP: lambda _: [self._hooks.dump()],
            Request.REMOVE_ALL_HOOKS: self._steered(lambda _: self._hooks.remove_all()),
            Request.DISABLE_ALL_HOOKS: self._steered(lambda _: self._hooks.enable_all(False)),
            Request.TOGGLE_RECORDING: self._toggle,
            Request.GET_TRANSITIONS: lambda _: [write_transitions(view.take_transitions())],
        }

    def reply(self, request: Sequence[bytes]) -> Frames:
        """Return the frames that answer a request; what is none is told so."""
        self._heard_s = self._now()
        try:
            return self._replied(request)
        except CellwrightError as error:
            return [b"error", str(error).encode()]

    def tend(self) -> list[Frames]:
        """Follow the run; return what subscribers are to hear: breakpoints that were hit.

        The hooks of a client that has gone are taken back, so that no mission waits for it.
        """
        self._follow()
        present = self._now() - self._heard_s < QUIET_S
        if present is not self._present:
            self._present = present
            self._hooks.enable_all(present)
        head = write_header(Header(Request.BREAKPOINT_REACHED, 0))
        return [[head, str(uid).encode()] for uid in self._hooks.reached()]

    def close(self) -> None:
        """Take all hooks back."""
        self._hooks.remove_all()

    def _replied(self, request: Sequence[bytes]) -> Frames:
        header = read_header(request[0] if request else b"")
        answer = self._answers.get(header.request)
        if answer is None:
            raise InputError(f"{header.request.name} is told by this side, not asked")
        self._follow()
        body = answer(request[1] if len(request) > 1 else b"")
        return [write_header(header) + self._view.tree.tree_id, *body]

    def _follow(self) -> None:
        tree = self._view.tree
        with suppress(RecordingError):  # what is written at this moment can be read a moment later
            self._view.refresh()
        if self._view.tree is not tree:  # another run in the same file: its nodes are others
            self._hooks = Hooks(self._view.tree, self._send)

    def _blackboard(self, data: bytes) -> Frames:
        names = [name for name in data.decode(errors="replace").split(";") if name]
        return [self._view.blackboards(names)]

    def _toggle(self, data: bytes) -> Frames:
        if data not in (b"start", b"stop"):
            raise InputError("expected start or stop")
        self._view.record_transitions(data == b"start")
        return [str(time.time_ns() // 1000).encode()] if data == b"start" else []

    def _steered(self, act: Callable[[bytes], None]) -> Callable[[bytes], Frames]:
        def answer(data: bytes) -> Frames:
            if not self._steering:
                raise InputError(_NOT_FROM_ELSEWHERE)
            act(data)
            return []

        return answer
