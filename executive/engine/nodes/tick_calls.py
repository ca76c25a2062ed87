"""How each kind of node is ticked, as plain calls, of which `ticking` is made.

py_trees ticks with nested generators: every answer climbs through all ancestors, and every
`stop` writes a line for a log that nobody reads. Each function here makes the calls of one
kind of node that do the same without either: same statuses, same order of answers, same calls
of `initialise`, `update` and `terminate`. They are closures, because they are the innermost
loop of the executive and a closure finds its parts faster than an object does.
"""

from collections.abc import Callable

from py_trees.common import Status

from executive.engine.nodes.calls import Spot, TickCall
from executive.engine.nodes.stop_calls import forget
from executive.engine.ticks import NodeStatus

RUNNING, SUCCESS, FAILURE, INVALID = (
    Status.RUNNING,
    Status.SUCCESS,
    Status.FAILURE,
    Status.INVALID,
)


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
            forget(children)
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
                        forget(children[i:])
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
        forget(children[:i])
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
                        forget(children[i + 1 :])
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
                forget(children)
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
                forget(children)
            if node.picks():
                if node.ASKS:
                    ticks[0]()
                forget([children[i] for i in node.decide()])
            if node.branch is not None:
                ticks[node.branch]()
            status = node.answer()
        except BaseException:
            log.note_raised(node, terminating=False)
            raise
        return finish(status)

    return tick


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
