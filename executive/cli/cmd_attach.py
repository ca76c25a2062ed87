"""`cellwright attach`: pause, step and steer a mission that runs in another terminal."""

import json
import shlex
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.text import Text

from executive.cli.console import print_error, results
from executive.cli.recordings import RunArgument
from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.running.remote import NotRunningError, send

_Arguments = dict[str, Any]

_STEP_S, _POLL_S = 2.0, 0.02

_HELP = """\
  pause                     resume (c)              state
  step (s)                  one tick
  into (i)  over (o)  out (u)   node by node
  break NODE [on EVENT] [when EXPRESSION]           unbreak NUMBER
  force NODE=success|failure|running [once]         unforce NODE
  stop                      emergency_stop          quit (q): leave, the mission goes on\
"""
_ASKING_FOR_HELP = ("", "help", "?")


def attach(
    recording: RunArgument,
    do: Annotated[
        list[str] | None,
        typer.Option("--do", metavar="COMMAND", help="Do this and leave; 'help' lists commands."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print states as JSON.")] = False,
) -> None:
    """Pause, step and steer a mission that runs in another terminal.

    Without `--do`, commands are read from the keyboard until `quit`; leaving does not resume a
    mission that is paused.
    """
    console = results()
    show = _print_json if as_json else _print_state
    if do:
        for line in do:
            if line in _ASKING_FOR_HELP:
                console.print(_HELP, highlight=False)
            else:
                show(console, _done(recording, line))
        return
    console.print(_HELP, style="bright_black", highlight=False)
    show(console, send(recording, "state"))
    _read(recording, console, show)


def _read(recording: Path, console: Console, show: Callable[[Console, _Arguments], None]) -> None:
    while True:
        try:
            line = console.input("cell> ").strip()
        except (EOFError, KeyboardInterrupt):
            return
        if line in ("q", "quit"):
            return
        if line in _ASKING_FOR_HELP:
            console.print(_HELP, style="bright_black", highlight=False)
            continue
        try:
            show(console, _done(recording, line))
        except NotRunningError as error:
            print_error(console, str(error))
            return
        except InputError as error:
            print_error(console, str(error))


def _done(recording: Path, line: str) -> _Arguments:
    """Send what a line asks for and return the state after it."""
    word, _, rest = line.strip().partition(" ")
    word = _SHORT.get(word, word)
    if word not in _COMMANDS:
        raise InputError(f"unknown command {word!r}; {closest(word, [*_COMMANDS])}")
    command, arguments = _COMMANDS[word](rest.strip())
    answer: _Arguments = send(recording, command, by="terminal", **arguments)
    return _after_step(recording, answer) if command == "step" else answer


def _after_step(recording: Path, state: _Arguments) -> _Arguments:
    """Wait for the end of a step; one that takes long is shown as it is."""
    end_s = time.monotonic() + _STEP_S
    while state["standing"] is None and time.monotonic() < end_s:
        time.sleep(_POLL_S)
        state = send(recording, "state")
    return state


def _plain(command: str, **arguments: str) -> Callable[[str], tuple[str, _Arguments]]:
    def asked(rest: str) -> tuple[str, _Arguments]:
        if rest:
            raise InputError(f"{command} takes nothing more; got {rest!r}")
        return command, dict(arguments)

    return asked


def _unbreak(rest: str) -> tuple[str, _Arguments]:
    if not rest.isdecimal():
        raise InputError(f"unbreak: got {rest!r}; expected the number of a breakpoint")
    return "unbreak", {"number": int(rest)}


def _force(rest: str) -> tuple[str, _Arguments]:
    words = shlex.split(rest)
    nodes, _, answer = words[0].partition("=") if words else ("", "", "")
    if not nodes or not answer or words[1:] not in ([], ["once"]):
        raise InputError(f"force: got {rest!r}; expected NODE=success|failure|running [once]")
    return "force", {"nodes": nodes, "answer": answer, "once": len(words) == 2}


_COMMANDS: Mapping[str, Callable[[str], tuple[str, _Arguments]]] = {
    "state": _plain("state"),
    "pause": _plain("pause"),
    "resume": _plain("resume"),
    "step": _plain("step", step="tick"),
    "into": _plain("step", step="into"),
    "over": _plain("step", step="over"),
    "out": _plain("step", step="out"),
    "stop": _plain("stop"),
    "emergency_stop": _plain("emergency_stop"),
    "break": lambda rest: ("break", {"text": rest}),
    "unbreak": _unbreak,
    "force": _force,
    "unforce": lambda rest: ("unforce", {"nodes": rest}),
}
_SHORT = {"c": "resume", "s": "step", "i": "into", "o": "over", "u": "out", "b": "break"}


def _print_json(_: Console, state: _Arguments) -> None:
    typer.echo(json.dumps(state))


def _print_state(console: Console, state: _Arguments) -> None:
    standing = state["standing"]
    if state["stopping"]:
        console.print(Text(f"stopping: {state['stopping']}", "yellow"))
    elif standing is None:
        console.print(Text("running", "green"))
    else:
        where = f"tick {standing['tick']}"
        if standing["node"]:
            where += f", {'after' if standing['answered'] else 'before'} {standing['node']}"
        console.print(Text.assemble(("paused ", "yellow"), where, f"  ({standing['why']})"))
    for one in state["breakpoints"]:
        hits = f"{one['hits']} times" if one["hits"] != 1 else "once"
        console.print(f"  {one['number']}  {one['text']}  hit {hits}", highlight=False)
    for path, answer in state["forced"].items():
        console.print(f"  forced  {path} = {answer}", highlight=False)
