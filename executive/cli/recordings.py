"""Which recording a command means: a file, the newest one, or one of a mission that runs."""

from pathlib import Path
from typing import Annotated, Any, Final

import typer

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.recording.parts import parts_of

RUNS: Final = Path("runs")
"""Where missions are recorded that are not told where."""

LAST, LIVE = "last", "live"
_SHOWN = 8


def recording_path(text: str) -> Path:
    """Return the recording that a name means.

    Args:
        text: A file; the name of one in `runs/`, with or without its suffix; `last` for the
            newest recording in `runs/`; `live` for the newest whose mission runs now.

    Raises:
        InputError: There is none.
    """
    if text == LAST:
        return _newest_first()[0]
    if text == LIVE:
        return _live()
    for path in (Path(text), RUNS / text, RUNS / f"{text}.mcap"):
        if path.is_file():
            return path
    raise InputError(f"{text}: no such recording; {_known(text)}")


def _newest_first() -> list[Path]:
    """Return the recordings in `runs/`, the one that was written to last first."""
    written_s: dict[Path, float] = {}
    for file in RUNS.glob("*.mcap"):
        first = parts_of(file)[0]
        written_s[first] = max(written_s.get(first, 0.0), file.stat().st_mtime)
    if not written_s:
        raise InputError(f"no recording in {RUNS.resolve()}; try cellwright run, or name a file")
    return sorted(written_s, key=lambda path: (-written_s[path], path.name))


def _live() -> Path:
    found = next((path for path in _newest_first() if _runs(path)), None)
    if found is None:
        raise InputError(
            f"no mission that is recorded in {RUNS.resolve()} runs now; "
            "try last for the newest recording, or name the file that it records to"
        )
    return found


def _runs(path: Path) -> bool:
    from executive.engine.running.remote import NotRunningError, send

    try:
        send(path, "state")
    except NotRunningError:
        return False
    return True


def _known(text: str) -> str:
    """Return what there is instead: the closest names, or the newest."""
    import difflib

    names = [file.stem for file in sorted(RUNS.glob("*.mcap"), reverse=True)]
    near = difflib.get_close_matches(Path(text).stem, names, n=_SHOWN, cutoff=0.5)
    return closest(Path(text).stem, [LAST, LIVE, *(near or names[:_SHOWN])])


def recording_argument(metavar: str, told: str) -> Any:
    """Return the argument of a command that takes a recording by any of its names."""
    return typer.Argument(
        metavar=metavar,
        parser=recording_path,
        help=f"{told}: a file, a name in runs/, last, or live.",
    )


RunArgument = Annotated[Path, recording_argument("RUN", "Recording of a run")]
RunsArgument = Annotated[list[Path], recording_argument("RUN", "Recordings of runs")]
