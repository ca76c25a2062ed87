"""Signed Gauss codes, as text."""

from collections.abc import Sequence

from perception.cable.topology import StrandCrossing


def gauss_code(crossings: Sequence[StrandCrossing], ends: Sequence[float] = ()) -> str:
    """Return the code of open curves: O or U, number and sign of the crossing at each visit.

    Crossings are numbered from 1 as they are met. One is positive when the upper strand turns
    counter-clockwise onto the lower one.

    Args:
        crossings: Where the curves cross.
        ends: Where along all of them one ends and the next begins; their codes are parted
            by a stroke.
    """
    visits = sorted(
        (arc, k, on_top)
        for k, c in enumerate(crossings)
        for arc, on_top in ((c.first, c.first_over), (c.second, not c.first_over))
    )
    numbers: dict[int, int] = {}
    words, left = [], list(ends)
    for arc, k, on_top in visits:
        while left and arc > left[0]:
            words.append("/")
            del left[0]
        number = numbers.setdefault(k, len(numbers) + 1)
        sign = "+" if _sign(crossings[k]) > 0 else "-"
        words.append(f"{'O' if on_top else 'U'}{number}{sign}")
    return " ".join(words)


def _sign(crossing: StrandCrossing) -> int:
    return crossing.turn if crossing.first_over else -crossing.turn
