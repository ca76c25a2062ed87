"""Looks at files with every rule, and sorts out what waivers let stand."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from executive.core.errors import Fault
from executive.core.registry import Registry, closest
from executive.core.skill import Skill
from executive.engine.language.sources import Source
from executive.engine.lint.findings import Finding, PortSpot, Rule, Spot
from executive.engine.lint.halts import Halts, find_halts
from executive.engine.lint.rules import RULES, WAIVER_CODE, WAIVER_RULE
from executive.engine.lint.subject import Subject
from executive.engine.lint.waivers import FORM, Waiver, find_waivers
from executive.engine.loading.loader import Program, load_programs


@dataclass(frozen=True, slots=True)
class LintReport:
    """What a look at some files came to.

    Attributes:
        findings: What no waiver lets stand, in the order of file and line.
        waived: What a waiver lets stand, with its reason.
        faults: What keeps files from being looked at.
        programs: The trees and missions that were looked at.
    """

    findings: tuple[Finding, ...]
    waived: tuple[tuple[Finding, str], ...]
    faults: tuple[Fault, ...]
    programs: tuple[Program, ...]

    def halts(self) -> Mapping[str, tuple[Halts, ...]]:
        """Return who can halt each leaf of each tree or mission, by the name of that."""
        return {one.tree.name: tuple(find_halts(Subject(one))) for one in self.programs}


def lint_files(
    files: Iterable[Path],
    *,
    skills: Registry[type[Skill]],
    types: Registry[type],
    search_paths: Sequence[Path] = (),
) -> LintReport:
    """Look at trees and missions with every rule.

    Args:
        files: YAML files; cells among them are only checked.
        skills: Skills by name.
        types: Types that ports may have, by name.
        search_paths: Folders to search before the package.

    Raises:
        InputError: A file cannot be read.
    """
    programs, faults = load_programs(files, skills=skills, types=types, search_paths=search_paths)
    looking = _Looking()
    for program in programs:
        looking.look(program)
    findings, waived = looking.sorted_out()
    return LintReport(tuple(findings), tuple(waived), tuple(faults), tuple(programs))


@dataclass(slots=True)
class _Looking:
    """What is gathered over all files.

    Attributes:
        found: Findings with the lines that a waiver for them may stand for.
        asked: Files that were asked for.
        reached: Files that a mission reaches.
        sources: All of them by name.
    """

    found: dict[Finding, frozenset[int]] = field(default_factory=dict)
    asked: set[str] = field(default_factory=set)
    reached: set[str] = field(default_factory=set)
    sources: dict[str, Source] = field(default_factory=dict)

    def look(self, program: Program) -> None:
        """Look at one tree with every rule."""
        subject = Subject(program)
        self.asked.add(program.tree.source.file)
        self.sources |= {source.file: source for source in program.sources}
        if subject.mission is not None:
            self.reached |= {source.file for source in program.sources}
        for rule in RULES:
            if rule.missions_only and subject.mission is None:
                continue
            for spot in rule.look(subject):
                finding, lines = _located(rule, subject, spot)
                self.found[finding] = lines

    def sorted_out(self) -> tuple[list[Finding], list[tuple[Finding, str]]]:
        """Return what stands, and what waivers let stand."""
        waivers = {file: find_waivers(self.sources[file].text) for file in self.sources}
        findings, waived = [], []
        used: set[tuple[str, Waiver, str]] = set()
        for finding, lines in sorted(self.found.items()):
            here = [
                one
                for one in waivers[finding.file]
                if one.target in lines and finding.code in one.codes and one.reason
            ]
            used |= {(finding.file, one, finding.code) for one in here}
            if here:
                waived.append((finding, here[0].reason))
            else:
                findings.append(finding)
        for file in self.asked:
            for waiver in waivers[file]:
                findings += self._idle(file, waiver, used)
        return sorted(findings), waived

    def _idle(
        self, file: str, waiver: Waiver, used: set[tuple[str, Waiver, str]]
    ) -> Iterator[Finding]:
        """Find fault with a waiver that says no reason or does nothing."""
        if not waiver.codes or not waiver.reason:
            yield _about_waiver(file, waiver, f"expected `{FORM}`")
            return
        known = {rule.code: rule for rule in RULES}
        for code in waiver.codes:
            if code not in known:
                message = f"no rule has the code {code!r}; {closest(code, [*known])}"
                yield _about_waiver(file, waiver, message)
                continue
            seen = not known[code].missions_only or file in self.reached
            if seen and (file, waiver, code) not in used:
                name = known[code].name
                yield _about_waiver(file, waiver, f"{code} ({name}) is not found here; drop it")


def _located(rule: Rule, subject: Subject, spot: Spot | PortSpot) -> tuple[Finding, frozenset[int]]:
    if isinstance(spot, PortSpot):
        source, node = subject.tree.source, subject.tree.name
        line, column = source.key_mark((spot.direction, spot.port))
        lines = frozenset({line})
    else:
        source, node = spot.node.source, spot.node.path
        place = (*spot.node.at, *spot.at)
        line, column = source.value_mark(place) if spot.at else spot.node.mark
        lines = frozenset({line, spot.node.mark[0], source.key_mark(place)[0]})
    finding = Finding(source.file, line, column, node, rule.code, rule.name, spot.message)
    return finding, lines


def _about_waiver(file: str, waiver: Waiver, message: str) -> Finding:
    return Finding(file, waiver.line, waiver.column, "", WAIVER_CODE, WAIVER_RULE, message)
