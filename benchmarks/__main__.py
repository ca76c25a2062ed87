"""`python -m benchmarks [NAME|report]`: run a benchmark, or write docs/results.md from results."""

import argparse
import importlib
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from benchmarks.harness import Benchmark, hand_over
from benchmarks.report import write_page

BENCHMARKS = {
    "affinity": ("benchmarks.affinity", "what language models know of shelves, beside a taxonomy"),
    "detection": ("benchmarks.detection", "labelled products on shelves, by looks, text, company"),
    "motion": ("benchmarks.motion", "kinematics, collisions, plans and limits of the arms"),
    "campaigns": ("benchmarks.campaigns", "missions an hour, and overhead of campaigns"),
    "campaign-memory": ("benchmarks.campaign_memory", "10,000 missions in one campaign"),
    "faults": ("benchmarks.faults", "kills, full disks, damaged files: what they cost"),
    "service": ("benchmarks.service", "a cell flooded with requests; stops until the arms rest"),
    "resuming": ("benchmarks.resuming", "untangling missions that are killed and gone on with"),
    "beliefs": ("benchmarks.beliefs", "P(knotted), P(knot) and what to ask next, without images"),
    "certificates": ("benchmarks.certificates", "knotted or not, with proofs that are replayed"),
    "checking": ("benchmarks.checking", "check, lint and fmt: time over that of Python itself"),
    "cable-physics": ("benchmarks.cable_physics", "speed of the cable beside PyBullet; knots kept"),
    "ticks": ("benchmarks.ticks", "speed of ticks beside py_trees; cost of a recording"),
    "fuzz": ("benchmarks.fuzz", "random documents: faults, never tracebacks; valid trees run"),
    "foreign": ("benchmarks.foreign", "cables as renderers show them that training never saw"),
    "inspecting": (
        "benchmarks.inspecting",
        "an hour of recording in the page; cost of watching",
    ),
    "search": ("benchmarks.search", "searches of shelves: the thesis's, ours, and what could be"),
    "shelf-cell": ("benchmarks.shelf_cell", "searches among boxes with physics, as in Table 7.6"),
    "sight": ("benchmarks.sight", "the detector beside the classic mask and ends"),
    "crossings": ("benchmarks.crossings", "over and under at crossings, where it is known"),
    "knots": ("benchmarks.knots", "first knots found: loose, dense and fake, by four systems"),
    "moves": ("benchmarks.moves", "plans of moves on a cable, and whether they come true"),
    "tracing": ("benchmarks.tracing", "tracers on drawn scenes with exact truth"),
    "untangle": ("benchmarks.untangle", "the untangling mission by tier and policy: Table 4.2"),
}
# Benchmarks that take options besides; a wrong one is answered with all of them.
WITH_OPTIONS = {"faults", "search", "shelf-cell", "untangle"}


def main() -> None:
    """Parse, run, print; without a name, list."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("name", nargs="?", choices=[*sorted(BENCHMARKS), "report"])
    parser.add_argument("--quick", action="store_true", help="a minute or two, for a first look")
    parser.add_argument("--seed", type=int, default=0, help="first seed")
    parser.add_argument("--json", type=Path, help="also write the result document here")
    chosen, words = parser.parse_known_args()
    if words and chosen.name not in WITH_OPTIONS:
        parser.error(f"{chosen.name or 'the list'} takes no options of its own; got {words[0]}")
    if chosen.name is None:
        for name, (_, about) in sorted(BENCHMARKS.items()):
            print(f"{name:16} {about}")
    elif chosen.name == "report":
        print(write_page())
    else:
        _run(chosen.name, chosen.quick, chosen.seed, chosen.json, words)


def _run(name: str, quick: bool, seed: int, target: Path | None, words: Sequence[str] = ()) -> None:
    module, about = BENCHMARKS[name]
    run = importlib.import_module(module).run
    benchmark = Benchmark(about, partial(run, words=words) if words else run)
    rows = benchmark.run(quick, seed)
    if quick:
        print("quick run: these figures are not results")
    hand_over(name, seed, quick, rows, target)


if __name__ == "__main__":
    main()
