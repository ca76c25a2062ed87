"""Language models behind an address: servers that speak OpenAI's completions protocol.

A whole text is sent back (`echo`) with the log-probability of each of its tokens; those of the
prompt are left out. Servers that give no log-probabilities of what they were sent cannot score.
"""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import accumulate
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError

from executive.core.errors import InputError
from executive.core.json_files import faults_of
from perception.shelf.language.scores import Source
from perception.shelf.types import Floats

KEY_VARIABLE = "CELLWRIGHT_ENDPOINT_KEY"


class _Logprobs(BaseModel):
    model_config = ConfigDict(frozen=True)

    tokens: tuple[str, ...]
    token_logprobs: tuple[float | None, ...]
    text_offset: tuple[int, ...] | None = None


class _Choice(BaseModel):
    model_config = ConfigDict(frozen=True)

    index: int
    logprobs: _Logprobs | None = None


class _Answer(BaseModel):
    model_config = ConfigDict(frozen=True)

    choices: tuple[_Choice, ...]


@dataclass(frozen=True, slots=True)
class EndpointModel:
    """A model that a server runs.

    Attributes:
        address: Up to and with the version, `http://localhost:8000/v1`.
        model: Name of the model there.
        timeout_s: Longest wait for one answer.
        day: Day for the record, ISO 8601.
    """

    address: str
    model: str
    timeout_s: float = 120.0
    day: str = field(default_factory=lambda: datetime.now(UTC).date().isoformat())

    @property
    def source(self) -> Source:
        """The model and its address; its terms are those of who runs it."""
        return Source(self.model, self.address, "as its provider says", self.day)

    def log_probabilities(self, prompt: str, words: Sequence[str]) -> Floats:
        """Return log P(word | prompt) of whole words, natural, shape (words,).

        Raises:
            InputError: The server does not answer, refuses, or gives no log-probabilities.
        """
        body = {
            "model": self.model,
            "prompt": [f"{prompt} {word}" for word in words],
            "max_tokens": 1,
            "temperature": 0,
            "echo": True,
            "logprobs": 1,
        }
        choices = sorted(self._ask(body).choices, key=lambda choice: choice.index)
        if len(choices) != len(words):
            raise InputError(
                f"{self.address}: got {len(choices)} answers; expected one for each of "
                f"{len(words)} prompts"
            )
        pairs = zip(choices, words, strict=True)
        return np.array([self._sum(choice, prompt, word) for choice, word in pairs])

    def _ask(self, body: Mapping[str, object]) -> _Answer:
        try:
            return _Answer.model_validate(self._post(body))
        except ValidationError as error:
            raise InputError(
                f"{self.address}: not an answer of a completions server: {faults_of(error)}"
            ) from error

    def _post(self, body: Mapping[str, object]) -> Any:
        url = f"{self.address.rstrip('/')}/completions"
        headers = {"Content-Type": "application/json"}
        if key := os.environ.get(KEY_VARIABLE):
            headers["Authorization"] = f"Bearer {key}"
        request = Request(url, json.dumps(body).encode(), headers)
        try:
            with urlopen(request, timeout=self.timeout_s) as answer:
                return json.loads(answer.read())
        except HTTPError as error:
            said = error.read()[:300].decode(errors="replace").strip()
            raise InputError(
                f"{url}: refused; got HTTP {error.code}: {said or error.reason}; expected 200; "
                f"try another --served-model, or a key in {KEY_VARIABLE}"
            ) from error
        except (URLError, TimeoutError, OSError) as error:
            reason = getattr(error, "reason", error)
            raise InputError(
                f"{url}: no answer: {reason}; try: start the server, or mend the address"
            ) from error
        except ValueError as error:
            raise InputError(f"{url}: not JSON: {error}") from error

    def _sum(self, choice: _Choice, prompt: str, word: str) -> float:
        """Add up the tokens of a word, without the prompt's and without what was made up after."""
        told = choice.logprobs
        if told is None or not told.tokens or len(told.tokens) != len(told.token_logprobs):
            raise InputError(
                f"{self.address}: no log-probabilities of the prompt; expected "
                f"choices[].logprobs.token_logprobs, as echo and logprobs ask for; "
                f"try a server that scores prompts, vLLM for one"
            )
        starts = told.text_offset or _offsets(told.tokens)
        begin, end = len(prompt), len(prompt) + 1 + len(word)
        # A token belongs to the word when some of it lies behind the prompt.
        return sum(
            log
            for token, start, log in zip(told.tokens, starts, told.token_logprobs, strict=True)
            if log is not None and begin < start + len(token) and start < end
        )


def _offsets(tokens: Sequence[str]) -> tuple[int, ...]:
    """Return where tokens begin in the text that they make up."""
    return tuple(accumulate((len(token) for token in tokens[:-1]), initial=0))
