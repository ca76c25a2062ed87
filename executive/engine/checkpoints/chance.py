"""The states of random generators as JSON: numbers as words, longer than most readers take."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from pydantic import JsonValue


def generator_words(generator: np.random.Generator) -> JsonValue:
    """Return the state of a generator."""
    return _words(generator.bit_generator.state)


def generator_state(words: JsonValue) -> Any:
    """Return the state to give to a bit generator."""
    if isinstance(words, Mapping):
        return {key: generator_state(value) for key, value in words.items()}
    if isinstance(words, list):
        return np.array([int(str(value)) for value in words], np.uint64)
    text = str(words)
    return int(text) if text.isdecimal() else text


def _words(state: object) -> JsonValue:
    if isinstance(state, Mapping):
        return {str(key): _words(value) for key, value in state.items()}
    if isinstance(state, np.ndarray):
        return [_words(value) for value in state.tolist()]
    return str(state)
