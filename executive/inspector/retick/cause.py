"""Why a tick goes another way than it did: the first node that decides otherwise, and by what."""

from collections.abc import Iterator

from executive.core.errors import InputError
from executive.engine.language.expression import Expression, parse_expression
from executive.inspector.brief import brief
from executive.inspector.past import PastRun, terms_of
from executive.inspector.rebuilt import WrittenNode
from executive.inspector.retick.differences import NOT_ASKED, NodeDifference, TickDifference
from executive.inspector.retick.matching import own_words
from executive.inspector.retick.replay import Replay


class Causes:
    """Explains differences right after the tick in which they are."""

    def __init__(self, run: PastRun, replay: Replay) -> None:
        """Know both sides."""
        self._run, self._replay, self._written = run, replay, replay.written

    def of(self, found: TickDifference) -> tuple[str, ...]:
        """Return why a tick is not as it was, in lines."""
        if not found.nodes:
            order = () if found.in_order else ("nodes answer in another order",)
            return (*order, *(self._write(each.writer) for each in found.writes[:1]))
        if forced := self._replay.stand_ins.forced_now:
            paths = [self._replay.tree.nodes[node].path for node in sorted(forced)]
            return tuple(f"{self._short(path)} was forced" for path in paths)
        # The first to answer otherwise whose own doing it is.
        for node in found.nodes:
            if reasons := self._reasons(node, found.tick):
                return reasons
        return ()

    def _reasons(self, node: NodeDifference, tick: int) -> tuple[str, ...]:
        """Return what a node itself does otherwise; nothing where it only follows others."""
        index, reasons = self._run.index.indices[node.path], []
        if not node.now.startswith(NOT_ASKED) and self._run.index.answers[tick, index]:
            reasons = [*self._conditions(node.path, index, tick)]
        return tuple(reasons or self._changed(node.path))

    def _write(self, writer: str) -> str:
        changed = "; ".join(self._changed(writer))
        return changed or f"{self._short(writer)} writes another value"

    def _changed(self, path: str) -> Iterator[str]:
        """Yield what the file says otherwise about a node."""
        before, now = self._run.trees.nodes.get(path), self._now(path)
        if before is None or now is None:
            return
        was, is_now = own_words(before), own_words(now)
        for key in dict.fromkeys([*was, *is_now]):
            if was.get(key) != is_now.get(key):
                old, new = was.get(key, "nothing"), is_now.get(key, "nothing")
                yield f"{self._short(path)}: {key} was {old}, is {new}"

    def _conditions(self, path: str, node: int, tick: int) -> Iterator[str]:
        """Yield what a condition found then and finds now."""
        now = self._now(path)
        if now is None:
            return
        asked = {one.keyword: one for one in self._run.conditions(node, tick)}
        for keyword, expression in now.conditions().items():
            then, value = asked.get(keyword), self._value(expression, now)
            if then is None or value is None or then.value is value:
                continue
            was = "not known" if then.value is None else str(then.value).lower()
            again = "" if expression.text == then.text else f"{expression.text} "
            terms = "".join(f"; {term}" for term in self._terms(expression, now))
            yield (
                f"{self._short(path)}: {then.text} was {was}, {again}is {str(value).lower()}{terms}"
            )

    def _now(self, path: str) -> WrittenNode | None:
        """Return a recorded node as it is written now, perhaps at another path."""
        old = self._run.index.indices.get(path)
        new = None if old is None else self._replay.current.get(old)
        at = path if new is None else self._replay.tree.nodes[new].path
        return self._written.nodes.get(at)

    def _value(self, expression: Expression, node: WrittenNode) -> bool | None:
        try:
            return bool(expression.evaluate(node.names.scope))
        except InputError:
            return None

    def _terms(self, expression: Expression, node: WrittenNode) -> Iterator[str]:
        for text in terms_of(expression):
            try:
                value = parse_expression(text).evaluate(node.names.scope)
            except InputError:
                yield f"{text} has no value now"
                continue
            yield f"{text} is {brief(self._replay.board.form(value))}"

    def _short(self, path: str) -> str:
        return self._run.names.of_path(path)
