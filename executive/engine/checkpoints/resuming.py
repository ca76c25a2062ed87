"""From a recording to a tree and a cell that go on where it left off."""

from collections.abc import Iterable
from dataclasses import dataclass

from executive.core.errors import InputError
from executive.core.registry import Registry
from executive.core.skill import Skill
from executive.core.world import Cell
from executive.engine.checkpoints.choosing import CheckpointInfo
from executive.engine.checkpoints.compatible import (
    changed_versions,
    require_same_nodes,
    require_same_sources,
)
from executive.engine.checkpoints.past import Resumption, past_of
from executive.engine.checkpoints.restoring import restore_tree, restored_cell
from executive.engine.loading.loader import Mission, load_mission
from executive.engine.nodes.builder import BuiltTree, build
from executive.engine.recording.messages import MissionHeader, ResumedFrom
from executive.engine.recording.reader import Recording
from executive.engine.running.mission_run import recorded_nodes, versions


@dataclass(frozen=True, slots=True)
class Consent:
    """What whoever resumes a mission vouches for.

    Attributes:
        anyway: That it may go on with changed files, as long as the nodes are the same, and
            without values that were not kept.
        as_it_stands: That all in the cell is as it was when the checkpoint was taken, where
            the cell cannot be put back into that state.
    """

    anyway: bool = False
    as_it_stands: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class TakenUp:
    """A mission that can go on.

    Attributes:
        tree: Its tree.
        cell: The cell that it goes on in.
        resumption: What `run_mission` goes on from.
        notes: What is not as it was, in words.
    """

    tree: BuiltTree
    cell: Cell
    resumption: Resumption
    notes: tuple[str, ...]


def recorded_mission(
    header: MissionHeader,
    consent: Consent,
    *,
    skills: Registry[type[Skill]],
    types: Registry[type],
) -> tuple[Mission, tuple[str, ...]]:
    """Return the mission of a recording as its files say it now, and what has changed.

    Raises:
        InputError: It is not the one that was recorded, or its files are not there.
    """
    if not header.sources:
        raise InputError(
            f"{header.mission}: the recording names no file of the mission, so nothing can go on "
            "with it; try cellwright run"
        )
    notes = tuple(changed_versions(header.versions, versions()))
    try:
        mission = load_mission(header.sources[0].file, skills=skills, types=types)
    except InputError as error:
        raise InputError(
            f"the mission cannot be loaded as it was recorded: {error}; try the folder in which "
            "it was started"
        ) from error
    require_same_sources(header, mission, anyway=consent.anyway)
    return mission, notes


def take_up(
    info: CheckpointInfo,
    recording: Recording,
    mission: Mission,
    cell: Cell,
    consent: Consent,
    *,
    classes: Iterable[type] = (),
) -> TakenUp:
    """Put a freshly opened cell and a fresh tree to where a checkpoint was taken.

    Args:
        info: The checkpoint.
        recording: Where it is.
        mission: The recorded mission.
        cell: Its cell, opened with the seed and the scenario of the recording.
        consent: What the user vouches for.
        classes: Classes of values that are not of this project.

    Raises:
        InputError: That cannot be done; says why.
    """
    header, then = recording.header, info.message.progress
    cell = restored_cell(info, cell, as_it_stands=consent.as_it_stands)
    tree = build(
        mission,
        devices=cell.devices,
        clock=cell.clock,
        inputs=dict(header.inputs),
        seed=header.seed,
    )
    require_same_nodes(header.nodes, recorded_nodes(tree.nodes))
    tree.clock.skip(then.paused_s)
    lost = restore_tree(info, recording, tree, classes, anyway=consent.anyway)
    past = past_of(recording, info.message)
    origin = ResumedFrom(
        file=str(recording.path),
        checkpoint=info.message.number,
        node=info.path,
        tick=then.tick,
        time_s=then.time_s,
    )
    return TakenUp(tree, cell, Resumption(origin, recording, past), lost)
