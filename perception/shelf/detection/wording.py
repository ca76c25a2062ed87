"""What an object may be by the text on it: P(C | T) of the thesis's section 6.2.

Names and brands are looked for in what was read by local alignment (T. F. Smith and M. S. Waterman,
J. Mol. Biol. 1981): letters that agree count one, letters that do not or are missing cost one. So
what is half hidden still counts by the half that is read.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.shelf.types import Floats

# Weight of one more letter that agrees, as a logarithm of odds.
PER_LETTER = 1.2
# Any text shares so many letters in a row with some name.
BY_CHANCE = 2.0
# Text that says nothing of a product: its share of each reading.
IDLE = 0.02
# What is unknown is this likely before anything is read, beside one product.
UNKNOWN = 0.5
# Letters of a title that no product accounts for speak for an unknown one, beyond a few.
SPARE_LETTERS = 2
MOST_STRANGE = 6
# Letters and digits that readers take for each other are one.
_ALIKE = str.maketrans({"0": "o", "1": "l", "i": "l", "5": "s", "8": "b"})
_PADDING = 0


@dataclass(frozen=True, slots=True)
class Wording:
    """What is printed on a product.

    Attributes:
        name: Its name.
        brand: Its brand; empty where it has none.
    """

    name: str
    brand: str = ""


class TextModel:
    """Tells products by text."""

    def __init__(self, wordings: Sequence[Wording]) -> None:
        """Take what is printed on the products, N of them."""
        self._names = _codes([wording.name for wording in wordings])
        lengths = (self._names != _PADDING).sum(axis=1)
        self._surplus = np.maximum(lengths - BY_CHANCE, 1.0)
        # A brand that is the name would count twice.
        self._brands = _codes(
            [
                "" if plain(wording.brand) == plain(wording.name) else wording.brand
                for wording in wordings
            ]
        )

    def probabilities(self, text: str, title: str | None = None) -> Floats:
        """Return P(product | text) and, last, P(none of them | text), shape (N + 1,).

        Args:
            text: All that was read on an object.
            title: The part of it in large letters; None for all.
        """
        letters = _code(text)
        names, brands = _aligned(letters, self._names), _aligned(letters, self._brands)
        agreeing = np.maximum(names - BY_CHANCE, 0.0) + np.maximum(brands - BY_CHANCE, 0.0)
        size = len(plain(text if title is None else title))
        spare = size - float((names + brands).max()) - SPARE_LETTERS
        # Beside a name that is there as a whole, what else is written is print.
        lacking = 1.0 - min(1.0, float((np.maximum(names - BY_CHANCE, 0.0) / self._surplus).max()))
        strange = lacking * float(np.clip(spare, 0.0, MOST_STRANGE))
        logits = PER_LETTER * np.append(agreeing, strange)
        logits[-1] += np.log(UNKNOWN)
        powers = np.exp(logits - logits.max())
        read = powers / powers.sum()
        even = np.append(np.ones(len(agreeing)), UNKNOWN)
        mixed: Floats = (1.0 - IDLE) * read + IDLE * even / even.sum()
        return mixed


def plain(text: str) -> str:
    """Return the letters and digits of a text, lower case, with those that look alike made one."""
    return re.sub(r"[^a-z0-9]", "", text.lower()).translate(_ALIKE)


def agreeing_letters(text: str, words: Sequence[str]) -> Floats:
    """Return how well each word is found in a text, in letters, shape (words,)."""
    return _aligned(_code(text), _codes(words))


def _aligned(letters: NDArray[np.int64], words: NDArray[np.int64]) -> Floats:
    """Return the best local alignment of each word with a text."""
    count, longest = words.shape
    before = np.zeros((count, longest + 1))
    best = np.zeros(count)
    for letter in letters.tolist():
        row = np.zeros((count, longest + 1))
        agree = np.where(words == letter, 1.0, -1.0)
        agree[words == _PADDING] = -np.inf
        for at in range(1, longest + 1):
            paired = before[:, at - 1] + agree[:, at - 1]
            left_out = np.maximum(before[:, at], row[:, at - 1]) - 1.0
            row[:, at] = np.maximum(np.maximum(paired, left_out), 0.0)
        best = np.maximum(best, row.max(axis=1))
        before = row
    return best


def _code(text: str) -> NDArray[np.int64]:
    return np.array([ord(letter) for letter in plain(text)], dtype=np.int64)


def _codes(words: Sequence[str]) -> NDArray[np.int64]:
    longest = max((len(plain(word)) for word in words), default=0)
    rows = np.full((len(words), max(longest, 1)), _PADDING, dtype=np.int64)
    for row, word in zip(rows, words, strict=True):
        letters = _code(word)
        row[: len(letters)] = letters
    return rows
