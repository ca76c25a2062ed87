"""Documents put together at random: valid trees run, any others give faults and no traceback."""

import contextlib
import json
import tempfile
import time
import traceback
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

import yaml
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from benchmarks.harness import Row
from benchmarks.random_documents import ANYTHING, INNER, ROOTS, WORDS, Node, document, spoiled
from executive.core.clock import ManualClock
from executive.core.errors import InputError
from executive.core.outcome import failure, success
from executive.core.registry import Registry
from executive.core.skill import Port, Skill, SkillRun
from executive.engine.language.sources import read_source
from executive.engine.loading.loader import Program, load_program
from executive.engine.loading.validation import validate
from executive.engine.nodes.builder import build
from executive.engine.running.probe import TreeProbe

CASES, QUICK_CASES = 100_000, 2_000
TICKS, PERIOD_S = 8, 0.1
MAX_SHOWN = 5


@dataclass(slots=True)
class Log:
    """What skills did.

    Attributes:
        starts: How often one was started.
        ends: How often one came to its end, or was stopped.
    """

    starts: int = 0
    ends: int = 0


class Find(Skill):
    """Find a part."""

    OUT: ClassVar = {"part": Port(str), "distance": Port(float, unit="m")}

    def run(self) -> SkillRun:
        """Answer in the second tick."""
        yield
        return success(part="nut", distance=2.0)


class Work(Skill):
    """Answer after some ticks."""

    OUT: ClassVar = {"label": Port(str)}
    REASONS: ClassVar = frozenset({"work.failed"})

    def __init__(self, log: Log) -> None:
        """Note everything in a log."""
        self._log, self._rounds = log, 0

    def run(self, label: str, ticks: int = 1, fails: int = 0) -> SkillRun:
        """Fail the first few times."""
        self._log.starts += 1
        for _ in range(ticks - 1):
            yield
        self._log.ends += 1
        self._rounds += 1
        return failure("work.failed") if self._rounds <= fails else success(label=label)

    def stop(self) -> None:
        """Note it."""
        self._log.ends += 1


@dataclass(slots=True)
class Bench:
    """Where documents are tried, and what came of them.

    Attributes:
        folder: Folder with `inner.yaml`.
        cases: Documents that were tried.
        valid: Those that were meant to be valid.
        refused: Spoiled ones that gave faults.
        tracebacks: What was raised that is no fault.
        broken: Valid ones that were refused, changed on their way through YAML, or left a skill
            running or stopped it twice.
    """

    folder: Path
    cases: int = 0
    valid: int = 0
    refused: int = 0
    tracebacks: list[str] = field(default_factory=list)
    broken: list[str] = field(default_factory=list)
    skills: Registry[type[Skill]] = field(default_factory=lambda: Registry("skill"))
    types: Registry[type] = field(default_factory=lambda: Registry("port type"))

    def __post_init__(self) -> None:
        """Write the subtree that the trees use."""
        (self.folder / "inner.yaml").write_text(INNER, encoding="utf-8")
        self.skills.add("find", Find)
        self.skills.add("work", Work)

    def load(self, text: str) -> Program:
        """Load a document.

        Raises:
            InputError: It has faults.
        """
        file = self.folder / "t.yaml"
        file.write_text(text, encoding="utf-8", errors="surrogateescape")
        return load_program(file, skills=self.skills, types=self.types)

    def try_valid(self, root: Node) -> None:
        """Load, build, tick and stop a tree that is meant to be valid."""
        self.cases += 1
        self.valid += 1
        with self._watching(json.dumps(root)):
            if problem := _round_trip(root) or self._ticked(root):
                self.broken.append(f"{problem}: {json.dumps(root)}")

    def try_spoiled(self, text: str) -> None:
        """Load a document that may be anything; build it if it turns out to be valid."""
        self.cases += 1
        with self._watching(text):
            try:
                program = self.load(text)
            except InputError:
                self.refused += 1
                return
            with contextlib.suppress(InputError):  # an input that is needed
                build(program, devices={"log": Log()}, clock=ManualClock())

    def _ticked(self, root: Node) -> str:
        """Return what went wrong with a valid tree."""
        try:
            program = self.load(json.dumps(document(root)))
        except InputError as fault:
            return f"refused: {fault}"
        log, clock = Log(), ManualClock()
        tree = build(program, devices={"log": log}, clock=clock, seed=1)
        probe = TreeProbe(tree)
        for number in range(TICKS):
            _, error = probe.tick(number, clock.now_s())
            if error is not None:
                raise error
            clock.sleep_until(clock.now_s() + PERIOD_S)
        for _ in range(2):
            tree.root.stop(tree.root.status.INVALID)
        return "" if log.starts == log.ends else f"{log.starts} starts, {log.ends} ends"

    @contextlib.contextmanager
    def _watching(self, what: str) -> Iterator[None]:
        try:
            yield
        except Exception:
            self.tracebacks.append(f"{what}\n{traceback.format_exc()}")


def _round_trip(root: Node) -> str:
    """Return how a tree has changed on its way through YAML, empty when it has not."""
    text = json.dumps(document(root))
    source = read_source("t.yaml", yaml.safe_dump(json.loads(text), allow_unicode=True))
    before, faults = validate(read_source("t.yaml", text))
    after, _ = validate(source)
    return "" if before == after and not faults else "changed on its way through YAML"


def fuzz(bench: Bench, cases: int, first: int) -> None:
    """Try documents: a third of them valid, a third spoiled, a third of any values."""
    kinds = st.one_of(
        ROOTS.map(lambda root: (root, None)),
        spoiled().map(lambda text: (None, text)),
        st.builds(
            lambda root, more: (None, json.dumps({"format": 1, "tree": "t", "root": root, **more})),
            ANYTHING,
            st.dictionaries(WORDS, ANYTHING, max_size=2),
        ),
    )

    @seed(first)
    @settings(
        max_examples=cases,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(kinds)
    def go(case: tuple[Node | None, str | None]) -> None:
        root, text = case
        if root is not None:
            bench.try_valid(root)
        elif text is not None:
            bench.try_spoiled(text)

    go()


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Try many documents and count what must not happen."""
    cases = QUICK_CASES if quick else CASES
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(Path(folder))
        began_s = time.perf_counter()
        fuzz(bench, cases, seed)
        took_s = time.perf_counter() - began_s
    for problem in (*bench.tracebacks, *bench.broken)[:MAX_SHOWN]:
        print(problem)
    spoiled_cases = bench.cases - bench.valid
    return [
        _count("cases", bench.cases, bench.cases, ">= 100000"),
        _count("tracebacks", len(bench.tracebacks), bench.cases, "= 0"),
        _count("broken_valid_trees", len(bench.broken), bench.valid, "= 0"),
        _count("valid_trees", bench.valid, bench.cases),
        _count("refused", bench.refused, spoiled_cases),
        Row("fuzz_s", took_s, "s", bench.cases, took_s, took_s),
    ]


def _count(name: str, value: int, n: int, goal: str = "") -> Row:
    return Row(name, value, "1", n, value, value, goal)
