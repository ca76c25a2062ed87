"""The leaves of a tree that run no skill: conditions and assignments; and what all leaves share."""

from abc import abstractmethod
from collections.abc import Mapping

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.errors import InputError
from executive.core.outcome import Outcome, failure, success
from executive.core.outcome import Status as Answer
from executive.engine.language.expression import Expression
from executive.engine.language.scope import Scope
from executive.engine.nodes.supervision import RAISED, Supervision

_SUCCESS = success()


class Leaf(Behaviour):
    """Base of the leaves: what `answer` raises ends the mission or fails the leaf."""

    def __init__(self, name: str, path: str, supervision: Supervision) -> None:
        """Keep the path, which is the writer of what the leaf writes."""
        super().__init__(name)
        self._path, self._supervision = path, supervision
        self.outcome: Outcome | None = None

    @abstractmethod
    def answer(self) -> Outcome:
        """Do one tick's share of the work."""

    def update(self) -> Status:
        """Answer; where the mission goes on after an error, that is a failure."""
        try:
            outcome = self.answer()
        except Exception as cause:
            outcome = self.raised(cause)
        self.outcome, status = outcome, outcome.status
        # Compared one by one: to look an enumeration up takes several times longer.
        if status is Answer.RUNNING:
            return Status.RUNNING
        return Status.SUCCESS if status is Answer.SUCCESS else Status.FAILURE

    def raised(self, cause: Exception) -> Outcome:
        """Return what an exception comes to where the mission goes on after it.

        Raises:
            Exception: `cause`, where it does not.
        """
        if self._supervision.on_error == "end":
            raise cause
        self._supervision.note_raised(self._path, cause)
        self._clean_up()
        return failure(RAISED, f"{type(cause).__name__}: {cause}")

    def _clean_up(self) -> None:
        """Stop what the leaf has set in motion before it raised."""


class Condition(Leaf):
    """Succeeds when an expression is true, fails when it is false."""

    def __init__(
        self,
        name: str,
        path: str,
        expression: Expression,
        scope: Scope,
        supervision: Supervision,
    ) -> None:
        """Keep the expression and the names that it reads."""
        super().__init__(name, path, supervision)
        self._expression, self._scope = expression, scope

    def answer(self) -> Outcome:
        """Evaluate the expression."""
        return answer(self._expression, self._scope)


class Assignment(Leaf):
    """Sets keys to the values of expressions, one after the other."""

    def __init__(
        self,
        name: str,
        path: str,
        expressions: Mapping[str, Expression],
        scope: Scope,
        supervision: Supervision,
    ) -> None:
        """Keep the expressions by key."""
        super().__init__(name, path, supervision)
        self._expressions, self._scope = expressions, scope

    def answer(self) -> Outcome:
        """Evaluate and write."""
        assign(self._expressions, self._scope, self._path)
        return _SUCCESS


def answer(expression: Expression, scope: Scope) -> Outcome:
    """Return success when an expression is true, and why not when it is false.

    Raises:
        InputError: It has no value, or one that is neither true nor false.
    """
    value = expression.evaluate(scope)
    if value is True:
        return _SUCCESS
    if value is False:
        return failure("condition.false", f"{expression.text} is false")
    # numpy's own booleans are no bool, but they are what comparisons of arrays' items give.
    if type(value).__name__ == "bool":
        return _SUCCESS if value else failure("condition.false", f"{expression.text} is false")
    raise InputError(f"{expression.text!r}: expected true or false, got {value!r}")


def assign(expressions: Mapping[str, Expression], scope: Scope, writer: str) -> None:
    """Write the values of expressions to their keys."""
    for key, expression in expressions.items():
        scope.write(key, expression.evaluate(scope), writer)
