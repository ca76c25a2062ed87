"""Names of BehaviorTree.CPP as names of ours: `ComputePathToPose` is `compute_path_to_pose`."""

import keyword
import re
import unicodedata
from typing import Final

from executive.engine.language.evaluation import CONSTANTS, WRITTEN

_RESERVED: Final = frozenset({*keyword.kwlist, *keyword.softkwlist, *CONSTANTS, WRITTEN})
_WORD_ENDS: Final = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def our_name(text: str) -> str:
    """Return the nearest name that our language has, empty where nothing is left of it."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    words = re.sub(r"[^A-Za-z0-9]+", "_", _WORD_ENDS.sub("_", plain)).lower().strip("_")
    if words[:1].isdigit():
        words = f"n_{words}"
    return f"{words}_" if words in _RESERVED else words


class Namer:
    """Gives each foreign name one of ours, and no two the same."""

    def __init__(self, otherwise: str) -> None:
        """Call what has no letter in it `otherwise`."""
        self._otherwise = otherwise
        self._given: dict[str, str] = {}
        self._taken: set[str] = set()

    def __call__(self, text: str) -> str:
        """Return our name for a foreign one."""
        if text not in self._given:
            self._given[text] = self.fresh(our_name(text) or self._otherwise)
        return self._given[text]

    def fresh(self, wanted: str) -> str:
        """Return a name that nothing has, `wanted` if it is free."""
        name, number = wanted, 1
        while name in self._taken:
            number += 1
            name = f"{wanted}_{number}"
        self._taken.add(name)
        return name
