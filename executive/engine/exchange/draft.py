"""Nodes of our documents before they are written out."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from executive.engine.language.block_models import BLOCKS

Skip = Literal["success", "failure"]
"""What stands for SKIPPED: what the parent makes of a child that it passes over."""


@dataclass(slots=True)
class Draft:
    """One node.

    Attributes:
        kind: Its kind.
        body: What it says, without its children.
        children: Its children in order.
        comments: What is said about it.
        cases: Texts of the cases of a switch, in the order of the children.
    """

    kind: str
    body: dict[str, object] = field(default_factory=dict)
    children: list["Draft"] = field(default_factory=list)
    comments: tuple[str, ...] = ()
    cases: tuple[str, ...] = ()

    @property
    def is_leaf(self) -> bool:
        """Whether its keys stand beside its kind."""
        return self.kind not in BLOCKS

    @property
    def label(self) -> str:
        """What it is called in paths while it has no name of its own."""
        what = self.body.get(self.kind) if self.kind in ("skill", "subtree") else None
        return str(self.body.get("name") or what or self.kind)

    def walk(self) -> Iterator["Draft"]:
        """Yield the node and all below it."""
        yield self
        for child in self.children:
            yield from child.walk()


def leaf(kind: str, value: object, **more: object) -> Draft:
    """Return a node whose kind has a value: `when: true`."""
    return Draft(kind, {kind: value, **more})


def block(kind: str, *children: Draft, **body: object) -> Draft:
    """Return a node with children."""
    return Draft(kind, dict(body), list(children))


def all_of(texts: list[str]) -> str:
    """Return the condition that all of some conditions hold."""
    return ast.unparse(joined(ast.And(), [_parsed(text) for text in texts]))


def any_of(texts: list[str]) -> str:
    """Return the condition that one of some conditions holds."""
    return ast.unparse(joined(ast.Or(), [_parsed(text) for text in texts]))


def none_of(text: str) -> str:
    """Return the condition that a condition does not hold."""
    tree = _parsed(text)
    if isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.Not):
        return ast.unparse(tree.operand)
    return ast.unparse(ast.UnaryOp(ast.Not(), tree))


def joined(operator: ast.boolop, values: list[ast.expr]) -> ast.expr:
    """Join conditions, those that are joined in the same way already with the others."""
    flat: list[ast.expr] = []
    for value in values:
        same = isinstance(value, ast.BoolOp) and type(value.op) is type(operator)
        flat += value.values if same and isinstance(value, ast.BoolOp) else [value]
    return ast.BoolOp(operator, flat) if len(flat) > 1 else flat[0]


def _parsed(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body
