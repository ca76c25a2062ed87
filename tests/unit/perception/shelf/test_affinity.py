"""Affinity matrices: what normalising and temperature do, and files that come and go."""

import json

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.shelf.affinity import (
    AffinityMatrix,
    Origin,
    affinity_from_scores,
    even_rows,
    load_affinity,
)

NAMES = ("tea", "salt", "rice", "soap")
ORIGIN = Origin("a model", "the {X} goes next to the", "1", "2026-01-02")


@pytest.fixture
def scores():
    return np.random.default_rng(0).random((4, 4)) + 0.05


def test_rows_add_up_to_one_without_a_diagonal(scores):
    rows = affinity_from_scores(NAMES, scores, ORIGIN).rows
    np.testing.assert_allclose(rows.sum(axis=1), 1.0)
    np.testing.assert_array_equal(np.diag(rows), 0.0)


def test_neither_frequent_words_nor_the_diagonal_matter(scores):
    plain = affinity_from_scores(NAMES, scores, ORIGIN).rows
    frequent = scores * np.array([1.0, 50.0, 0.1, 1.0])
    np.fill_diagonal(frequent, 9.0)
    np.testing.assert_allclose(affinity_from_scores(NAMES, frequent, ORIGIN).rows, plain)


def test_temperature_one_changes_nothing_and_a_high_one_evens_out(scores):
    matrix = affinity_from_scores(NAMES, scores, ORIGIN)
    np.testing.assert_allclose(matrix.tempered(1.0).rows, matrix.rows)
    np.testing.assert_allclose(matrix.tempered(1e9).rows, even_rows(4), atol=1e-6)
    cold = matrix.tempered(0.01).rows
    np.testing.assert_array_equal(cold.argmax(axis=1), matrix.rows.argmax(axis=1))
    assert cold.max(axis=1).min() > 0.9
    np.testing.assert_allclose(matrix.tempered(2.0).tempered(3.0).rows, matrix.tempered(6.0).rows)
    with pytest.raises(InputError, match="temperature: got 0"):
        matrix.tempered(0.0)


def test_mixing_goes_from_even_to_the_matrix(scores):
    matrix = affinity_from_scores(NAMES, scores, ORIGIN)
    np.testing.assert_allclose(matrix.mixed(1.0).rows, matrix.rows)
    np.testing.assert_allclose(matrix.mixed(0.0).rows, even_rows(4))
    np.testing.assert_allclose(matrix.mixed(0.3).rows.sum(axis=1), 1.0)


def test_a_matrix_comes_back_from_its_file(tmp_path, scores):
    matrix = affinity_from_scores(NAMES, scores, ORIGIN)
    matrix.save(tmp_path / "m.json")
    again = load_affinity(tmp_path / "m.json")
    assert (again.names, again.origin) == (NAMES, ORIGIN)
    np.testing.assert_allclose(again.rows, matrix.rows, atol=1e-8)


def written(tmp_path, **changes):
    content = {
        "format": 1, "model": "m", "prompt": "", "version": "", "date": "",
        "names": ["a", "b", "c"], "rows": [[0, 1, 1], [1, 0, 1], [1, 1, 0]],
    }  # fmt: skip
    path = tmp_path / "m.json"
    path.write_text(json.dumps(content | changes), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"names": ["a", "b"]}, "expected 2 values"),
        ({"rows": [[0, 1], [1, 0, 1], [1, 1, 0]]}, "expected 3 values"),
        ({"names": ["a", "b", "a"]}, "got one twice"),
        ({"rows": [[0, -1, 1], [1, 0, 1], [1, 1, 0]]}, "not negative"),
        ({"colour": 1}, "not an affinity matrix"),
    ],
)
def test_files_that_hold_no_matrix_are_refused(tmp_path, changes, words):
    with pytest.raises(InputError, match=words):
        load_affinity(written(tmp_path, **changes))


def test_a_missing_file_and_an_unknown_name_are_told_of(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        load_affinity(tmp_path / "none.json")
    matrix = AffinityMatrix(NAMES, even_rows(4), ORIGIN)
    with pytest.raises(InputError, match="did you mean 'salt'"):
        matrix.row("sald")
