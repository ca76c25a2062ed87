"""Groot2's hooks: breakpoints and forced answers of a mission that runs.

They are set in the process that runs the mission, through the commands that `cellwright attach`
uses too. A hook before a node holds it when it starts, not again in every tick in which it runs.
A hook after a node holds the mission when the node has ended; to answer in its place then is
refused, because our debugger answers instead of running a node.
"""

import json
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal, Protocol, TypeVar

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from executive.core.errors import InputError
from executive.core.json_files import first_fault
from executive.engine.running.remote import NotRunningError
from executive.inspector.groot.live_tree import LiveTree

_BY: Final = "groot"
_EVENTS: Final = ("start", "end")
_ANSWERS: Final = {"SUCCESS": "success", "FAILURE": "failure"}
_BREAKPOINT: Final = 0

Uid = Annotated[int, Field(ge=0, le=0xFFFF)]
Status = Literal["SUCCESS", "FAILURE", "SKIPPED", "RUNNING", "IDLE"]
_Form = TypeVar("_Form")


class Place(BaseModel):
    """Before a node (0) or after it (1)."""

    model_config = ConfigDict(frozen=True, extra="ignore")  # newer clients may say more

    uid: Uid
    position: Literal[0, 1]


class Hook(Place):
    """What a client wants done at a node; `mode` 0 is a breakpoint, 1 an answer in its place."""

    enabled: bool
    mode: Literal[0, 1]
    once: bool
    desired_status: Status


class Unlock(Place):
    """Go on from a breakpoint; a status other than SKIPPED is answered in the node's place."""

    desired_status: Status
    remove_when_done: bool


_PLACE: Final = TypeAdapter(Place)
_UNLOCK: Final = TypeAdapter(Unlock)
_HOOKS: Final[TypeAdapter[Hook | list[Hook]]] = TypeAdapter(Hook | list[Hook])


class Send(Protocol):
    """Sends a command to the process that runs the mission, and returns its answer."""

    def __call__(self, command: str, **arguments: object) -> Any:
        """Send it.

        Raises:
            InputError: It was refused, or no mission runs.
        """
        ...


@dataclass(slots=True)
class _Kept:
    """A hook; `number` is that of its breakpoint where one is set."""

    hook: Hook
    path: str
    number: int | None = None
    hits: int = 0

    def holds(self, state: Any) -> bool:
        """Return whether the mission stands there."""
        standing = state["standing"]
        return standing is not None and standing["why"].startswith(f"breakpoint {self.number}: ")


