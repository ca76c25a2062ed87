"""`cellwright groot`: shows a run to Groot2, btview and others that speak Groot2's protocol."""

import contextlib
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from executive.cli.console import chatter
from executive.cli.recordings import recording_argument
from executive.core.errors import InputError, recording_named_by_the_user


def groot(
    recording: Annotated[
        Path, recording_argument("RUN", "Recording of a run, which may still go on")
    ],
    host: Annotated[
        str, typer.Option(help="Address; others than this machine's may watch but not steer.")
    ] = "127.0.0.1",
    port: Annotated[
        int,
        typer.Option(min=0, max=65534, help="Port, and the next one; 0 takes two free ones."),
    ] = 1667,
    speed: Annotated[
        float | None,
        typer.Option(
            metavar="FACTOR",
            help="Play the recording from its first tick, this many times as fast as the cell.",
        ),
    ] = None,
) -> None:
    """Let Groot2 or btview watch a run, live while it goes on.

    It answers out of the recording, so a run that has ended looks the same.
    """
    from executive.core.network import is_loopback
    from executive.inspector.groot.answers import Answers
    from executive.inspector.groot.run_view import RunView
    from executive.inspector.groot.server import GrootServer

    if speed is not None and not speed > 0.0:
        raise InputError(f"--speed {speed:g}: expected a factor above 0")
    with recording_named_by_the_user():
        view = RunView(recording, speed=speed)
    server = GrootServer(Answers(view, steering=is_loopback(host)), host, port)
    console = chatter()
    state = " (live)" if view.live else ""
    address = f"{host}:{server.port}"
    console.print(
        Text.assemble(
            f"{recording}{state}: ",
            (address, "bold"),
            f", {len(view.tree.nodes)} nodes; breakpoints on port {server.port + 1}",
        ),
        soft_wrap=True,
    )
    console.print("Ctrl-C ends it", style="bright_black")
    with contextlib.suppress(KeyboardInterrupt):
        server.serve()
