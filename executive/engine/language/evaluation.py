"""Makes functions of expressions that have passed the gate.

Every part of the syntax tree becomes a closure once, so that a tick neither parses nor walks
anything. What the closures can do is what is written here: they call no method, follow no
private field, and build nothing that could exhaust the memory.
"""

import ast
import operator
import types
from collections.abc import Callable, Mapping, Sized
from typing import Any, Final, Protocol, cast

CONSTANTS: Final[Mapping[str, object]] = {"true": True, "false": False, "none": None}
FUNCTIONS: Final[Mapping[str, Callable[..., Any]]] = {
    "abs": abs,
    "max": max,
    "min": min,
    "round": round,
    "size": len,
}
WRITTEN: Final = "written"
"""Function that says whether a key has a value yet; its argument is not read."""

MAX_ITEMS: Final = 100_000
"""Longest text or list that an operation may make."""
MAX_BITS: Final = 4096
"""Longest integer that a product may be."""

_NO_VALUES: Final = frozenset(
    {
        types.BuiltinMethodType,
        types.CodeType,
        types.FrameType,
        types.FunctionType,
        types.MethodType,
        types.MethodWrapperType,
        types.ModuleType,
    }
)


class Scope(Protocol):
    """Where an expression finds its names."""

    def __getitem__(self, name: str, /) -> object:
        """Return the value of a name; KeyError where it has none yet."""
        ...

    def __contains__(self, name: object, /) -> bool:
        """Return whether a name has a value."""
        ...


Evaluate = Callable[[Scope], Any]


class NoValueError(Exception):
    """A name has no value yet; the name is the argument."""


def compiled(node: ast.expr) -> Evaluate:
    """Return the function of a syntax tree: names in, value out.

    Args:
        node: A tree that has passed the gate of `executive.engine.language.expression`.
    """
    return _COMPILERS[type(node)](node)


def _constant(node: ast.Constant) -> Evaluate:
    value = node.value
    return lambda _: value


def _name(node: ast.Name) -> Evaluate:
    name = node.id
    if name in CONSTANTS:
        value = CONSTANTS[name]
        return lambda _: value

    def read(scope: Scope) -> object:
        try:
            return scope[name]
        except KeyError:
            raise NoValueError(name) from None

    return read


def _attribute(node: ast.Attribute) -> Evaluate:
    owner_of, field = compiled(node.value), node.attr

    def read(scope: Scope) -> object:
        owner = owner_of(scope)
        try:
            value = getattr(owner, field)
        except AttributeError:
            if not isinstance(owner, Mapping) or field not in owner:
                raise
            return owner[field]
        if type(value) in _NO_VALUES:
            if isinstance(owner, Mapping) and field in owner:
                return owner[field]
            raise TypeError(f"{field!r} is no field of {type(owner).__name__}, but a method")
        return value

    return read


def _subscript(node: ast.Subscript) -> Evaluate:
    owner, index = compiled(node.value), compiled(node.slice)
    return lambda scope: owner(scope)[index(scope)]


def _compare(node: ast.Compare) -> Evaluate:
    left, rights = compiled(node.left), [compiled(right) for right in node.comparators]
    tests = [_OPERATORS[type(test)] for test in node.ops]
    if len(tests) == 1:
        test, right = tests[0], rights[0]
        return lambda scope: test(left(scope), right(scope))

    def chain(scope: Scope) -> object:
        value, answer = left(scope), True
        for test, right in zip(tests, rights, strict=True):
            before, value = value, right(scope)
            answer = test(before, value)
            if not answer:
                return answer
        return answer

    return chain


def _bool_op(node: ast.BoolOp) -> Evaluate:
    first, *others = [compiled(value) for value in node.values]
    stops_at = isinstance(node.op, ast.Or)

    def ask(scope: Scope) -> object:
        answer = first(scope)
        for other in others:
            if bool(answer) is stops_at:
                return answer
            answer = other(scope)
        return answer

    return ask


def _unary_op(node: ast.UnaryOp) -> Evaluate:
    operand, act = compiled(node.operand), _OPERATORS[type(node.op)]
    return lambda scope: act(operand(scope))


def _bin_op(node: ast.BinOp) -> Evaluate:
    left, right, act = compiled(node.left), compiled(node.right), _OPERATORS[type(node.op)]
    return lambda scope: act(left(scope), right(scope))


def _if_exp(node: ast.IfExp) -> Evaluate:
    test, yes, no = compiled(node.test), compiled(node.body), compiled(node.orelse)
    return lambda scope: yes(scope) if test(scope) else no(scope)


def _call(node: ast.Call) -> Evaluate:
    name = cast(ast.Name, node.func).id
    if name == WRITTEN:
        asked = cast(ast.Constant, node.args[0]).value
        return lambda scope: asked in scope
    function = FUNCTIONS[name]
    arguments = [compiled(argument) for argument in node.args]
    if len(arguments) == 1:
        argument = arguments[0]
        return lambda scope: function(argument(scope))
    return lambda scope: function(*[argument(scope) for argument in arguments])


def _list(node: ast.List) -> Evaluate:
    items = [compiled(item) for item in node.elts]
    return lambda scope: [item(scope) for item in items]


def _tuple(node: ast.Tuple) -> Evaluate:
    items = [compiled(item) for item in node.elts]
    return lambda scope: tuple(item(scope) for item in items)


def _add(left: Any, right: Any) -> Any:
    if isinstance(left, Sized) and isinstance(right, Sized):
        _check_size(len(left) + len(right))
    return left + right


def _multiply(left: Any, right: Any) -> Any:
    if type(left) is int and type(right) is int:
        if left.bit_length() + right.bit_length() > MAX_BITS:
            raise ValueError(f"a product of more than {MAX_BITS} bits")
        return left * right
    for value, times in ((left, right), (right, left)):
        if isinstance(value, (str, bytes, list, tuple)) and isinstance(times, int):
            _check_size(len(value) * times)
    return left * right


def _modulo(left: Any, right: Any) -> Any:
    if isinstance(left, (str, bytes)):
        raise TypeError("% is for numbers; texts are not formatted")
    return left % right


def _check_size(size: int) -> None:
    if size > MAX_ITEMS:
        raise ValueError(f"{size} items; expected {MAX_ITEMS} at most")


_OPERATORS: Final[Mapping[type, Callable[..., Any]]] = {
    ast.Add: _add,
    ast.Sub: operator.sub,
    ast.Mult: _multiply,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: _modulo,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Not: operator.not_,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda item, group: item in group,
    ast.NotIn: lambda item, group: item not in group,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
}
_COMPILERS: Final[Mapping[type, Callable[[Any], Evaluate]]] = {
    ast.Attribute: _attribute,
    ast.BinOp: _bin_op,
    ast.BoolOp: _bool_op,
    ast.Call: _call,
    ast.Compare: _compare,
    ast.Constant: _constant,
    ast.IfExp: _if_exp,
    ast.List: _list,
    ast.Name: _name,
    ast.Subscript: _subscript,
    ast.Tuple: _tuple,
    ast.UnaryOp: _unary_op,
}
FORMS: Final = tuple(_COMPILERS)
"""Expressions that the language has."""
OPERATORS: Final = tuple(_OPERATORS)
"""Operators that it has."""