class Hooks:
    """The hooks of one mission."""

    def __init__(self, tree: LiveTree, send: Send) -> None:
        """Keep hooks of a tree; `send` reaches the mission."""
        self._tree, self._send = tree, send
        self._kept: dict[tuple[int, int], _Kept] = {}

    def insert(self, data: bytes) -> None:
        """Set a hook or several; one that is at the same place is replaced.

        Raises:
            InputError: It is none, or the mission refuses it.
        """
        asked = _read(_HOOKS, data)
        for hook in asked if isinstance(asked, list) else [asked]:
            kept = _Kept(hook, self._tree.nodes[self._tree.index(hook.uid)].path)
            _check(hook)
            self._drop(hook)
            if hook.enabled:
                self._arm(kept)
            self._kept[_key(hook)] = kept

    def remove(self, data: bytes) -> None:
        """Take a hook away; a mission that stands there goes on.

        Raises:
            InputError: There is none.
        """
        place = _read(_PLACE, data)
        self._at(place)
        self._drop(place)

    def remove_all(self) -> None:
        """Take all hooks away."""
        for kept in [*self._kept.values()]:
            self._drop(kept.hook)

    def enable_all(self, wanted: bool) -> None:
        """Set all hooks again, or take them back without forgetting them."""
        for key, kept in self._kept.items():
            if kept.hook.enabled is wanted:
                continue
            self._kept[key] = changed = _Kept(
                kept.hook.model_copy(update={"enabled": wanted}), kept.path
            )
            with suppress(NotRunningError):
                if wanted:
                    self._arm(changed)
                else:
                    self._disarm(kept)

    def unlock(self, data: bytes) -> None:
        """Let the mission go on from a breakpoint.

        Raises:
            InputError: The mission does not stand there, or the answer cannot be forced.
        """
        asked = _read(_UNLOCK, data)
        kept = self._at(asked)
        if not kept.holds(self._send("state")):
            raise InputError(f"the mission does not stand at node {asked.uid}")
        if asked.desired_status in _ANSWERS:
            if asked.position == 1:
                raise InputError("a node that has ended keeps its answer; try a hook before it")
            self._force(kept.path, asked.desired_status, once=True)
        if asked.remove_when_done or kept.hook.once:
            del self._kept[_key(asked)]
            self._send("unbreak", number=kept.number, by=_BY)
        self._send("resume", by=_BY)

    def dump(self) -> bytes:
        """Return all hooks as JSON."""
        self._forget_used()
        return json.dumps([kept.hook.model_dump() for kept in self._kept.values()]).encode()

    def reached(self) -> Iterator[int]:
        """Yield the node of each breakpoint that was hit since the last call."""
        waiting = {kept.number: kept for kept in self._kept.values() if kept.number is not None}
        if not waiting:
            return
        try:
            state = self._send("state")
        except NotRunningError:
            return
        for one in state["breakpoints"]:
            kept = waiting.get(one["number"])
            if kept is not None and one["hits"] > kept.hits:
                kept.hits = one["hits"]
                yield kept.hook.uid

    def _at(self, place: Place) -> _Kept:
        kept = self._kept.get(_key(place))
        if kept is None:
            raise InputError(f"no hook at node {place.uid}, position {place.position}")
        return kept

    def _arm(self, kept: _Kept) -> None:
        hook = kept.hook
        if hook.mode != _BREAKPOINT:
            self._force(kept.path, hook.desired_status, once=hook.once)
            return
        text = f"{kept.path} on {_EVENTS[hook.position]}"
        state = self._send("break", text=text, by=_BY)
        kept.number = max(one["number"] for one in state["breakpoints"] if one["text"] == text)

    def _force(self, path: str, status: str, *, once: bool) -> None:
        self._send("force", nodes=path, answer=_ANSWERS[status], once=once, by=_BY)

    def _drop(self, place: Place) -> None:
        kept = self._kept.pop(_key(place), None)
        if kept is not None and kept.hook.enabled:
            with suppress(NotRunningError):
                self._disarm(kept)

    def _disarm(self, kept: _Kept) -> None:
        if kept.number is None:
            self._send("unforce", nodes=kept.path, by=_BY)
            return
        stands = kept.holds(self._send("state"))
        with suppress(InputError):  # somebody at a terminal has taken it away
            self._send("unbreak", number=kept.number, by=_BY)
        if stands:
            self._send("resume", by=_BY)

    def _forget_used(self) -> None:
        """Forget answers that were forced once, and have been given."""
        once = [
            kept for kept in self._kept.values() if kept.hook.once and kept.hook.mode != _BREAKPOINT
        ]
        if not once:
            return
        with suppress(NotRunningError):
            forced = self._send("state")["forced"]
            for kept in once:
                if kept.hook.enabled and kept.path not in forced:
                    del self._kept[_key(kept.hook)]


def _key(place: Place) -> tuple[int, int]:
    return place.uid, place.position


def _check(hook: Hook) -> None:
    if hook.mode == _BREAKPOINT:
        return
    if hook.position == 1:
        raise InputError("a node that has ended keeps its answer; try a hook before it")
    if hook.desired_status not in _ANSWERS:
        raise InputError(f"desired_status: got {hook.desired_status}; expected SUCCESS or FAILURE")


def _read(form: TypeAdapter[_Form], data: bytes) -> _Form:
    try:
        return form.validate_json(data)
    except ValidationError as error:
        raise InputError(first_fault(error)) from None
