"""The scripting language of BehaviorTree.CPP v4, as expressions and assignments of ours.

Its grammar in short, loosest first: `;` between statements; `:= = += -= *= /=`; `c ? a : b`;
`&&` and `||`, which bind equally and to the left; comparisons, which chain; `+ -`; `* /`;
`- ! ~` before an atom; numbers, 'texts', true, false, names, parentheses. All numbers are
reals there, and a number that is not zero counts as true.
"""

import ast
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, Literal

from executive.core.errors import InputError
from executive.engine.exchange.draft import joined

Kind = Literal["bool", "number", "str", "any"]

_TOKEN: Final = re.compile(
    r"""\s*(?:
    (?P<number>0[xX][0-9a-fA-F]+|(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)
    |(?P<text>'[^']*')
    |(?P<name>[^\W\d]\w*|@\w+)
    |(?P<sign>:=|\+=|-=|\*=|/=|==|!=|<=|>=|&&|\|\||[-+*/=<>!~&|^?:;()])
    )""",
    re.VERBOSE,
)
_ASSIGNMENTS: Final[Mapping[str, type[ast.operator] | None]] = {
    ":=": None,
    "=": None,
    "+=": ast.Add,
    "-=": ast.Sub,
    "*=": ast.Mult,
    "/=": ast.Div,
}
_COMPARISONS: Final[Mapping[str, type[ast.cmpop]]] = {
    "==": ast.Eq,
    "!=": ast.NotEq,
    "<": ast.Lt,
    "<=": ast.LtE,
    ">": ast.Gt,
    ">=": ast.GtE,
}
_ARITHMETIC: Final[Mapping[str, type[ast.operator]]] = {
    "+": ast.Add,
    "-": ast.Sub,
    "*": ast.Mult,
    "/": ast.Div,
}
_MAX_DEPTH: Final = 60


@dataclass(frozen=True, slots=True)
class Statement:
    """One statement of a script, in our language.

    Attributes:
        key: Key that it sets, empty for a bare expression.
        text: The expression.
        kind: What the value is known to be.
        reads: Keys that it reads, by their foreign names.
        written: The key by its foreign name.
    """

    key: str
    text: str
    kind: Kind
    reads: tuple[str, ...] = ()
    written: str = ""


class Vocabulary:
    """What the names in scripts stand for."""

    def __init__(
        self,
        rename: Callable[[str], str],
        *,
        enums: Mapping[str, int] | None = None,
        kinds: Mapping[str, Kind] | None = None,
    ) -> None:
        """Say how keys are called here.

        Args:
            rename: Our name of a key.
            enums: Values of the words that C++ code registers.
            kinds: What keys hold, where that is known, by foreign name.
        """
        self.rename = rename
        self.enums = dict(enums or {})
        self.kinds = dict(kinds or {})

    def learn(self, key: str, kind: Kind) -> None:
        """Take note of what a key is set to."""
        self.kinds[key] = kind if self.kinds.get(key, kind) == kind else "any"


def read_script(text: str, words: Vocabulary) -> list[Statement]:
    """Translate a script, statement by statement.

    Raises:
        InputError: It is no script, or says what our expressions cannot say.
    """
    return _Parser(text, words).statements()


def read_condition(text: str, words: Vocabulary) -> Statement:
    """Translate a script that is asked as a condition.

    Raises:
        InputError: It is no condition, sets a key, or says what our expressions cannot say.
    """
    return _Parser(text, words).condition()


