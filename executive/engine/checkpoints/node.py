"""The node that stands around one with `checkpoint: true`."""

from collections.abc import Callable
from typing import ClassVar

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.engine.nodes.gated import Gated

Listener = Callable[[int], None]


class CheckpointSignal:
    """Says which node with a checkpoint is about to start, to whoever listens."""

    def __init__(self) -> None:
        """Begin without a listener."""
        self._listener: Listener | None = None

    def listen(self, listener: Listener) -> None:
        """Call `listener` with the index of each checkpoint that is reached from now on."""
        self._listener = listener

    def reached(self, node: int) -> None:
        """Tell the listener, if there is one."""
        if self._listener is not None:
            self._listener(node)


class CheckpointGate(Gated):
    """Signals before its child starts; its answers are the child's."""

    KIND: ClassVar = "checkpoint"
    MEMORY: ClassVar = ("_due",)

    def __init__(
        self, name: str, child: Behaviour, *, index: int, signal: CheckpointSignal
    ) -> None:
        """Stand around a node; `index` is the gate's own."""
        super().__init__(name, child)
        self._index, self._signal = index, signal
        self._due = False

    def initialise(self) -> None:
        """Note that the child is about to start."""
        self._due = True

    def before(self) -> Status | None:
        """Signal once an activation."""
        if self._due:
            self._due = False
            self._signal.reached(self._index)
        return None
