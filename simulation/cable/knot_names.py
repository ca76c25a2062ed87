"""Names of the knots and the tiers that cables can be laid with; light to import."""

from typing import Literal, get_args

KnotName = Literal[
    "none",
    "overhand",
    "figure_8",
    "overhand_honda",
    "bowline",
    "linked_overhand",
    "figure_8_honda",
]
KNOT_NAMES: tuple[KnotName, ...] = get_args(KnotName)

# What ties two cables together.
PairName = Literal["square", "carrick_bend", "sheet_bend"]
PAIR_NAMES: tuple[PairName, ...] = get_args(PairName)

TierName = Literal["C1", "C2", "C3"]
TIER_NAMES: tuple[TierName, ...] = get_args(TierName)
