"""`cellwright serve`: hold a cell, and run the missions that clients ask for."""

import logging
import os
import secrets
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.text import Text

from executive.cli.console import chatter
from executive.core.errors import InputError
from executive.core.network import is_loopback

if TYPE_CHECKING:
    from executive.app.service.cell_service import CellService
    from executive.engine.language.document import CellDocument

TOKEN_VARIABLE = "CELLWRIGHT_TOKEN"
_SHORTEST_TOKEN = 16


def serve(
    cell: Annotated[str, typer.Argument(help="Name of a cell, or its YAML file.")],
    host: Annotated[
        str,
        typer.Option(help="Address to listen on; others than this machine's need a token."),
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of HTTP; 0 for any.")] = 8420,
    opcua: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Also serve OPC UA on that port.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", file_okay=False, help="Folder; runs/CELL by default."),
    ] = None,
) -> None:
    """Hold a cell: missions come in over HTTP or OPC UA and are run one at a time.

    The token that clients need off this machine is that of the environment variable
    CELLWRIGHT_TOKEN; one is made and printed where there is none. Ctrl-C stops the mission that
    runs, in order, and ends the service.
    """
    from executive.app.cell_locks import lock_of
    from executive.app.service.cell_service import CellService

    document, file = _cell(cell)
    token = None if is_loopback(host) else _token()
    folder = out or Path("runs") / document.name
    service = CellService(document.name, folder, lock_of(document.name, file))
    with service:
        _serve(service, host, port, opcua, token)


def _cell(named: str) -> "tuple[CellDocument, Path]":
    from executive.app.missions import load_cell
    from executive.engine.loading.packages import put_first

    if Path(named).is_file():  # its missions stand beside it
        put_first([Path(named).resolve().parent, Path(named).resolve().parent.parent])
    return load_cell(named)


def _token() -> str:
    token = os.environ.get(TOKEN_VARIABLE)
    if token is None:
        token = secrets.token_urlsafe(16)
        chatter().print(Text(f"token: {token}"), soft_wrap=True)
    elif len(token) < _SHORTEST_TOKEN:
        raise InputError(
            f"{TOKEN_VARIABLE}: is too short to be kept from guessing; expected at least "
            f"{_SHORTEST_TOKEN} characters"
        )
    return token


def _serve(
    service: "CellService", host: str, port: int, opcua: int | None, token: str | None
) -> None:
    from contextlib import ExitStack, suppress

    from executive.app.service.http import application

    # What it says of clients that send garbage would fill a disk.
    logging.getLogger("asyncua").setLevel(logging.CRITICAL)
    from executive.inspector.web.server import PageServer

    server = PageServer(application(service, token=token), host, port, most_at_once=200)
    shown = f"[{host}]" if ":" in host else host
    console, state = chatter(), service.state()
    with ExitStack() as stack:
        console.print(f"cell {state.cell}: http://{shown}:{server.port}/openapi.json")
        if opcua is not None:
            from executive.app.service.opcua import OpcUaServer

            address = stack.enter_context(OpcUaServer(service, host, opcua, token=token)).address
            console.print(f"cell {state.cell}: {address}")
        if state.why_held:
            console.print(f"held: {state.why_held}; POST /cell/resume lets {state.queued} go on")
        console.print("Ctrl-C ends it", style="bright_black")
        # Ticks of missions come before requests: what is started later by others keeps its rank.
        os.setpriority(os.PRIO_PROCESS, _this_thread(), 5)
        # A manager of services ends them by SIGTERM, which is to end this one in order as well.
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        with suppress(KeyboardInterrupt):
            server.serve()


def _this_thread() -> int:
    import threading

    return threading.get_native_id()
