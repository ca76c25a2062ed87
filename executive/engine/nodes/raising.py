"""Lets an inner node that raises fail, in a mission that goes on after errors.

Leaves see to that themselves (`executive.engine.nodes.leaf`). What raises while it is halted
ends the mission all the same: nobody waits for its answer.
"""

from collections.abc import Sequence

from py_trees.common import Status
from py_trees.decorators import Decorator

from executive.core.outcome import failure
from executive.engine.checkpoints.node import CheckpointGate
from executive.engine.nodes.calls import TickCall
from executive.engine.nodes.interception import Interceptor, Junction
from executive.engine.nodes.leaf import Leaf
from executive.engine.nodes.supervision import RAISED, Supervision


def failing(paths: Sequence[str], supervision: Supervision) -> Interceptor:
    """Return what stands around inner nodes so that they fail where they would raise.

    Args:
        paths: Paths of the nodes by index.
        supervision: Told what was raised.
    """

    def intercept(junction: Junction) -> TickCall:
        # What a checkpoint raises comes from whoever listens to it.
        if isinstance(junction.node, (Leaf, CheckpointGate)):
            return junction.tick
        path = paths[junction.index]

        def tick() -> Status:
            try:
                return junction.tick()
            except Exception as cause:
                _end(junction, path, cause, supervision)
                return junction.answer(failure(RAISED, f"{type(cause).__name__}: {cause}"))

        return tick

    return intercept


def _end(junction: Junction, path: str, cause: Exception, supervision: Supervision) -> None:
    """Bring a node that raised to its end, with all that runs below it.

    Raises:
        Exception: `cause`, where another node raised it.
    """
    log = junction.log
    node = log.raised
    if node is None or node is not junction.node:
        raise cause
    supervision.note_raised(path, cause)
    ended = log.terminating
    log.raised, log.terminating = None, False
    if ended:
        node.status = Status.INVALID  # `terminate` has had its one call; only children are left
        junction.stop(Status.INVALID)
        return
    try:
        # A composite halts its children only when it is told to forget.
        junction.stop(Status.FAILURE if isinstance(node, Decorator) else Status.INVALID)
    except Exception as another:
        _end(junction, path, another, supervision)
