"""The command `cellwright`: every subcommand, and what an error looks like.

Importing this loads no simulator, planner or network: a command imports what it needs when
it runs.
"""

import sys
import traceback
from importlib.metadata import version
from typing import Annotated

import typer

from executive.cli.cmd_check import check
from executive.cli.cmd_doctor import doctor
from executive.cli.cmd_inspect import inspect
from executive.cli.cmd_perceive import perceive
from executive.cli.cmd_run import run
from executive.cli.cmd_skills import skills
from executive.cli.cmd_tree import tree
from executive.cli.console import chatter, print_error
from executive.core.errors import CellwrightError, InputError

app = typer.Typer(
    name="cellwright",
    help="Behaviour trees for robot cells: compose them, run missions, look at what they did.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.command()(run)
app.command()(check)
app.command()(inspect)
app.command()(skills)
app.add_typer(tree, name="tree")
app.add_typer(perceive, name="perceive")
app.command()(doctor)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"cellwright {version('cellwright')}")
        raise typer.Exit


@app.callback()
def _options(
    _: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print it and go."),
    ] = False,
) -> None:
    """Take the options that stand before a command."""


def main() -> None:
    """Run the command line; bad input exits with 2, any other trouble of ours with 3."""
    try:
        app()
    except InputError as error:
        print_error(chatter(), str(error))
        sys.exit(2)
    except CellwrightError as error:
        print_error(chatter(), str(error))
        sys.exit(3)
    except Exception:  # a bug of ours: say all, and keep 1 for missions that failed
        traceback.print_exc()
        sys.exit(3)
