"""Which settings a campaign runs its mission with, and with which seeds."""

import itertools
import json
import math
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import JsonValue

from executive.app.campaigns.document import CampaignDocument, Draw, Sample
from executive.app.campaigns.jobs import Job


@dataclass(frozen=True, slots=True)
class Variant:
    """One set of settings.

    Attributes:
        number: Its place in the campaign.
        settings: Values by key.
    """

    number: int
    settings: Mapping[str, JsonValue]

    def __str__(self) -> str:
        """Return the settings in one line."""
        return ", ".join(f"{key}={json.dumps(value)}" for key, value in self.settings.items())


def variants(document: CampaignDocument) -> list[Variant]:
    """Return the variants of a campaign: every combination of grid, sample and list.

    What only some of them set stands in the others too where the document sets it for all.
    """
    axes = [[{key: value} for value in values] for key, values in document.grid.items()]
    drawn = _drawn(document.sample) if document.sample else [{}]
    listed: Sequence[Mapping[str, JsonValue]] = document.list_ or [{}]
    combined = itertools.product(listed, drawn, *axes)
    return [
        Variant(number, {**document.set_, **{k: v for part in parts for k, v in part.items()}})
        for number, parts in enumerate(combined)
    ]


def jobs(document: CampaignDocument) -> Iterator[Job]:
    """Yield the runs of a campaign: seed by seed, so that early figures know every variant."""
    found = variants(document)
    for seed in document.all_seeds:
        for one in found:
            name = f"v{one.number:03d}_s{seed}"
            yield Job(name=name, variant=one.number, seed=seed, settings=dict(one.settings))


def _drawn(sample: Sample) -> list[dict[str, JsonValue]]:
    # A stream a key: another key in the document changes no draw of this one.
    columns = {
        key: _column(draw, np.random.default_rng([sample.seed, zlib.crc32(key.encode())]), sample)
        for key, draw in sample.of.items()
    }
    return [{key: column[row] for key, column in columns.items()} for row in range(sample.count)]


def _column(draw: Draw, rng: np.random.Generator, sample: Sample) -> list[JsonValue]:
    count = sample.count
    if draw.uniform is not None:
        return [float(value) for value in rng.uniform(*draw.uniform, count)]
    if draw.log_uniform is not None:
        low, high = map(math.log, draw.log_uniform)
        return [math.exp(value) for value in rng.uniform(low, high, count)]
    if draw.integers is not None:
        return [int(value) for value in rng.integers(*draw.integers, count, endpoint=True)]
    assert draw.choice is not None
    return [draw.choice[place] for place in rng.integers(len(draw.choice), size=count)]
