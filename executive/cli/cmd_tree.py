"""`cellwright tree`: a tree as text, or as a graph for Graphviz."""

from typing import Annotated, Any

import typer
from rich.console import Console
from rich.text import Text
from rich.tree import Tree
from typer.core import TyperGroup

from executive.app.catalogue import port_types, skills
from executive.cli.cmd_skills import port_line
from executive.engine.loading.expansion import ExpandedNode, expand
from executive.engine.loading.loader import Program, load_program


class _ShowByDefault(TyperGroup):
    """What is no subcommand is the tree to show."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return a subcommand with its arguments, as the base class does."""
        if args and args[0] not in self.commands and not args[0].startswith("-"):
            args = [show.__name__, *args]
        return super().resolve_command(ctx, args)


tree = typer.Typer(
    cls=_ShowByDefault,
    help="Show a tree with its subtrees: cellwright tree NAME.",
    no_args_is_help=True,
)

_TreeName = Annotated[str, typer.Argument(help="Name of a tree or mission, or its YAML file.")]

_SHAPES = {"skill": "box, style=rounded", "when": "ellipse", "set": "note"}


@tree.command()
def show(file: _TreeName) -> None:
    """Print a tree with its subtrees put in, its ports and what every node is wired to."""
    program = _load(file)
    # Wide enough for any wiring: a line that is cut short would hide the end of it.
    console = Console(highlight=False, width=1000)
    console.print(Text("\n".join(_header(program))))
    root = expand(program)
    drawn = Tree(_line(root))
    open_nodes = [(root, drawn)]
    while open_nodes:
        node, branch = open_nodes.pop()
        open_nodes += [(child, branch.add(_line(child))) for child in node.children]
    console.print(drawn)


@tree.command()
def dot(file: _TreeName) -> None:
    """Print a tree with its subtrees put in as Graphviz text."""
    program = _load(file)
    root = expand(program)
    ids = {id(node): f"n{i}" for i, node in enumerate(root.walk())}
    lines = [f"digraph {program.tree.name} {{", '  node [fontname="sans-serif", fontsize=10];']
    for node in root.walk():
        text = _escaped("\n".join([f"{_kind(node)}{node.name}", *node.details]))
        shape = _SHAPES.get(node.kind, "box")
        lines.append(f'  {ids[id(node)]} [label="{text}", shape={shape}];')
    lines += [
        f"  {ids[id(node)]} -> {ids[id(child)]};" for node in root.walk() for child in node.children
    ]
    typer.echo("\n".join([*lines, "}"]))


def _load(file: str) -> Program:
    return load_program(file, skills=skills(), types=port_types())


def _header(program: Program) -> list[str]:
    spec = program.tree
    lines = [f"{spec.name}: {spec.document.about}".removesuffix(": ")]
    lines += [f"  in  {port_line(name, port)}" for name, port in spec.inputs.items()]
    lines += [f"  out {port_line(name, port)}" for name, port in spec.outputs.items()]
    return lines


def _kind(node: ExpandedNode) -> str:
    """Return the kind as it stands before a name; a skill's own name is enough."""
    return "" if node.kind in ("skill", node.name) else f"{node.kind} "


def _line(node: ExpandedNode) -> Text:
    details = f"  {'; '.join(node.details)}" if node.details else ""
    return Text.assemble((_kind(node), "cyan"), (node.name, "bold"), (details, "dim"))


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
