"""A bench with cable ends to plug in, seen through a camera: what the worked story is about.

A picture shows the table as it was, and a grasp closes on what is there now. So a tree that acts
on an old picture misses, for no other reason.
"""

from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np
from toy_pasts import past

from executive.core.outcome import failure, success
from executive.core.registry import Registry
from executive.core.skill import In, Port, Skill, SkillRun
from perception.cable.types import Endpoint

WIDTH_PX, HEIGHT_PX, REACH_PX = 320, 200, 5.0
TABLE, CABLE = 60, 210


@dataclass(frozen=True, eq=False)
class Picture:
    """What the camera saw, and the how many-th picture it is."""

    image: np.ndarray
    number: int


@dataclass
class Bench:
    """Cables come in from the left; each one's end is given as (x, y) [px]."""

    ends: list = field(default_factory=lambda: [(140, 40), (190, 80), (120, 120), (170, 160)])
    pictures: int = 0

    def picture(self):
        """Return what is on the table now."""
        image = np.full((HEIGHT_PX, WIDTH_PX), TABLE, np.uint8)
        for x, y in self.ends:
            image[y - 2 : y + 3, :x] = CABLE
        self.pictures += 1
        return Picture(image, self.pictures)

    def end_near(self, point_px):
        """Return the end within reach of a point, None where there is none."""
        near = (end for end in self.ends if np.hypot(*np.subtract(end, point_px)) < REACH_PX)
        return next(near, None)


class Look(Skill):
    """Take a picture."""

    OUT: ClassVar = {"picture": Port(Picture, "what the camera saw")}

    def __init__(self, bench: Bench) -> None:
        self._bench = bench

    def run(self) -> SkillRun:
        yield
        return success(picture=self._bench.picture())


class FindEnd(Skill):
    """Find the topmost end of a cable in a picture."""

    OUT: ClassVar = {"end": Port(Endpoint, "where it is")}
    REASONS: ClassVar = frozenset({"end.none"})

    def run(self, picture: Annotated[Picture, In("what to search")]) -> SkillRun:
        yield from ()
        rows, columns = np.nonzero(picture.image == CABLE)
        if not len(rows):
            return failure("end.none", "the picture shows no cable")
        top = rows[0] + 2
        tip = float(columns[rows == top].max() + 1)
        return success(end=Endpoint(np.array([tip, float(top)]), np.array([1.0, 0.0]), 0.98))


class GraspEnd(Skill):
    """Close the fingers at an end."""

    REASONS: ClassVar = frozenset({"grasp.missed"})
    ACTS = True

    def __init__(self, bench: Bench) -> None:
        self._bench = bench

    def run(self, end: Annotated[Endpoint, In("where")]) -> SkillRun:
        yield
        yield
        if self._bench.end_near(end.position_px) is None:
            x, y = end.position_px
            return failure("grasp.missed", f"the fingers closed on nothing at ({x:.0f}, {y:.0f})")
        return success()


class PlugIn(Skill):
    """Plug in what is held; the end is gone from the table then."""

    ACTS = True

    def __init__(self, bench: Bench) -> None:
        self._bench = bench

    def run(self, end: Annotated[Endpoint, In("which")]) -> SkillRun:
        yield
        yield
        self._bench.ends.remove(self._bench.end_near(end.position_px))
        return success()


def run_bench(folder, root, name):
    """Run a tree on a fresh bench and record it as `name`."""
    skills = Registry("skill")
    for key, skill in (
        *(("look", Look), ("find_end", FindEnd)),
        *(("grasp_end", GraspEnd), ("plug_in", PlugIn)),
    ):
        skills.add(key, skill)
    return past(
        folder, root, {}, name=name, mission="harness", skills=skills, devices={"bench": Bench()}
    )
