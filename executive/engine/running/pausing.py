"""What happens while a mission is paused: running leaves hold, finish or are stopped."""

from collections.abc import Callable, Sequence
from typing import Literal

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.clock import Clock
from executive.core.errors import NodeError
from executive.core.skill import PausePolicy
from executive.core.world import StreamMessage
from executive.engine.nodes.builder import BuiltTree
from executive.engine.nodes.skill_node import SkillBehaviour
from executive.engine.recording.messages import PAUSES_TOPIC, PausedLeaf, PauseMessage
from executive.engine.running.control import RunControl
from executive.engine.running.stopping import ErrorOf, each_guarded

_POLL_S = 0.2


class Pauses:
    """Waits while a mission is paused, and makes its running leaves do what they said.

    The cell's clock goes on until every skill rests, which in a lockstep world is all that the
    arms need to come to rest; then it stands, unless it is the machine's.
    """

    def __init__(
        self,
        tree: BuiltTree,
        clock: Clock,
        control: RunControl,
        *,
        period_s: float,
        tell: Callable[[Sequence[StreamMessage]], None],
        error_of: ErrorOf,
    ) -> None:
        """Watch a mission.

        Args:
            tree: Its tree.
            clock: The cell's clock.
            control: Says when to pause.
            period_s: From one step of a skill that finishes to the next [s].
            tell: Takes what is to be recorded, and what the cell has streamed meanwhile.
            error_of: Makes an error of a node out of what it raised.
        """
        self._tree, self._clock, self._control = tree, clock, control
        self._period_s, self._tell, self._error_of = period_s, tell, error_of

    def wait(self) -> tuple[float, list[NodeError]]:
        """Wait until the mission may go on or is to end.

        Returns:
            For how long it was paused on the cell's clock [s], and what leaves raised.
        """
        if not self._control.paused:
            return 0.0, []
        began_s = self._clock.now_s()
        running = self._running()
        policies: dict[int, PausePolicy] = {}

        def pause(leaf: Behaviour) -> None:
            policies[running[leaf]] = PausePolicy.HOLD
            if isinstance(leaf, SkillBehaviour):
                policies[running[leaf]] = leaf.pause()

        errors = each_guarded(running, pause, self._error_of)
        self._tell_of("paused", began_s, policies)
        skills = [leaf for leaf in running if isinstance(leaf, SkillBehaviour)]
        while self._control.paused and not errors:
            errors += self._settle(skills)
        ended_s = self._clock.now_s()
        if not errors and not self._control.stop_reason:
            errors += each_guarded(skills, lambda leaf: leaf.resume(), self._error_of)
            self._tell_of("resumed", ended_s, policies)
        paused_s = ended_s - began_s
        self._tree.clock.skip(paused_s)
        return paused_s, errors

    def _running(self) -> dict[Behaviour, int]:
        return {
            node.behaviour: node.index
            for node in self._tree.nodes
            if node.behaviour.status is Status.RUNNING and not node.behaviour.children
        }

    def _settle(self, skills: Sequence[SkillBehaviour]) -> list[NodeError]:
        """Let a little time pass."""
        settled: list[bool] = []
        errors = each_guarded(skills, lambda leaf: settled.append(leaf.settled), self._error_of)
        if all(settled):
            self._control.wait(_POLL_S)
        else:
            with self._control.interruptible():
                self._clock.sleep_until(self._clock.now_s() + self._period_s)
                errors += each_guarded(skills, lambda leaf: leaf.step_in_pause(), self._error_of)
        self._tell(())
        return errors

    def _tell_of(
        self,
        state: Literal["paused", "resumed"],
        time_s: float,
        policies: dict[int, PausePolicy],
    ) -> None:
        message = PauseMessage(
            state=state,
            time_s=time_s,
            by=self._control.pause_by,
            leaves=tuple(PausedLeaf(node, policy) for node, policy in policies.items()),
        )
        data = message.model_dump_json().encode()
        self._tell([StreamMessage(PAUSES_TOPIC, "PauseMessage", message.time_s, data)])
