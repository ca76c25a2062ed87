"""The leaves of a tree: skills, conditions and assignments."""

from collections.abc import Mapping

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.errors import InputError
from executive.core.outcome import Outcome, failure, success
from executive.core.outcome import Status as SkillStatus
from executive.core.skill import Port, Skill
from executive.engine import porttypes
from executive.engine.expression import Expression
from executive.engine.scope import Scope, inputs_of
from executive.engine.values import Value

_STATUS = {status: Status[status.value] for status in SkillStatus}


class SkillBehaviour(Behaviour):
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
        """
        super().__init__(name)
        self._path, self._skill, self._scope = path, skill, scope
        self._inputs, self._defaults, self._outputs = inputs, defaults, outputs
        self._ports = ports
        self.outcome: Outcome | None = None

    def initialise(self) -> None:
        """Start a new activation with what the inputs are now."""
        self.outcome = None
        self._skill.start(inputs_of(self._inputs, self._defaults, self._scope))

    def update(self) -> Status:
        """Do one tick's share of the work; outputs are written when it succeeds."""
        self.outcome = self._skill.step()
        for port, value in self.outcome.outputs.items():
            self._check(port, value)
        for port, key in self._outputs.items():
            if port in self.outcome.outputs:
                self._scope.write(key, self.outcome.outputs[port], self._path)
        return _STATUS[self.outcome.status]

    def _check(self, port: str, value: object) -> None:
        try:
            porttypes.check(value, self._ports[port].type)
        except ValueError as error:
            raise TypeError(f"output {port!r}: {error}") from None

    def terminate(self, _: Status) -> None:
        """Halt the skill if it still runs."""
        self._skill.halt()


class Condition(Behaviour):
    """Succeeds when an expression is true, fails when it is false."""

    def __init__(self, name: str, expression: Expression, scope: Scope) -> None:
        """Keep the expression and the names that it reads."""
        super().__init__(name)
        self._expression, self._scope = expression, scope
        self.outcome: Outcome | None = None

    def update(self) -> Status:
        """Evaluate the expression."""
        self.outcome = answer(self._expression, self._scope)
        return _STATUS[self.outcome.status]


class Assignment(Behaviour):
    """Sets keys to the values of expressions, one after the other."""

    def __init__(
        self, name: str, path: str, expressions: Mapping[str, Expression], scope: Scope
    ) -> None:
        """Keep the expressions by key."""
        super().__init__(name)
        self._path, self._expressions, self._scope = path, expressions, scope
        self.outcome: Outcome | None = None

    def update(self) -> Status:
        """Evaluate and write."""
        assign(self._expressions, self._scope, self._path)
        self.outcome = success()
        return Status.SUCCESS


def answer(expression: Expression, scope: Scope) -> Outcome:
    """Return success when an expression is true, and why not when it is false.

    Raises:
        InputError: It has no value, or one that is neither true nor false.
    """
    value = expression.evaluate(scope)
    if value is True:
        return success()
    if value is False:
        return failure("condition.false", f"{expression.text} is false")
    # numpy's own booleans are no bool, but they are what comparisons of arrays' items give.
    if type(value).__name__ == "bool":
        return success() if value else failure("condition.false", f"{expression.text} is false")
    raise InputError(f"{expression.text!r}: expected true or false, got {value!r}")


def assign(expressions: Mapping[str, Expression], scope: Scope, writer: str) -> None:
    """Write the values of expressions to their keys."""
    for key, expression in expressions.items():
        scope.write(key, expression.evaluate(scope), writer)
