"""Moves of strands between the ends of a cable: certificates' moves as a robot makes them."""

from collections.abc import Iterator

from perception.cable.planning.laying import Faces, Stretch, laid, stretches
from perception.cable.planning.moves import Hold, Move, MoveKind
from perception.cable.planning.open_diagram import OpenDiagram


def inner_moves(diagram: OpenDiagram) -> Iterator[Move]:
    """Return moves of strands between the ends, each run as a whole, and twists and bights."""
    faces = Faces(diagram)
    for longest in stretches(diagram):
        runs = {longest} | {
            Stretch(first, first + more)
            for more in (0, 1)
            for first in range(longest.first, longest.last + 1 - more)
        }
        for run in sorted(runs, key=lambda run: (run.first, run.last)):
            yield from _laid_elsewhere(diagram, faces, run, longest)


def _laid_elsewhere(
    diagram: OpenDiagram, faces: Faces, run: Stretch, longest: Stretch
) -> Iterator[Move]:
    if run != longest and not faces.crosses_nothing(run):
        return
    way = faces.way(run) if run == longest else []
    if way is None:
        return
    on_top = diagram.over[run.first]
    interval = (diagram.span(run.first)[0], diagram.span(run.last + 1)[1])
    kind = _kind(diagram, run, on_top) if not way else MoveKind.LAY_OVER
    is_loop = kind is MoveKind.UNTWIST
    holds = _beside_loop(diagram, run.first) if is_loop else (_amid(diagram, run, interval),)
    yield Move(
        kind,
        None,
        interval,
        holds,
        passed=run.length + len(way),
        below=0 if on_top else run.length,
        predicted=laid(diagram, run, way),
        across=tuple(sum(diagram.span(door.edge)) / 2.0 for door in way),
    )


def _amid(diagram: OpenDiagram, run: Stretch, interval: tuple[float, float]) -> Hold:
    """Return where to take a run: between its visits where it is on top, else anywhere."""
    inner = (diagram.arcs[run.first], diagram.arcs[run.last])
    free = diagram.over[run.first] and run.length > 1
    return Hold("pinch", inner if free else interval, sum(inner) / 2.0)


def _kind(diagram: OpenDiagram, run: Stretch, on_top: bool) -> MoveKind:
    """Name a run that crosses nothing where it is laid."""
    others = [diagram.partner(place) for place in range(run.first, run.last + 1)]
    if run.length == 1 and abs(others[0] - run.first) == 1:
        return MoveKind.UNTWIST
    if run.length == 2 and abs(others[0] - others[1]) == 1:
        return MoveKind.PULL_APART
    return MoveKind.LAY_OVER if on_top else MoveKind.DRAW_OUT


def _beside_loop(diagram: OpenDiagram, place: int) -> tuple[Hold, ...]:
    """Return where to hold on both sides of a loop to pull it straight."""
    first, second = sorted((place, diagram.partner(place)))
    before, after = diagram.span(first), diagram.span(second + 1)
    return Hold("pinch", before, before[1]), Hold("pinch", after, after[0])
