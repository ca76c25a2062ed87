"""The leaf that runs a skill: its activations, its claims, its budget, its pauses."""

import time
from collections.abc import Callable, Mapping

from py_trees.common import Status

from executive.core.outcome import RUNNING, Outcome
from executive.core.skill import PausePolicy, Port, Skill
from executive.engine.language import fitting
from executive.engine.language.scope import Inputs, Scope
from executive.engine.language.values import Value
from executive.engine.nodes.leaf import Leaf
from executive.engine.nodes.supervision import Supervision


class SkillBehaviour(Leaf):
    """Drives a skill: started with its inputs, one step a tick, halted once when stopped."""

    def __init__(
        self,
        name: str,
        path: str,
        skill: Skill,
        *,
        scope: Scope,
        inputs: Mapping[str, Value],
        defaults: Mapping[str, object],
        outputs: Mapping[str, str],
        ports: Mapping[str, Port],
        supervision: Supervision,
        budget_s: float | None = None,
        stopwatch_s: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Wire a skill.

        Args:
            name: Name of the node.
            path: Its path, which is the writer of its outputs.
            skill: The skill, bound to its devices.
            scope: Names of its tree.
            inputs: What its inputs are wired to.
            defaults: Defaults of the inputs that have one.
            outputs: Key by output port, for those that are wired.
            ports: All its output ports.
            supervision: What it answers to.
            budget_s: How long a step may take [s]; what the skill says, or else the tree, if None.
            stopwatch_s: The machine's clock.
        """
        super().__init__(name, path, supervision)
        self._skill, self._scope = skill, scope
        self._inputs, self._outputs = Inputs(inputs, defaults, scope), outputs
        self._types = {name: port.type for name, port in ports.items()}
        budgets_s = (budget_s, skill.BUDGET_S, supervision.budget_s, float("inf"))
        self._budget_s = next(one for one in budgets_s if one is not None)
        self._stopwatch_s = stopwatch_s
        self._is_open = self._begins = False
        self._kept: Outcome | Exception | None = None

    def initialise(self) -> None:
        """Begin a new activation, which starts in the update that follows."""
        self.outcome, self._kept = None, None
        self._is_open = self._begins = True

    def answer(self) -> Outcome:
        """Do one tick's share of the work; outputs are written when it succeeds.

        Raises:
            ClaimError: What it claims is held by a node that goes on.
        """
        outcome = self._advance() if self._kept is None else self._taken()
        if outcome.outputs:
            self.write(outcome.outputs)
        return outcome

    @property
    def wired_outputs(self) -> Mapping[str, str]:
        """Key of the blackboard by output port, in the order in which they are written."""
        return {port: self._scope.key(name) for port, name in self._outputs.items()}

    def write(self, outputs: Mapping[str, object]) -> None:
        """Write values of output ports to the keys that these are wired to."""
        for port, key in self._outputs.items():
            if port in outputs:
                self._scope.write(key, outputs[port], self._path)

    def terminate(self, _: Status) -> None:
        """Halt the skill if it still runs, and give back what it claimed."""
        if not self._is_open:
            return  # it has ended, and is told to forget
        self._is_open = self._begins = False
        self._kept = None
        try:
            self._skill.halt()
        finally:
            if self._skill.CLAIMS:
                self._supervision.claims.release(self._path)

    def pause(self) -> PausePolicy:
        """Do to the skill what a pause does to it; return what that was."""
        policy = self._skill.PAUSE
        if policy is PausePolicy.STOP:
            self._begins = True
            self._skill.halt()
        elif policy is PausePolicy.HOLD and self._skill.active:
            self._skill.on_pause()
        return policy

    def step_in_pause(self) -> None:
        """Let a skill that is to finish do another step; the tree takes its answer later."""
        if self._finishing:
            try:
                outcome = self._advance()
            except Exception as cause:  # raised where the tree takes the answer
                self._kept = cause
            else:
                self._kept = None if outcome is RUNNING else outcome

    @property
    def settled(self) -> bool:
        """Whether the pause has done to it what it does: nothing moves any more."""
        return not self._finishing and self._skill.resting()

    def resume(self) -> None:
        """Go on after a pause."""
        if self._skill.PAUSE is PausePolicy.HOLD and self._skill.active:
            self._skill.on_resume()

    @property
    def _finishing(self) -> bool:
        finishes = self._skill.PAUSE is PausePolicy.FINISH and self._skill.active
        return finishes and self._kept is None

    def _advance(self) -> Outcome:
        if self._begins:
            wanted = self._skill.CLAIMS
            if wanted and not self._supervision.claims.take(self._path, wanted):
                return RUNNING
            self._begins = False
            self._skill.start(self._inputs.read())
        stopwatch_s = self._stopwatch_s
        began_s = stopwatch_s()
        outcome = self._skill.step()
        seconds = stopwatch_s() - began_s
        if seconds > self._budget_s:
            self._supervision.note_late(self._path, seconds, self._budget_s)
        if outcome.outputs:
            self._check(outcome.outputs)
        return outcome

    def _taken(self) -> Outcome:
        kept, self._kept = self._kept, None
        if isinstance(kept, Exception):
            raise kept
        assert kept is not None
        return kept

    def _check(self, outputs: Mapping[str, object]) -> None:
        for port, value in outputs.items():
            try:
                fitting.check(value, self._types[port])
            except ValueError as error:
                raise TypeError(f"output {port!r}: {error}") from None

    def _clean_up(self) -> None:
        try:
            self._skill.halt()
        except Exception as cause:  # the one that made it necessary is told already
            self._supervision.note_raised(self._path, cause)
