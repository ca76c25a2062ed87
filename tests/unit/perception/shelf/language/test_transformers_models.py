"""Causal models and embedders of transformers; only where that library is installed."""

import json

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.shelf.language.scores import Source
from perception.shelf.language.transformers_models import (
    CausalModel,
    ModelFiles,
    SentenceEmbedder,
)

pytest.importorskip("transformers")
torch = pytest.importorskip("torch")

SOURCE = Source("tiny", "1", "MIT", "2026-01-02")
WORDS = ("tea", "tea bags", "salt", "black pepper mill")


def tiny(kind, words):
    """Return a random model of a few hundred weights, with the parts that its family has."""
    from transformers import (
        Gemma3ForCausalLM,
        Gemma3TextConfig,
        LlamaConfig,
        LlamaForCausalLM,
    )

    size = {
        "vocab_size": words, "hidden_size": 16, "intermediate_size": 32, "num_hidden_layers": 2,
        "num_attention_heads": 2, "num_key_value_heads": 1, "initializer_range": 0.5,
    }  # fmt: skip
    torch.manual_seed(0)
    if kind == "llama":
        return LlamaForCausalLM(LlamaConfig(**size))
    return Gemma3ForCausalLM(Gemma3TextConfig(**size, head_dim=8, sliding_window=8))


@pytest.fixture(scope="module", params=["llama", "gemma"])
def folder(request, tmp_path_factory):
    """A tiny model, with a tokenizer that cuts words into letters."""
    from tokenizers import Tokenizer, decoders, models, pre_tokenizers
    from transformers import PreTrainedTokenizerFast

    path = tmp_path_factory.mktemp(request.param)
    vocabulary = {letter: at for at, letter in enumerate("_<abcdefghijklmnopqrstuvwxyz,")}
    tokenizer = Tokenizer(models.BPE(vocabulary, [], unk_token="<"))
    tokenizer.pre_tokenizer = pre_tokenizers.Metaspace(replacement="_", prepend_scheme="never")
    tokenizer.decoder = decoders.Metaspace(replacement="_")
    fast = PreTrainedTokenizerFast(tokenizer_object=tokenizer, unk_token="<", pad_token="<")
    fast.save_pretrained(path)
    tiny(request.param, len(vocabulary)).save_pretrained(path)
    return path


def test_keeping_keys_and_values_changes_no_probability(folder):
    model = CausalModel(ModelFiles(folder), SOURCE)
    prompt = "the rice goes next to the"
    got = model.log_probabilities(prompt, WORDS)

    def naive(word):
        begin, text = model._tokens(prompt), model._tokens(f"{prompt} {word}")
        with torch.inference_mode():
            logs = torch.log_softmax(model._model(torch.tensor([text])).logits[0].double(), -1)
        return sum(float(logs[at - 1, text[at]]) for at in range(len(begin), len(text)))

    np.testing.assert_allclose(got, [naive(word) for word in WORDS], atol=1e-4)


def test_a_word_that_goes_on_is_less_likely(folder):
    model = CausalModel(ModelFiles(folder), SOURCE)
    tea, bags, *_ = model.log_probabilities("rice,", WORDS)
    assert bags < tea < 0.0


def test_vectors_have_length_one_whatever_else_is_in_the_batch(folder):
    embedder = SentenceEmbedder(ModelFiles(folder), SOURCE)
    vectors = embedder.embed(WORDS)
    np.testing.assert_allclose(np.linalg.norm(vectors, axis=1), 1.0)
    # The tiny model is causal, and its texts are padded behind: nothing may leak from there.
    np.testing.assert_allclose(embedder.embed(WORDS[:1])[0], vectors[0], atol=1e-5)


def test_a_folder_that_holds_no_model_is_told_of(tmp_path):
    (tmp_path / "config.json").write_text(json.dumps({"model_type": "none"}))
    with pytest.raises(InputError, match=r"not a model that transformers .* loads"):
        CausalModel(ModelFiles(tmp_path), SOURCE)
