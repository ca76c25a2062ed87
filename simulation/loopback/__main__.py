"""`python -m simulation.loopback`: a controller to connect to, until it is interrupted."""

import argparse
import contextlib
import json
import sys
import threading

from executive.core.errors import InputError
from simulation.loopback.server import HOST, Server
from simulation.loopback.settings import LoopbackSettings
from simulation.table_cell_config import read_settings


def main() -> int:
    """Serve until interrupted; with `--until-input-ends` also until standard input ends."""
    parser = argparse.ArgumentParser(prog="python -m simulation.loopback", description=main.__doc__)
    parser.add_argument("--until-input-ends", action="store_true")
    parser.add_argument(
        "settings", nargs="*", metavar="NAME=VALUE", help="see simulation/loopback/settings.py"
    )
    given = parser.parse_args()
    try:
        values = dict(map(_setting, given.settings))
        settings = read_settings(LoopbackSettings, values, "loopback controller")
    except InputError as cause:
        sys.stderr.write(f"{cause}\n")
        return 2
    ended = threading.Event()
    if given.until_input_ends:
        threading.Thread(target=_await_end, args=(ended,), daemon=True).start()
    with contextlib.suppress(KeyboardInterrupt), contextlib.closing(Server(settings)) as server:
        sys.stdout.write(f"listening on {HOST}:{server.port}\n")
        sys.stdout.flush()
        server.serve(ended.is_set)
    return 0


def _setting(text: str) -> tuple[str, object]:
    name, _, value = text.partition("=")
    try:
        return name, json.loads(value)
    except json.JSONDecodeError:
        return name, value


def _await_end(ended: threading.Event) -> None:
    sys.stdin.buffer.read()
    ended.set()


if __name__ == "__main__":
    sys.exit(main())
