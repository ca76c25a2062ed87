"""Cable configurations that come from outside: centre lines in JSON files."""

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from executive.core.errors import InputError
from executive.core.json_files import read_json
from simulation.cable.configurations import Lines, settle_all
from simulation.cable.knots import smooth
from simulation.cable.parameters import RodParameters
from simulation.cable.truth import crossings_of

Floats = NDArray[np.float64]

SHORTEST_M = 0.2
LONGEST_M = 6.0
HIGHEST_M = 0.3
# Strands whose centre lines come closer than this share of a diameter run through each other.
TOUCH_SHARE = 0.5


class CentreLineDocument(BaseModel):
    """The file's content: an ordered centre line in workspace coordinates [m]."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    nodes_m: tuple[tuple[float, float, float], ...]


def configuration_from_file(path: Path, parameters: RodParameters | None = None) -> Floats:
    """Read a centre line, lay a cable along it, and let it come to rest.

    Args:
        path: JSON `{"nodes_m": [[x, y, z], ...]}` with points of any spacing; at crossings
            the upper strand's z is the larger one.
        parameters: What the cable is made of.

    Returns:
        Node positions [m], world frame, evenly spaced, shape (N, 3).

    Raises:
        InputError: The file cannot be used; the message says which point and why.
    """
    return configurations_from_files((path,), parameters)[0]


def configurations_from_files(
    paths: Sequence[Path], parameters: RodParameters | None = None
) -> Lines:
    """Read centre lines, lay a cable along each, and let them come to rest together.

    Args:
        paths: One file for each cable, as for `configuration_from_file`.
        parameters: What the cables are made of.

    Returns:
        Node positions of each [m], world frame, evenly spaced, shape (N_k, 3).

    Raises:
        InputError: A file cannot be used, or two cables run through each other.
    """
    parameters = parameters or RodParameters()
    lines_m = [_line(path, parameters) for path in paths]
    for (path, one_m), (other, other_m) in combinations(zip(paths, lines_m, strict=True), 2):
        _check_apart(
            f"{path}: nodes_m: runs through that of {other} at", (one_m, other_m), parameters
        )
    return settle_all(lines_m, parameters)


def _line(path: Path, parameters: RodParameters) -> Floats:
    points_m = _points(path)
    _check_points(path, points_m, parameters)
    nodes_m = smooth(points_m, parameters.node_spacing_m)
    nodes_m[:, 2] = np.maximum(nodes_m[:, 2], parameters.radius_m)
    _check_apart(f"{path}: nodes_m: runs through itself at", (nodes_m,), parameters)
    return nodes_m


def _points(path: Path) -> Floats:
    document = read_json(path, CentreLineDocument, 'a centre line {"nodes_m": [[x, y, z], ...]}')
    points_m = np.array(document.nodes_m, dtype=np.float64).reshape(-1, 3)
    apart = np.ones(len(points_m), dtype=bool)
    apart[1:] = np.any(np.diff(points_m, axis=0) != 0.0, axis=1)
    return points_m[apart]


def _check_points(path: Path, points_m: Floats, parameters: RodParameters) -> None:
    if len(points_m) < 4:
        raise InputError(
            f"{path}: nodes_m: not enough points; got {len(points_m)} different ones; "
            "expected at least 4"
        )
    half = 0.5 * np.array(parameters.table_size_m)
    faults = (
        ("not finite", ~np.isfinite(points_m).all(axis=1), "metres"),
        ("off the table", (np.abs(points_m[:, :2]) > half).any(axis=1),
         f"|x| <= {half[0]:g} and |y| <= {half[1]:g}"),
        ("too low or too high", (points_m[:, 2] < 0.0) | (points_m[:, 2] > HIGHEST_M),
         f"0 <= z <= {HIGHEST_M:g}"),
    )  # fmt: skip
    for what, wrong, expected in faults:
        if wrong.any():
            index = int(np.argmax(wrong))
            got = ", ".join(f"{value:g}" for value in points_m[index])
            raise InputError(f"{path}: nodes_m[{index}]: {what}; got ({got}); expected {expected}")
    _check_length(path, points_m)


def _check_length(path: Path, points_m: Floats) -> None:
    length_m = float(np.linalg.norm(np.diff(points_m, axis=0), axis=1).sum())
    if not SHORTEST_M <= length_m <= LONGEST_M:
        raise InputError(
            f"{path}: nodes_m: wrong length; got {length_m:.2f} m; expected {SHORTEST_M:g} to "
            f"{LONGEST_M:g} m"
        )


def _check_apart(where: str, lines_m: Sequence[Floats], parameters: RodParameters) -> None:
    nodes_m = np.vstack(lines_m)
    index = np.arange(len(nodes_m), dtype=float)
    limit_m = TOUCH_SHARE * 2.0 * parameters.radius_m
    for crossing in crossings_of(lines_m):
        first, second = (
            np.array([np.interp(arc, index, axis) for axis in nodes_m.T])
            for arc in (crossing.first, crossing.second)
        )
        gap_m = abs(first[2] - second[2])
        if gap_m < limit_m:
            raise InputError(
                f"{where} ({first[0]:.3f}, {first[1]:.3f}); got "
                f"strands {1e3 * gap_m:.1f} mm apart in height; expected at least "
                f"{1e3 * limit_m:.1f} mm; try: raise the upper strand's z at crossings"
            )
