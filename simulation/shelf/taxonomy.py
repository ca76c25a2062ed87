"""Domains: which objects there are, how large, and how a taxonomy sorts them.

A domain is a YAML file; three ship with the package. The taxonomy arranges scenes and scores
affinities. Nothing that searches may read it.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from executive.core.errors import InputError
from executive.core.registry import closest
from perception.shelf.types import Floats, Size

DOMAINS = Path(__file__).parent / "domains"

Range = tuple[Annotated[float, Field(gt=0.0, le=1.0)], Annotated[float, Field(gt=0.0, le=1.0)]]


class _Document(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ShelfObject(_Document):
    """One object of a domain.

    Attributes:
        name: What it is called, also on its label.
        brand: What else is printed on it.
        category: Path in the taxonomy, from the top; empty when it stands for itself.
        width_m: Smallest and largest width, before scaling.
        depth_m: Smallest and largest depth.
        height_m: Smallest and largest height.
    """

    name: str
    brand: str = ""
    category: tuple[str, ...] = ()
    width_m: Range
    depth_m: Range
    height_m: Range

    @model_validator(mode="after")
    def _ordered(self) -> "ShelfObject":
        for low, high in (self.width_m, self.depth_m, self.height_m):
            if low > high:
                raise ValueError(
                    f"sizes of {self.name!r}: got [{low}, {high}]; expected low <= high"
                )
        return self

    def draw_size(self, scale: float, rng: np.random.Generator) -> Size:
        """Draw a size [m] from the ranges, uniformly, times a scale."""
        ranges = np.array([self.width_m, self.depth_m, self.height_m])
        drawn = scale * (ranges[:, 0] + rng.random(3) * (ranges[:, 1] - ranges[:, 0]))
        return (float(drawn[0]), float(drawn[1]), float(drawn[2]))


class _DomainFile(_Document):
    format: Literal[1]
    domain: str
    about: str
    scale: Annotated[float, Field(gt=0.0, le=1.0)]
    objects: Annotated[tuple[ShelfObject, ...], Field(min_length=2)]

    @model_validator(mode="after")
    def _distinct(self) -> "_DomainFile":
        names = [thing.name for thing in self.objects]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"objects: got {', '.join(twice)} twice; expected different names")
        return self


@dataclass(frozen=True, slots=True)
class Domain:
    """All that can stand on a kind of shelf.

    Attributes:
        name: Name of the domain.
        about: What it is, and where its list is from.
        scale: Factor on sizes in simulation (thesis, section 7.2).
        objects: The objects.
    """

    name: str
    about: str
    scale: float
    objects: tuple[ShelfObject, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all objects, in the file's order."""
        return tuple(thing.name for thing in self.objects)


def known_domains() -> tuple[str, ...]:
    """Return the names of the domains that ship with the package."""
    return tuple(sorted(path.stem for path in DOMAINS.glob("*.yaml")))


def shipped_domain(name: str) -> Domain:
    """Return a domain that ships with the package.

    Raises:
        InputError: There is none of that name.
    """
    if name not in known_domains():
        raise InputError(f"unknown domain {name!r}; {closest(name, list(known_domains()))}")
    return read_domain(DOMAINS / f"{name}.yaml")


def read_domain(path: Path) -> Domain:
    """Read a domain from a YAML file.

    Raises:
        InputError: The file cannot be used; the message says what is wrong.
    """
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
        document = _DomainFile.model_validate(content)
    except OSError as error:
        message = f"{path}: cannot be read; got {error.strerror}; expected a YAML file"
        raise InputError(message) from error
    except (yaml.YAMLError, UnicodeDecodeError, ValidationError) as error:
        raise InputError(f"{path}: not a domain: {error}") from error
    return Domain(document.domain, document.about, document.scale, document.objects)


def taxonomy_affinity(domain: Domain) -> Floats:
    """Return the taxonomy's own affinities, for scoring and as an oracle.

    Objects of one category, the deepest of their paths, have the same affinity to each other, and
    rows add up to 1. The diagonal is kept, so an object without a category has all of its row on
    itself: the convention of the thesis's Table 7.1 (section 7.1).

    Returns:
        Shape (N, N), in the order of `Domain.names`.
    """
    keys = [thing.category or (thing.name,) for thing in domain.objects]
    same = np.array([[a == b for b in keys] for a in keys], dtype=np.float64)
    rows: Floats = same / same.sum(axis=1, keepdims=True)
    return rows
