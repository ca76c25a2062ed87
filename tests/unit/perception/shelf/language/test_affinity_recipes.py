"""From scores to affinities: what normalising, averaging and both directions do."""

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.shelf.language.prompts import PROMPTS
from perception.shelf.language.recipes import (
    RECIPES,
    affinity_of,
    rows_with_own_diagonal,
    with_diagonal,
)
from perception.shelf.language.scores import PairScores, Source, load_scores

NAMES = ("tea", "salt", "rice", "soap", "foil")
SOURCE = Source("toy", "1", "MIT", "2026-01-02")


def asked(seed=0, source=SOURCE):
    logs = np.random.default_rng(seed).normal(-9.0, 2.0, (len(PROMPTS), 5, 5))
    return PairScores(NAMES, PROMPTS, logs, "log-probability", source)


def compared(seed=0):
    vectors = np.random.default_rng(seed).normal(size=(5, 3))
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    return PairScores(NAMES, ("",), (vectors @ vectors.T)[None], "cosine", SOURCE)


@pytest.mark.parametrize("recipe", RECIPES.values())
@pytest.mark.parametrize("parts", [[asked()], [compared()], [asked(), compared(), asked(1)]])
def test_rows_are_distributions_over_others(parts, recipe):
    rows = affinity_of(parts, recipe).rows
    np.testing.assert_allclose(rows.sum(axis=1), 1.0)
    np.testing.assert_array_equal(np.diag(rows), 0.0)


@pytest.mark.parametrize("recipe", RECIPES.values())
def test_neither_frequent_words_nor_the_diagonal_matter(recipe):
    part = asked()
    logs = part.scores + np.array([0.0, 6.0, -4.0, 1.0, 0.0])
    logs[:, range(5), range(5)] = 0.0
    frequent = PairScores(NAMES, PROMPTS, logs, part.kind, part.source)
    np.testing.assert_allclose(
        affinity_of([frequent], recipe).rows, affinity_of([part], recipe).rows
    )


def test_the_thesis_asks_its_own_prompt_alone():
    part = asked()
    changed = part.scores.copy()
    changed[1:] = 0.0
    other = PairScores(NAMES, PROMPTS, changed, part.kind, part.source)
    thesis = RECIPES["thesis"]
    np.testing.assert_array_equal(
        affinity_of([part], thesis).rows, affinity_of([other], thesis).rows
    )
    # Section 6.1: columns, then rows.
    free = np.exp(part.scores[0]) * (1.0 - np.eye(5))
    free /= free.sum(axis=0)
    np.testing.assert_allclose(
        affinity_of([part], thesis).rows, free / free.sum(axis=1, keepdims=True)
    )


def test_both_directions_of_a_pair_count_the_same():
    part = asked()
    turned = PairScores(NAMES, PROMPTS, part.scores.transpose(0, 2, 1), part.kind, part.source)
    rows = [affinity_of([one], RECIPES["symmetric"]).rows for one in (part, turned)]
    # Normalising columns first favours one direction a little; the order of neighbours stays.
    assert np.corrcoef(rows[0].ravel(), rows[1].ravel())[0, 1] > 0.9


def test_equal_parts_change_nothing():
    one = affinity_of([asked()], RECIPES["symmetric"]).rows
    three = affinity_of([asked()] * 3, RECIPES["symmetric"]).rows
    np.testing.assert_allclose(one, three)


def test_objects_come_in_the_order_that_is_asked_for():
    part = asked()
    turned = part.of_names(("foil", "tea"))
    np.testing.assert_array_equal(turned.scores[:, 0, 1], part.scores[:, 4, 0])
    with pytest.raises(InputError, match="unknown object 'sal'; did you mean 'salt'"):
        part.of_names(("tea", "sal"))


def test_an_object_goes_with_itself_as_well_as_with_its_best():
    rows = with_diagonal(affinity_of([asked()], RECIPES["thesis"]).rows)
    np.testing.assert_allclose(rows.sum(axis=1), 1.0)
    off = np.where(np.eye(5, dtype=bool), 0.0, rows)
    np.testing.assert_allclose(np.diag(rows), off.max(axis=1))


def test_own_diagonals_are_what_models_say_of_an_object_beside_itself():
    part = asked()
    logs = part.scores[:1]
    raw = np.exp(logs[0])
    raw /= raw.sum(axis=0)
    np.testing.assert_allclose(
        rows_with_own_diagonal([part], RECIPES["thesis"]), raw / raw.sum(axis=1, keepdims=True)
    )
    vectors = rows_with_own_diagonal([compared()], RECIPES["symmetric"])
    np.testing.assert_array_equal(vectors.argmax(axis=1), range(5))


def test_affinities_say_who_made_them():
    other = Source("tiny", "2", "Apache-2.0", "2026-02-03")
    origin = affinity_of([asked(), asked(1, other)], RECIPES["prompts"]).origin
    assert origin.model == "toy + tiny"
    assert (origin.version, origin.licence) == ("1; 2", "MIT; Apache-2.0")
    assert origin.date == "2026-02-03"
    assert origin.prompt.split(" | ") == [*PROMPTS]


def test_parts_must_fit():
    other = PairScores(NAMES[::-1], PROMPTS, asked().scores, "log-probability", SOURCE)
    with pytest.raises(InputError, match="different objects"):
        affinity_of([asked(), other], RECIPES["prompts"])
    with pytest.raises(InputError, match="got no scores"):
        affinity_of([], RECIPES["prompts"])
    own = PairScores(NAMES, ("{X}!",), asked().scores[:1], "log-probability", SOURCE)
    with pytest.raises(InputError, match="was not asked 'In a shelf"):
        affinity_of([own], RECIPES["thesis"])


def test_scores_come_back_from_their_file(tmp_path):
    part = asked()
    part.save(tmp_path / "s.json")
    again = load_scores(tmp_path / "s.json")
    assert (again.names, again.prompts, again.kind) == (NAMES, PROMPTS, part.kind)
    assert again.source == SOURCE
    np.testing.assert_allclose(again.scores, part.scores, atol=1e-4)


def test_files_that_are_no_scores_are_told_of(tmp_path):
    path = tmp_path / "s.json"
    with pytest.raises(InputError, match="cannot be read"):
        load_scores(path)
    asked().save(path)
    text = path.read_text()
    path.write_text(text.replace('"format": 1', '"format": 2'))
    with pytest.raises(InputError, match="not scores of pairs"):
        load_scores(path)
    path.write_text(text.replace('"foil"', '"foil", "wrap"'))
    with pytest.raises(InputError, match="expected 6 x 6 x 6 values"):
        load_scores(path)
