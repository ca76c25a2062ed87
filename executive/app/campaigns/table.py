"""The results of a campaign as a Parquet file: a row a run, for any tool that reads tables."""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from pydantic import JsonValue

from executive.app.campaigns.jobs import RunRecord
from executive.core.errors import InputError

TABLE = "results.parquet"
_PLAIN = (
    *("name", "variant", "seed", "outcome", "reason", "sim_s", "wall_s", "ticks", "actions"),
    *("peak_mb", "host", "recording"),
)


def write_table(records: Iterable[RunRecord], file: Path) -> None:
    """Write the runs: plain columns, `set.KEY` for settings, measures by name, the rest as JSON.

    Raises:
        InputError: PyArrow is not installed, or the file cannot be written.
    """
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise InputError(
            "campaign: PyArrow is not installed; try pip install 'cellwright[campaign]'"
        ) from None
    rows = sorted(records, key=lambda one: (one.variant, one.seed))
    table = pyarrow.table({name: _array(values) for name, values in _columns(rows).items()})
    new = file.with_name(f"{file.name}.new")
    try:
        parquet.write_table(table, new)
        new.replace(file)
    except OSError as error:
        new.unlink(missing_ok=True)
        raise InputError(f"{file}: cannot be written; got {error}") from None


def _columns(rows: Sequence[RunRecord]) -> dict[str, list[Any]]:
    columns: dict[str, list[Any]] = {name: [getattr(row, name) for row in rows] for name in _PLAIN}
    for key in dict.fromkeys(key for row in rows for key in row.settings):
        columns[f"set.{key}"] = [row.settings.get(key) for row in rows]
    for name in dict.fromkeys(name for row in rows for name in row.measures):
        columns[name] = [row.measures.get(name) for row in rows]
    for name in ("claim", "truth"):
        columns[f"{name}_json"] = [_text(getattr(row, name)) for row in rows]
    return columns


def _text(value: JsonValue) -> str | None:
    return None if value is None else json.dumps(value)


def _array(values: list[Any]) -> Any:
    """Return a column; values of several kinds stand in it as JSON."""
    import pyarrow

    try:
        return pyarrow.array(values)
    except (pyarrow.ArrowInvalid, pyarrow.ArrowTypeError):
        return pyarrow.array([_text(value) for value in values])
