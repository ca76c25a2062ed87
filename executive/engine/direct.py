"""Ticks and stops of each kind of node as plain calls: what `executive.engine.ticking` is made of.

py_trees ticks with nested generators: every answer climbs through all ancestors, and every
`stop` writes a line for a log that nobody reads. Each function here makes the calls of one
kind of node that do the same without either: same statuses, same order of answers, same calls
of `initialise`, `update` and `terminate`. They are closures, because they are the innermost
loop of the executive and a closure finds its parts faster than an object does.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.engine.ticks import NodeStatus

RUNNING, SUCCESS, FAILURE, INVALID = (
    Status.RUNNING,
    Status.SUCCESS,
    Status.FAILURE,
    Status.INVALID,
)

Event = tuple[int, NodeStatus]
"""A node answered, or, with INVALID, was stopped before it had finished or told to forget."""

TickCall = Callable[[], Status]
"""Ticks a node and everything below it; returns its answer."""

StopCall = Callable[[Status], None]
"""Brings a node to an end with a status, as `Behaviour.stop` does."""


@dataclass(slots=True, eq=False)
class TickLog:
    """What happens in a tick, in order.

    Attributes:
        events: Answers and stops.
        broken: Nodes that answered with no status (trap e13).
        unseen: Nodes whose status may have changed without an event: those below a node that
            only py_trees itself can tick or stop.
        raised: Node whose method raised; None where none did.
        terminating: Whether that was in `terminate`.
    """

    events: list[Event] = field(default_factory=list)
    broken: list[Behaviour] = field(default_factory=list)
    unseen: set[int] = field(default_factory=set)
    raised: Behaviour | None = None
    terminating: bool = False

    def clear(self) -> None:
        """Begin a new tick."""
        self.events.clear()
        self.broken.clear()
        self.unseen.clear()
        self.raised, self.terminating = None, False

    def note_raised(self, node: Behaviour, *, terminating: bool) -> None:
        """Remember who raised; the first to say so is the innermost."""
        if self.raised is None:
            self.raised, self.terminating = node, terminating


@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """One node, and what the calls of its kind need.

    Attributes:
        node: The node; `Any`, since kinds have attributes of their own.
        index: Its index.
        log: Where its answers go.
        stop: Its `stop`.
        ticks: Ticks of its children.
        stops: Stops of its children.
    """

    node: Any
    index: int
    log: TickLog
    stop: StopCall
    ticks: Sequence[TickCall]
    stops: Sequence[StopCall]

    @property
    def children(self) -> tuple[tuple[Any, StopCall], ...]:
        """Children with their stops."""
        return tuple(zip(self.node.children, self.stops, strict=True))

    def defines(self, method: str) -> bool:
        """Return whether the node does something where py_trees calls a method of it."""
        own = method in vars(self.node)
        return own or getattr(type(self.node), method) is not getattr(Behaviour, method)

    def answers(self) -> tuple[Event, Event, Event]:
        """Return what it may answer: running, success, failure."""
        return (
            (self.index, NodeStatus.RUNNING),
            (self.index, NodeStatus.SUCCESS),
            (self.index, NodeStatus.FAILURE),
        )


def stop_of_leaf(spot: Spot) -> StopCall:
    """Stop a node without children."""
    node, log, events = spot.node, spot.log, spot.log.events
    stopped = spot.index, NodeStatus.INVALID

    def stop_silent(status: Status) -> None:
        node.status = status
        if status is INVALID:
            events.append(stopped)

    if not spot.defines("terminate"):
        return stop_silent

    def stop(status: Status) -> None:
        try:
            node.terminate(status)
        except BaseException:
            log.note_raised(node, terminating=True)
            raise
        node.status = status
        if status is INVALID:
            events.append(stopped)

    return stop


def stop_of_composite(spot: Spot) -> StopCall:
    """Stop a composite: when it is told to forget, its children first."""
    node, children, itself = spot.node, spot.children, stop_of_leaf(spot)

    def stop(status: Status) -> None:
        if status is INVALID:
            node.current_child = None
            _forget(children)
        itself(status)

    return stop


def stop_of_decorator(spot: Spot) -> StopCall:
    """Stop a decorator, and then its child."""
    node, log, events = spot.node, spot.log, spot.log.events
    stopped = spot.index, NodeStatus.INVALID
    ((child, stop_child),), terminates = spot.children, spot.defines("terminate")

    def stop(status: Status) -> None:
        try:
            if terminates:
                node.terminate(status)
        except BaseException:
            log.note_raised(node, terminating=True)
            raise
        try:
            if status is INVALID or child.status is RUNNING:
                stop_child(INVALID)
        finally:
            # Also when the child raised: its own `terminate` is not to be called again.
            node.status = status
            if status is INVALID:
                events.append(stopped)

    return stop


def stop_of_while_running(spot: Spot) -> StopCall:
    """Stop a decorator, and its child only when it is halted."""
    halt, itself = stop_of_decorator(spot), stop_of_leaf(spot)
    return lambda status: halt(status) if status is INVALID else itself(status)


def tick_of_leaf(spot: Spot) -> TickCall:
    """Tick a node by its `initialise` and `update` alone."""
    node, stop, log, note = spot.node, spot.stop, spot.log, spot.log.events.append
    running, success, failure = spot.answers()
    broken, initialises = _broken(spot), spot.defines("initialise")

    def tick() -> Status:
        try:
            if initialises and node.status is not RUNNING:
                node.initialise()
            status = node.update()
        except BaseException:
            log.note_raised(node, terminating=False)
            raise
        if status is RUNNING:
            node.status = RUNNING
            note(running)
            return RUNNING
        if status is SUCCESS:
            stop(SUCCESS)
            note(success)
            return SUCCESS
        if status is FAILURE:
            stop(FAILURE)
            note(failure)
            return FAILURE
        return broken()

    return tick


def tick_of_decorator(spot: Spot) -> TickCall:
    """Tick the child, then ask `update`."""
    node, log, finish = spot.node, spot.log, _finish(spot)
    (tick_child,) = spot.ticks

    def tick() -> Status:
        try:
            if node.status is not RUNNING:
                node.initialise()
            tick_child()
            status = node.update()
        except BaseException:
            log.note_raised(node, terminating=False)
            raise
        return finish(status)

    return tick


def tick_of_one_shot(spot: Spot) -> TickCall:
    """Tick as a decorator until there is a final status, as a leaf from then on."""
    node, once, again = spot.node, tick_of_decorator(spot), tick_of_leaf(spot)
    return lambda: again() if node.final_status else once()


def tick_of_gated(spot: Spot) -> TickCall:
    """Ask `before`; unless that answers, tick the child and ask `update`."""
    node, log, finish = spot.node, spot.log, _finish(spot)
    (tick_child,) = spot.ticks

    def tick() -> Status:
        try:
            if node.status is not RUNNING:
                node.outcome = None
                node.initialise()
            status = node.before()
            if status is None:
                tick_child()
                status = node.update()
        except BaseException:
            log.note_raised(node, terminating=False)
            raise
        return finish(status)

    return tick


def tick_of_sequence(spot: Spot) -> TickCall:
    """Tick children in order up to the first that does not succeed."""
    node, log, finish = spot.node, spot.log, _finish(spot)
    children, ticks, initialises = spot.children, tuple(spot.ticks), spot.defines("initialise")
    count, place = len(children), {id(child): i for i, (child, _) in enumerate(children)}

    def begin() -> int:
        """Return where to begin."""
        if node.status is RUNNING and node.memory and node.current_child is not None:
            return place[id(node.current_child)]
        node.current_child = children[0][0] if children else None
        if node.status is not RUNNING:
            _forget(children)
            if initialises:
                node.initialise()
        return 0

    def tick() -> Status:
        try:
            i = begin()
            while i < count:
                status = ticks[i]()
                i += 1
                if status is not SUCCESS:
                    if i < count and not node.memory:
                        _forget(children[i:])
                    return finish(status)
                if i < count:
                    node.current_child = children[i][0]
        except BaseException:
            log.note_raised(node, terminating=False)
            raise
        return finish(SUCCESS)

    return tick


def tick_of_selector(spot: Spot) -> TickCall:
    """Tick children in order up to the first that does not fail."""
    node, log, finish = spot.node, spot.log, _finish(spot)
    children, ticks, initialises = spot.children, tuple(spot.ticks), spot.defines("initialise")
    count, place = len(children), {id(child): i for i, (child, _) in enumerate(children)}

    def begin() -> int:
        """Return where to begin."""
        if node.status is not RUNNING:
            node.current_child = children[0][0] if children else None
            if initialises:
                node.initialise()
        if not (node.memory and children):
            return 0
        i = place[id(node.current_child)]
        _forget(children[:i])
        return i

    def tick() -> Status:
        try:
            i = begin()
            previous = node.current_child
            while i < count:
                status = ticks[i]()
                if status is RUNNING or status is SUCCESS:
                    node.current_child = child = children[i][0]
                    if previous is not child:
                        _forget(children[i + 1 :])
                    return finish(status)
                i += 1
        except BaseException:
            log.note_raised(node, terminating=False)
            raise
        status = finish(FAILURE)
        node.current_child = children[-1][0] if children else None
        return status

    return tick


def tick_of_parallel(spot: Spot) -> TickCall:
    """Tick every child that has not finished, then let the policies decide."""
    node, log, finish = spot.node, spot.log, _finish(spot)
    children, ticks = spot.children, tuple(spot.ticks)

    def tick() -> Status:
        try:
            if node.status is not RUNNING:
                node.begin()
                _forget(children)
            for (child, _), tick_child in zip(children, ticks, strict=True):
                if child.status is RUNNING or child.status is INVALID:
                    tick_child()
            status = node.decide()
            if status is not RUNNING:
                for child, stop_child in children:
                    if child.status is RUNNING:
                        stop_child(INVALID)
        except BaseException:
            log.note_raised(node, terminating=False)
            raise
        return finish(status)

    return tick


def tick_of_chooser(spot: Spot) -> TickCall:
    """Let the node pick a branch, stop the others and tick it."""
    node, log, finish = spot.node, spot.log, _finish(spot)
    children, ticks = spot.children, tuple(spot.ticks)

    def tick() -> Status:
        try:
            if node.status is not RUNNING:
                node.begin()
                _forget(children)
            if node.picks():
                if node.ASKS:
                    ticks[0]()
                _forget([children[i] for i in node.decide()])
            if node.branch is not None:
                ticks[node.branch]()
            status = node.answer()
        except BaseException:
            log.note_raised(node, terminating=False)
            raise
        return finish(status)

    return tick


def _forget(children: Sequence[tuple[Any, StopCall]]) -> None:
    for child, stop in children:
        if child.status is not INVALID:
            stop(INVALID)


def _finish(spot: Spot) -> Callable[[Status], Status]:
    """Return what an inner node does with its answer: stop unless it runs, and say it."""
    node, stop, note = spot.node, spot.stop, spot.log.events.append
    running, success, failure = spot.answers()
    broken = _broken(spot)

    def finish(status: Status) -> Status:
        if status is RUNNING:
            node.status = RUNNING
            note(running)
        elif status is SUCCESS:
            stop(SUCCESS)
            note(success)
        elif status is FAILURE:
            stop(FAILURE)
            note(failure)
        else:
            return broken()
        return status

    return finish


def _broken(spot: Spot) -> TickCall:
    """Return what follows an answer that is no status: py_trees makes it INVALID (trap e13)."""
    node, index, stop, log = spot.node, spot.index, spot.stop, spot.log

    def broken() -> Status:
        stop(INVALID)
        log.broken.append(node)
        log.events.append((index, NodeStatus.INVALID))
        return INVALID

    return broken
