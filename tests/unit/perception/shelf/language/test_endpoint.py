"""Language models behind an address, asked over a real socket."""

import numpy as np
import pytest
from completions_server import completions_server, scores, tokens_of, word_log

from executive.core.errors import InputError
from perception.shelf.language.endpoint import KEY_VARIABLE, EndpointModel
from perception.shelf.language.picking import Wanted, provider_of

PROMPT = "In a shelf, the tea goes next to the"
WORDS = ("salt", "ground coffee", "black pepper mill")


def expected(prompt, word):
    before, total = prompt, 0.0
    for token in tokens_of(f" {word}")[1:]:
        total += word_log(before, token)
        before += token
    return total


def test_the_tokens_of_a_word_count_and_nothing_before_or_after_them():
    with completions_server() as (address, _):
        got = EndpointModel(address, "toy").log_probabilities(PROMPT, WORDS)
    np.testing.assert_allclose(got, [expected(PROMPT, word) for word in WORDS])


def test_offsets_win_over_lengths_of_tokens():
    def marked(body):
        status, answer = scores(body)
        for choice in answer["choices"]:
            told = choice["logprobs"]
            lengths = [len(token) for token in told["tokens"]]
            told["text_offset"] = [0, *np.cumsum([0, *lengths[:-1]]).tolist()]
            told["tokens"] = ["<begin of text>", *told["tokens"]]
            told["token_logprobs"] = [None, *told["token_logprobs"]]
        return status, answer

    with completions_server(marked) as (address, _):
        got = EndpointModel(address, "toy").log_probabilities(PROMPT, WORDS)
    np.testing.assert_allclose(got, [expected(PROMPT, word) for word in WORDS])


def test_a_provider_asks_every_prompt_of_every_object(monkeypatch):
    monkeypatch.setenv(KEY_VARIABLE, "secret")
    wanted = Wanted(("the {X} beside the", "{X} and"), served_model="toy")
    with completions_server() as (address, asked), provider_of(address, wanted) as provider:
        answer = provider.score(("tea", "salt", "rice"))
    assert answer.scores.shape == (2, 3, 3)
    assert answer.scores[1, 0, 2] == pytest.approx(expected("tea and", "rice"))
    assert (answer.source.model, answer.source.version) == ("toy", address)
    assert {path for path, _, _ in asked} == {"/v1/completions"}
    assert {key for _, _, key in asked} == {"Bearer secret"}
    assert all(body["echo"] and body["model"] == "toy" for _, body, _ in asked)


def silent(body):
    return 200, {"choices": [{"index": i, "text": t} for i, t in enumerate(body["prompt"])]}


@pytest.mark.parametrize(
    ("reply", "words"),
    [
        (silent, "no log-probabilities of the prompt"),
        (lambda _: (404, {"error": "no model toy"}), "got HTTP 404.*no model toy.*--served-model"),
        (lambda _: (200, b"<html>"), "not JSON"),
        (lambda _: (200, {"choices": "none"}), "not an answer of a completions server"),
        (lambda _: (200, {"choices": []}), "got 0 answers; expected one for each of 3"),
    ],
)
def test_servers_that_cannot_score_are_told_of(reply, words):
    with completions_server(reply) as (address, _), pytest.raises(InputError, match=words):
        EndpointModel(address, "toy").log_probabilities(PROMPT, WORDS)


def test_a_server_that_is_down_is_told_of():
    with completions_server() as (address, _):
        pass
    with pytest.raises(InputError, match=r"no answer: .*start the server"):
        EndpointModel(address, "toy").log_probabilities(PROMPT, WORDS)


def test_an_address_needs_the_name_of_a_model():
    with pytest.raises(InputError, match="try --served-model NAME"), provider_of("http://x/v1"):
        pass
