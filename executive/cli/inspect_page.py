"""`cellwright inspect --web`: serves the page of a recording until it is interrupted."""

import contextlib
import secrets
import webbrowser
from pathlib import Path

from rich.console import Console
from rich.text import Text

from executive.core.errors import recording_named_by_the_user


def serve_page(
    recording: Path, console: Console, *, host: str, port: int, open_browser: bool
) -> None:
    """Serve the page of a recording, live while its run goes on.

    Args:
        recording: The recording.
        console: Where the address is printed.
        host: Address to listen on; one that is not of this machine alone needs a token, which
            is part of the address that is printed.
        port: Port; 0 takes a free one.
        open_browser: Whether to open the address in a browser.

    Raises:
        InputError: It is no recording, or the port cannot be had.
    """
    from executive.app.views import write_html
    from executive.core.network import is_loopback
    from executive.inspector.web.server import PageServer, application
    from executive.inspector.web.session import Session

    with recording_named_by_the_user():
        session = Session(recording)
    token = None if is_loopback(host) else secrets.token_urlsafe(16)
    server = PageServer(application(session, token=token, write_scene=write_html), host, port)
    shown = f"[{host}]" if ":" in host else host
    address = f"http://{shown}:{server.port}/" + (f"?token={token}" if token else "")
    state = "" if session.ended else " (live)"
    console.print(Text.assemble(f"{recording}{state}: ", (address, "bold")), soft_wrap=True)
    console.print("Ctrl-C ends it", style="bright_black")
    if open_browser:
        webbrowser.open(address)
    with contextlib.suppress(KeyboardInterrupt):
        server.serve()