class _Parser:
    def __init__(self, text: str, words: Vocabulary) -> None:
        self._text, self._words = text, words
        self._tokens = _tokens(text)
        self._at = self._depth = 0
        self._reads: list[str] = []

    def statements(self) -> list[Statement]:
        found: list[Statement] = []
        while self._peek() != "":
            if self._peek() != ";":
                found.append(self._statement())
                if found[-1].key:
                    self._words.learn(found[-1].written, found[-1].kind)
            if self._peek() not in (";", ""):
                raise self._error(f"expected ';' before {self._peek()!r}")
            self._take(";")
        return found

    def condition(self) -> Statement:
        found = self.statements()
        if len(found) != 1 or found[0].key:
            raise self._error("expected one condition that sets nothing")
        tree = ast.parse(found[0].text, mode="eval").body
        asked = self._as_bool(tree, found[0].kind)
        return Statement("", ast.unparse(asked), "bool", found[0].reads)

    def _statement(self) -> Statement:
        self._reads = []
        target = self._tokens[self._at][1] if self._tokens[self._at][0] == "name" else ""
        following = self._tokens[self._at + 1][1] if target else ""
        if following not in _ASSIGNMENTS:
            value, kind = self._ternary()
            if self._peek() in _ASSIGNMENTS:
                raise self._error("only a key can be set")
            return Statement("", ast.unparse(value), kind, tuple(self._reads))
        key = self._key(target)
        self._at += 2
        value, kind = self._ternary()
        if (operator := _ASSIGNMENTS[following]) is not None:
            self._reads.insert(0, target)
            kind = self._sum_kind(following[0], self._words.kinds.get(target, "any"), kind)
            value = ast.BinOp(ast.Name(key), operator(), value)
        reads = tuple(self._reads)
        return Statement(key, ast.unparse(value), kind, reads, target)

    def _ternary(self) -> tuple[ast.expr, Kind]:
        self._depth += 1
        if self._depth > _MAX_DEPTH:
            raise self._error(f"nested deeper than {_MAX_DEPTH} levels")
        test, kind = self._logical()
        if self._take("?"):
            body, body_kind = self._ternary()
            if not self._take(":"):
                raise self._error("expected ':' after '?'")
            orelse, else_kind = self._ternary()
            test = ast.IfExp(self._as_bool(test, kind), body, orelse)
            kind = body_kind if body_kind == else_kind else "any"
        self._depth -= 1
        return test, kind

    def _logical(self) -> tuple[ast.expr, Kind]:
        left, kind = self._comparison()
        while self._peek() in ("&&", "||"):
            operator = ast.And() if self._next() == "&&" else ast.Or()
            right, right_kind = self._comparison()
            sides = [self._as_bool(left, kind), self._as_bool(right, right_kind)]
            left, kind = joined(operator, sides), "bool"
        return left, kind

    def _comparison(self) -> tuple[ast.expr, Kind]:
        left, kind = self._sum()
        operators: list[ast.cmpop] = []
        others: list[ast.expr] = []
        while self._peek() in _COMPARISONS:
            operators.append(_COMPARISONS[self._next()]())
            others.append(self._sum()[0])
        if not operators:
            return left, kind
        return ast.Compare(left, operators, others), "bool"

    def _sum(self) -> tuple[ast.expr, Kind]:
        return self._binary(("+", "-"), lambda: self._binary(("*", "/"), self._unary))

    def _binary(
        self, signs: tuple[str, ...], operand: Callable[[], tuple[ast.expr, Kind]]
    ) -> tuple[ast.expr, Kind]:
        left, kind = operand()
        while self._peek() in signs:
            sign = self._next()
            right, right_kind = operand()
            kind = self._sum_kind(sign, kind, right_kind)
            left = ast.BinOp(left, _ARITHMETIC[sign](), right)
        if self._peek() in ("&", "|", "^"):
            raise self._error(f"{self._peek()!r} works on bits, which our expressions do not")
        return left, kind

    def _unary(self) -> tuple[ast.expr, Kind]:
        if self._peek() == "~":
            raise self._error("'~' works on bits, which our expressions do not")
        if self._take("!"):
            operand, kind = self._atom()
            return ast.UnaryOp(ast.Not(), self._as_bool(operand, kind)), "bool"
        if self._take("-"):
            operand, kind = self._atom()
            self._sum_kind("-", "number", kind)
            return ast.UnaryOp(ast.USub(), operand), "number"
        return self._atom()

    def _atom(self) -> tuple[ast.expr, Kind]:
        if self._take("("):
            inner = self._ternary()
            if not self._take(")"):
                raise self._error("expected ')'")
            return inner
        kind, token = self._tokens[self._at]
        self._at += 1
        match kind:
            case "number":
                return ast.Constant(self._number(token)), "number"
            case "text":
                return ast.Constant(token[1:-1]), "str"
            case "name" if token in ("true", "false"):
                return ast.Name(token), "bool"
            case "name" if token in self._words.enums:
                return ast.Constant(self._words.enums[token]), "number"
            case "name":
                self._reads.append(token)
                return ast.Name(self._key(token)), self._words.kinds.get(token, "any")
        raise self._error(f"expected a value, got {token!r}" if token else "it ends too early")

    def _number(self, token: str) -> int | float:
        try:
            if token[:2] in ("0x", "0X"):
                return int(token, 16)
            number = int(token) if token.isdecimal() else float(token)
        except ValueError:  # thousands of digits
            raise self._error("a number is too long") from None
        if number == float("inf"):
            raise self._error(f"{token!r} is too large")
        return number

    def _key(self, name: str) -> str:
        if name.startswith("@"):
            raise self._error(f"{name!r} is on the root's blackboard; our trees see their own keys")
        return self._words.rename(name)

    def _as_bool(self, value: ast.expr, kind: Kind) -> ast.expr:
        """Return a value as the condition that it is there: a number is true unless zero."""
        if kind == "str":
            raise self._error(f"{ast.unparse(value)} is a text, which is neither true nor false")
        if kind == "number":
            if isinstance(value, ast.Constant):
                return ast.Name("true" if value.value else "false")
            return ast.Compare(value, [ast.NotEq()], [ast.Constant(0)])
        return value

    def _sum_kind(self, sign: str, left: Kind, right: Kind) -> Kind:
        if "bool" in (left, right):
            raise self._error(f"{sign!r} with true or false; try c ? 1 : 0")
        if "str" in (left, right) and (sign != "+" or "number" in (left, right)):
            raise self._error(f"{sign!r} does not go with these values")
        if sign != "+" or "number" in (left, right):
            return "number"
        return "str" if "str" in (left, right) else "any"

    def _peek(self) -> str:
        kind, token = self._tokens[self._at]
        return token if kind in ("sign", "end") else "a value"

    def _next(self) -> str:
        self._at += 1
        return self._tokens[self._at - 1][1]

    def _take(self, sign: str) -> bool:
        found = self._peek() == sign
        self._at += found
        return found

    def _error(self, message: str) -> InputError:
        return InputError(f"script {self._text.strip()!r}: {message}")


def _tokens(text: str) -> list[tuple[str, str]]:
    """Return kind and text of every token, and an end without text that repeats."""
    tokens: list[tuple[str, str]] = []
    at, end = 0, len(text.rstrip())
    while at < end:
        match = _TOKEN.match(text, at)
        if match is None:
            raise InputError(f"script {text.strip()!r}: cannot read {text[at:].strip()[:20]!r}")
        tokens.append((str(match.lastgroup), match.group(str(match.lastgroup))))
        at = match.end()
    return [*tokens, ("end", ""), ("end", "")]
