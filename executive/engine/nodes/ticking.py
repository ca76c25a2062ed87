"""Ticks a tree by plain calls and notes what each node answered.

The statuses are those of `root.tick_once()`, which goes on working on the same nodes: what is
known here are the ways of ticking and stopping, by the method that a class has. A class with a
`tick` or `stop` of its own is ticked or stopped by that, so every py_trees node works; only
the speed differs. py_trees' lines for its own log (level DEBUG) are not written.
"""

import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Composite, Selector
from py_trees.composites import Sequence as SequenceNode
from py_trees.decorators import Decorator, OneShot

from executive.engine.nodes import stop_calls, tick_calls
from executive.engine.nodes.calls import Spot, StopCall, TickCall, TickLog
from executive.engine.nodes.choosing import Chooser
from executive.engine.nodes.decorators import WhileRunning
from executive.engine.nodes.gated import Gated
from executive.engine.nodes.interception import Interceptor, Junction
from executive.engine.nodes.parallel import Parallel
from executive.engine.ticks import NodeStatus

NODE_STATUS = {status: NodeStatus(status.value) for status in Status}

_TICKS: Mapping[object, Callable[[Spot], TickCall]] = {
    Behaviour.tick: tick_calls.tick_of_leaf,
    Decorator.tick: tick_calls.tick_of_decorator,
    OneShot.tick: tick_calls.tick_of_one_shot,
    Gated.tick: tick_calls.tick_of_gated,
    SequenceNode.tick: tick_calls.tick_of_sequence,
    Selector.tick: tick_calls.tick_of_selector,
    Parallel.tick: tick_calls.tick_of_parallel,
    Chooser.tick: tick_calls.tick_of_chooser,
}
_STOPS: Mapping[object, Callable[[Spot], StopCall]] = {
    Behaviour.stop: stop_calls.stop_of_leaf,
    Decorator.stop: stop_calls.stop_of_decorator,
    Composite.stop: stop_calls.stop_of_composite,
    SequenceNode.stop: stop_calls.stop_of_composite,
    Selector.stop: stop_calls.stop_of_composite,
    WhileRunning.stop: stop_calls.stop_of_while_running,
}


class DirectTicks:
    """The calls of one tree; its nodes must stay where they are.

    Attributes:
        log: What happened since `tick` was called.
    """

    def __init__(
        self,
        root: Behaviour,
        nodes: Sequence[Behaviour],
        intercept: Interceptor | None = None,
    ) -> None:
        """Look at every node once.

        Args:
            root: Root of the tree.
            nodes: Nodes by index; what others answer is not noted.
            intercept: What stands between each of these nodes and its parent.
        """
        self._intercept = intercept
        self.log = TickLog()
        self._index = {id(node): i for i, node in enumerate(nodes)}
        self._ticks: dict[int, TickCall] = {}
        self._stops: dict[int, StopCall] = {}
        for node in root.iterate():  # children come first
            self._add(node)
        self._root_tick = self._ticks[id(root)]
        self._while_running = [node for node in root.iterate() if isinstance(node, WhileRunning)]
        self._all_known = len(self._ticks) == len(nodes)

    def tick(self) -> None:
        """Tick the tree once; `log` says what happened, also when a node raises."""
        self.log.clear()
        try:
            self._root_tick()
            for node in self._while_running:
                if node.is_left():
                    self._stops[id(node)](Status.INVALID)
        finally:
            if not self._all_known:
                self.log.events[:] = [event for event in self.log.events if event[0] >= 0]

    def _add(self, node: Behaviour) -> None:
        foreign = _Foreign(node, self._index, self.log)
        spot = Spot(
            node,
            self._index.get(id(node), -1),
            self.log,
            stop=foreign.stop,
            ticks=tuple(self._ticks[id(child)] for child in node.children),
            stops=tuple(self._stops[id(child)] for child in node.children),
        )
        stop_of, tick_of = _STOPS.get(type(node).stop), _TICKS.get(type(node).tick)
        stop = stop_of(spot) if stop_of else foreign.stop
        tick = tick_of(replace(spot, stop=stop)) if tick_of else foreign.tick
        if self._intercept is not None and spot.index >= 0:
            tick = self._intercept(Junction(spot.index, node, tick, stop, self.log))
        self._stops[id(node)] = stop
        self._ticks[id(node)] = tick


class _Foreign:
    """A node that only py_trees' own methods can tick or stop."""

    def __init__(self, node: Behaviour, index: Mapping[int, int], log: TickLog) -> None:
        self._node, self._index, self._log = node, index, log

    def tick(self) -> Status:
        """Tick it, and note the answers that come out of its generator."""
        try:
            for each in self._node.tick():
                node = self._index.get(id(each))
                if node is not None:
                    self._log.events.append((node, NODE_STATUS[each.status]))
                if each.status is Status.INVALID:
                    self._log.broken.append(each)
        except BaseException as cause:
            self._note_raised(cause)
            raise
        finally:
            self._note_unseen()
        status: Status = self._node.status
        return status

    def stop(self, status: Status) -> None:
        """Stop it, and all that it stops with it."""
        try:
            self._node.stop(status)
        except BaseException as cause:
            self._note_raised(cause)
            raise
        finally:
            self._note_unseen()

    def _note_unseen(self) -> None:
        below = (self._index.get(id(node)) for node in self._node.iterate())
        self._log.unseen.update(index for index in below if index is not None)

    def _note_raised(self, cause: BaseException) -> None:
        """Remember the innermost node whose method raised.

        Generators of py_trees do not say which node an exception came from (trap e1); the
        traceback does.
        """
        found, terminating = self._node, False
        for frame, _ in traceback.walk_tb(cause.__traceback__):
            caller = frame.f_locals.get("self")
            if isinstance(caller, Behaviour) and id(caller) in self._index:
                is_again = terminating and caller is found
                terminating = frame.f_code.co_name == "terminate" or is_again
                found = caller
        self._log.note_raised(found, terminating=terminating)
