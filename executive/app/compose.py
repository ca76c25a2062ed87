"""Pick the world, the arms and the perception behind a cell's devices.

The heavy imports of the project meet here and nowhere else.
"""

import importlib.util
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np

from executive.core.clock import Clock
from executive.core.errors import InputError
from executive.core.process_work import ProcessWorker
from executive.core.registry import closest
from executive.core.work import InlineWorker, ThreadWorker, Worker
from executive.core.world import Cell, RestorableCell, StreamMessage
from executive.engine.language.document import CellDocument
from perception.cable.interfaces import CableVision

if TYPE_CHECKING:
    from perception.shelf.detections import ShelfDetector
    from simulation.shelf.cell import KinematicShelfCell
    from simulation.shelf_cell.cell import ShelfCell

VisionKind = Literal["learned", "classic"]

# Arms in the ready pose reach this far into the overhead image.
ROWS_OF_ARMS_AT_HOME = 58


class _RestorableWorld(Cell, RestorableCell, Protocol):
    """A world that is both."""


class _EquippedCell:
    """A world with the services that skills use on top of its devices."""

    def __init__(self, world: Cell, services: Mapping[str, object]) -> None:
        self._world = world
        self.devices: Mapping[str, object] = {**world.devices, **services}

    @property
    def clock(self) -> Clock:
        return self._world.clock

    def drain_streams(self) -> Iterable[StreamMessage]:
        return self._world.drain_streams()

    def stop(self) -> None:
        self._world.stop()

    def emergency_stop(self) -> None:
        self._world.emergency_stop()

    def close(self) -> None:
        for service in self.devices.values():
            if isinstance(service, Worker):
                service.close()
        self._world.close()

    def truth(self) -> object | None:
        return self._world.truth()


class _RestorableEquippedCell(_EquippedCell):
    """One whose world can be put back into a state that it was in."""

    def __init__(self, world: _RestorableWorld, services: Mapping[str, object]) -> None:
        super().__init__(world, services)
        self._restorable: RestorableCell = world

    def snapshot(self) -> bytes:
        return self._restorable.snapshot()

    def restore(self, snapshot: bytes) -> None:
        self._restorable.restore(snapshot)


def open_cell(document: CellDocument, scenario: Mapping[str, object], seed: int) -> Cell:
    """Open the cell that a document describes.

    Args:
        document: The cell document.
        scenario: What to set up in it; checked by the world.
        seed: Seed of everything random in it.

    Raises:
        InputError: Unknown world, or a configuration or scenario that the world refuses.
    """
    worlds = {
        "table_cell": _open_table_cell,
        "shelf_cell": _open_shelf_cell,
        "shelf_kinematic": _open_kinematic_shelf,
        "socket_arms": _open_socket_cell,
        "dry": _open_dry_cell,
    }
    if document.world not in worlds:
        raise InputError(f"unknown world {document.world!r}; {closest(document.world, [*worlds])}")
    return worlds[document.world](document, scenario, seed)


def _open_table_cell(document: CellDocument, scenario: Mapping[str, object], seed: int) -> Cell:
    from executive.app.visions import selectable_vision
    from perception.fresh_camera import FreshCamera
    from robots.dual_arm import PlannedDualArm
    from simulation.cable.foresight import CableForesight
    from simulation.table_cell import TableCell

    world = TableCell(document.config, scenario, seed)
    services = {
        "camera": FreshCamera(world.seen, world.clock, noisy=world.camera.noisy),
        "arms": PlannedDualArm(world.commanded, seed=seed, scene=world.scene),
        "vision": selectable_vision(
            partial(cable_vision, ROWS_OF_ARMS_AT_HOME), ROWS_OF_ARMS_AT_HOME
        ),
        "foresight": CableForesight(),
        "rng": np.random.default_rng(seed),
        **workers(document.work),
    }
    return _RestorableEquippedCell(world, services)


def _open_socket_cell(document: CellDocument, scenario: Mapping[str, object], seed: int) -> Cell:
    from robots.dual_arm import PlannedDualArm
    from simulation.loopback.cell import SocketCell

    world = SocketCell(document.config, scenario)
    services = {
        "arms": PlannedDualArm(world.driver, seed=seed),
        "rng": np.random.default_rng(seed),
        **workers(document.work),
    }
    return _EquippedCell(world, services)


def _open_shelf_cell(document: CellDocument, scenario: Mapping[str, object], seed: int) -> Cell:
    from simulation.shelf_cell.cell import ShelfCell

    world = ShelfCell(document.config, scenario, seed)
    return _EquippedCell(world, _search_services(world, document, seed))


def _open_kinematic_shelf(
    document: CellDocument, scenario: Mapping[str, object], seed: int
) -> Cell:
    from simulation.shelf.cell import KinematicShelfCell

    world = KinematicShelfCell(document.config, scenario, seed)
    return _RestorableEquippedCell(world, _search_services(world, document, seed))


def _search_services(
    world: "ShelfCell | KinematicShelfCell", document: CellDocument, seed: int
) -> Mapping[str, object]:
    """Return what skills of a search use on top of a shelf cell's devices."""
    from executive.app.shelf_services import product_reader, shelf_services
    from perception.fresh_camera import FreshCamera

    kind = world.settings.detector
    told: ShelfDetector | None = world.oracle_detector if kind == "oracle" else None
    if kind in ("product", "looks"):
        told = product_reader(world.stock.domain, text=kind == "product")
    return {
        **shelf_services(
            world.stock, world.tool.shape, world.search_camera, told, world.settings.affinity
        ),
        # Noise may be switched off there, and then frames of one scene are the same.
        "camera": FreshCamera(world.camera, world.clock, noisy=False),
        "rng": np.random.default_rng(seed),
        **workers(document.work),
    }


def workers(work: Literal["inline", "beside"]) -> dict[str, Worker]:
    """Return who does long work in a cell: `worker` for any, `processes` for what can be pickled.

    Args:
        work: What the document of the cell says.
    """
    if work == "inline":
        return {"worker": InlineWorker(), "processes": InlineWorker()}
    return {"worker": ThreadWorker(), "processes": ProcessWorker()}


def _open_dry_cell(
    document: CellDocument,
    scenario: Mapping[str, object],
    seed: int,  # noqa: ARG001 - every world takes one; nothing is random here
) -> Cell:
    from executive.app.dry_cell import DryCell

    return DryCell(document.config, scenario)


def cable_vision(hidden_rows: int = 0, kind: VisionKind | None = None) -> CableVision:
    """Return the perception of cables.

    Args:
        hidden_rows: Lowest image rows that show the robot instead of the table.
        kind: With networks, or without; None takes networks where they can run.

    Raises:
        InputError: Networks are asked for, and what they need is not installed.
    """
    from perception.cable.vision import LEARNED, GreyImageVision, VisionConfig

    installed = importlib.util.find_spec("torch") is not None
    if kind == "learned" and not installed:
        raise InputError(
            "vision: networks need PyTorch, which is not installed; "
            "try pip install 'cellwright[learn]', or the classic one"
        )
    if kind == "classic" or not installed:
        return GreyImageVision(VisionConfig(hidden_rows=hidden_rows))
    _use_one_thread()
    return GreyImageVision(replace(LEARNED, hidden_rows=hidden_rows))


def _use_one_thread() -> None:
    """Let networks work in one thread: they are small, and threads would wait for each other."""
    import torch

    torch.set_num_threads(1)
