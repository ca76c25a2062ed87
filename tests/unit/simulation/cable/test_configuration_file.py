"""Centre lines from outside: what is taken, and what is refused with which words."""

import json

import numpy as np
import pytest

from executive.core.errors import InputError
from simulation.cable.configuration_file import configuration_from_file

ANGLES = np.linspace(0.0, 2.5 * np.pi, 40)


@pytest.fixture
def written(tmp_path):
    def write(nodes_m):
        path = tmp_path / "cable.json"
        path.write_text(json.dumps({"nodes_m": np.asarray(nodes_m).tolist()}), encoding="utf-8")
        return path

    return write


def line(z_m):
    radii = 0.1 + 0.02 * np.sin(1.3 * ANGLES)
    return np.column_stack([radii * np.cos(ANGLES), radii * np.sin(ANGLES), z_m])


def test_a_line_of_any_spacing_becomes_an_evenly_spaced_cable_at_rest(written):
    given = line(np.linspace(0.0, 0.02, 40))
    nodes_m = configuration_from_file(written(given))
    steps_m = np.linalg.norm(np.diff(nodes_m, axis=0), axis=1)
    np.testing.assert_allclose(steps_m, 0.01, atol=5e-4)
    gaps_m = np.linalg.norm(nodes_m[None, :, :2] - given[:, None, :2], axis=2).min(axis=1)
    assert gaps_m.max() < 0.03
    assert nodes_m[:, 2].max() < 0.015


@pytest.mark.parametrize(
    ("nodes", "words"),
    [
        ([[0, 0, 0]] * 9, "not enough points; got 1 different"),
        (line(np.zeros(40)) * [6, 1, 1], r"off the table; got \(0.6, 0, 0\)"),
        (line(np.full(40, -0.1)), "too low or too high"),
        (line(np.zeros(40)) * 0.01, "wrong length; got 0.01 m"),
        (np.tile(line(np.zeros(40))[:20], (60, 1)) + 0.0, "wrong length"),
        ([[0.1, 0, 0], [-0.1, 0, 0], [-0.1, 0.1, 0], [0, 0.1, 0], [0, -0.1, 0]],
         "runs through itself at"),
        ([[0, 0], [1, 1]], "not a centre line"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_refused(written, nodes, words):
    with pytest.raises(InputError, match=words):
        configuration_from_file(written(nodes))


def test_nan_is_refused(tmp_path):
    path = tmp_path / "cable.json"
    path.write_text('{"nodes_m": [[0, 0, NaN], [0.1, 0, 0], [0.2, 0, 0], [0.3, 0, 0]]}')
    with pytest.raises(InputError, match=r"nodes_m"):
        configuration_from_file(path)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"missing\.json: cannot be read"):
        configuration_from_file(tmp_path / "missing.json")
