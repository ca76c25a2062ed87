"""The command `cellwright`: its subcommands, and what an error looks like.

A subcommand's module is imported when that subcommand is asked for, so `check` does not wait
for what `run` needs. None of them loads a simulator, a planner or a network before it runs.
"""

import keyword
import os
import sys
import traceback
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from executive.core.errors import CellwrightError, InputError
from executive.core.registry import closest

_PANELS: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "Missions": {
            "run": "executive.cli.cmd_run",
            "resume": "executive.cli.cmd_resume",
            "attach": "executive.cli.cmd_attach",
            "campaign": "executive.cli.cmd_campaign",
            "serve": "executive.cli.cmd_serve",
        },
        "Trees": {
            "check": "executive.cli.cmd_check",
            "lint": "executive.cli.cmd_lint",
            "fmt": "executive.cli.cmd_fmt",
            "tree": "executive.cli.cmd_tree",
            "skills": "executive.cli.cmd_skills",
            "import": "executive.cli.cmd_import",
            "export": "executive.cli.cmd_export",
        },
        "What a run did": {
            "inspect": "executive.cli.cmd_inspect",
            "ticks": "executive.cli.cmd_ticks",
            "why": "executive.cli.cmd_why",
            "why-not": "executive.cli.cmd_why",
            "why-halted": "executive.cli.cmd_why",
            "who": "executive.cli.cmd_who",
            "history": "executive.cli.cmd_who",
            "report": "executive.cli.cmd_report",
            "diff": "executive.cli.cmd_diff",
            "retick": "executive.cli.cmd_retick",
            "whatif": "executive.cli.cmd_whatif",
            "cover": "executive.cli.cmd_cover",
            "groot": "executive.cli.cmd_groot",
        },
        "Cells, and what sees in them": {
            "doctor": "executive.cli.cmd_doctor",
            "perceive": "executive.cli.cmd_perceive",
            "affinity": "executive.cli.cmd_affinity",
            "train": "executive.cli.cmd_train",
        },
    }
)
"""Panels of the help page: commands, and the modules that they are in."""

_COMMANDS = {name: module for panel in _PANELS.values() for name, module in panel.items()}
_PANEL_OF = {name: panel for panel, commands in _PANELS.items() for name in commands}


class _LazyCommands(TyperGroup):
    """Commands by name; each is a function or a group of the same name in its module.

    Contexts and commands are `Any`: typer brings its own, private copy of click's.
    """

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002 - as the base class asks
        """Return the names in the order of the help page."""
        return [*_COMMANDS]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:  # noqa: ARG002 - see above
        """Import and return a command.

        Raises:
            InputError: There is none of that name.
        """
        if cmd_name not in _COMMANDS:
            raise InputError(f"no command {cmd_name!r}; {closest(cmd_name, [*_COMMANDS])}")
        name = cmd_name.replace("-", "_")
        name = f"{name}_" if keyword.iskeyword(name) else name
        command = getattr(import_module(_COMMANDS[cmd_name]), name)
        holder, panel = typer.Typer(), _PANEL_OF[cmd_name]
        if isinstance(command, typer.Typer):
            holder.add_typer(command, name=cmd_name, rich_help_panel=panel)
        else:
            holder.command(cmd_name, rich_help_panel=panel)(command)
        return _with_flowing_help(typer.main.get_group(holder).commands[cmd_name])


def _with_flowing_help(command: Any) -> Any:
    """Join the lines of each paragraph of a command's help, which is broken where it is shown."""
    if command.help:
        paragraphs = command.help.split("\n\n")
        command.help = "\n\n".join(" ".join(each.split()) for each in paragraphs)
    for each in getattr(command, "commands", {}).values():
        _with_flowing_help(each)
    return command


app = typer.Typer(
    name="cellwright",
    cls=_LazyCommands,
    help="Behaviour trees for robot cells: compose them, run missions, look at what they did.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"cellwright {version('cellwright')}")
        raise typer.Exit


@app.callback()
def _options(
    _: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print it and exit."
        ),
    ] = False,
    path: Annotated[
        list[Path] | None,
        typer.Option(
            "--path",
            exists=True,
            file_okay=False,
            help="Folder to look for trees in, before those in CELLWRIGHT_PATH.",
        ),
    ] = None,
) -> None:
    """Take the options that stand before a command."""
    if path:
        from executive.engine.loading.packages import put_first

        put_first(path)


def main() -> None:
    """Run the command line; bad input exits with 2, any other trouble of ours with 3."""
    # Looking for plugins reads the metadata of every package that is installed.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    try:
        app()
    except CellwrightError as error:
        from executive.cli.console import chatter, print_error

        print_error(chatter(), str(error))
        sys.exit(2 if isinstance(error, InputError) else 3)
    except Exception:  # a bug of ours: say all, and keep 1 for missions that failed
        traceback.print_exc()
        sys.exit(3)
