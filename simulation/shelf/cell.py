"""The kinematic shelf cell: a shelf, a camera and a tool that take their time, and no physics."""

import json
import threading
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from executive.core.errors import DeviceError, InputError
from executive.core.world import StreamMessage
from perception.camera import CameraModel
from perception.rgbd import RgbdFrame
from perception.shelf.detections import Detections
from perception.shelf.planning.room import Reach
from perception.shelf.types import NOTHING, Box, Shelf
from simulation.clock import SimClock
from simulation.shelf.cameras import front_camera, viewpoint_cameras
from simulation.shelf.cell_config import ShelfCellConfig
from simulation.shelf.contents import ShelfContents
from simulation.shelf.kinematic_tool import KinematicTool
from simulation.shelf.picturing import SensorNoise, ShelfPicturer
from simulation.shelf.scenario import drawn_scene
from simulation.shelf.stocking import stock_of
from simulation.shelf.taxonomy import shipped_domain
from simulation.shelf_cell.config import ShelfScenario
from simulation.table_cell_config import read_settings

STEP_S = 0.05


@dataclass(frozen=True, slots=True)
class ShelfTruth:
    """How a search has ended.

    Attributes:
        target: What the cell's order is, which a mission may be told to do without.
        found: Whether it was taken out, or can be seen from the middle viewpoint.
        retrieved: Whether it was taken out.
        taken: All that was taken out.
        wrong: What of that is not the cell's order.
        toppled: How many objects fell over.
        disorder_m: How far objects stand from where they stood at first, on average.
    """

    target: str
    found: bool
    retrieved: bool
    taken: tuple[str, ...]
    wrong: tuple[str, ...]
    toppled: int
    disorder_m: float


class ShelfCamera:
    """The camera on the tool."""

    def __init__(self, cell: "KinematicShelfCell") -> None:
        """Bind the cell."""
        self._cell = cell

    def capture(self) -> RgbdFrame:
        """See `RgbdCamera`."""
        return self._cell.picture()


class OracleDetector:
    """Is told by the world what each pixel shows: for experiments with nothing to detect."""

    def __init__(self, cell: "KinematicShelfCell") -> None:
        """Bind the cell."""
        self._cell = cell

    def detect(self, frame: RgbdFrame) -> Detections:
        """See `ShelfDetector`."""
        return self._cell.told(frame)


class KinematicShelfCell:
    """`executive.core.world.Cell` without physics; the same seed gives the same cell.

    Attributes:
        clock: The world's time.
        stock: What is known of the products beforehand.
        tool: The arm.
        camera: On the arm.
        devices: The three above, by name.
    """

    def __init__(
        self, config: Mapping[str, object], scenario: Mapping[str, object], seed: int
    ) -> None:
        """Set the cell up.

        Args:
            config: See `ShelfCellConfig`.
            scenario: See `ShelfScenario`.
            seed: Of everything random: the scene, noise and mishaps.

        Raises:
            InputError: A key or value is not known, or no such scene can be made.
        """
        self.settings = read_settings(ShelfCellConfig, config, "cell config")
        wanted = read_settings(ShelfScenario, scenario, "scenario")
        seeds = np.random.SeedSequence(seed).spawn(3)
        chances = [np.random.default_rng(one) for one in seeds]
        shelf = Shelf()
        self._front = front_camera(shelf, self.settings.camera.width_px)
        self._scene = drawn_scene(wanted, shelf, self._front, chances[0])
        self.stock = stock_of(shipped_domain(wanted.domain), self._scene)
        tool, camera = self.settings.tool, self.settings.camera
        self.reach = Reach(blade_m=tool.blade_m, suction=tool.suction)
        self._contents = ShelfContents(self._scene, self.reach)
        self.tool = KinematicTool(
            self._contents, viewpoint_cameras(shelf, self._front), tool, chances[1]
        )
        noise = SensorNoise(camera.depth_noise_m, camera.lost_share, camera.colour_noise)
        self._picturer = self._taking_pictures(noise, chances[2])
        self.camera = ShelfCamera(self)
        self.clock = SimClock(self)
        self.steps = 0
        self._lock = threading.RLock()
        self.devices: Mapping[str, object] = {
            "clock": self.clock,
            "camera": self.camera,
            "tool": self.tool,
            "stock": self.stock,
        }

    def _taking_pictures(self, noise: SensorNoise, rng: np.random.Generator) -> ShelfPicturer:
        if self.settings.labelled:
            from simulation.shelf.labelled_picturing import LabelledPicturer

            return LabelledPicturer(shipped_domain(self.stock.domain), self._scene, noise, rng)
        colours = {product.name: product.colour for product in self.stock.products}
        return ShelfPicturer(self._scene.shelf, colours, noise, rng)

    @property
    def step_s(self) -> float:
        """Length of a step of the world [s]."""
        return STEP_S

    @property
    def boxes(self) -> Mapping[str, Box]:
        """Where everything stands now; truth, for scoring alone."""
        return self._contents.boxes

    @property
    def search_camera(self) -> CameraModel:
        """The camera at the middle viewpoint."""
        return self._front

    @property
    def oracle_detector(self) -> OracleDetector:
        """A detector that is told the truth."""
        return OracleDetector(self)

    def advance(self, steps: int) -> None:
        """Let time pass."""
        with self._lock:
            for _ in range(steps):
                self.tool.advance(STEP_S)
                self.steps += 1

    def picture(self) -> RgbdFrame:
        """Take a picture from where the camera is.

        Raises:
            DeviceError: The camera moves.
        """
        if not self.tool.resting():
            raise DeviceError("shelf camera: it moves; expected a camera at rest")
        boxes = self._contents.boxes
        return self._picturer.picture(
            boxes, self.tool.camera, self.clock.now_s(), self.tool.viewpoint
        )

    def told(self, frame: RgbdFrame) -> Detections:
        """Return what a frame shows, told by the world as it is now."""
        boxes = self._contents.boxes
        _, segments = self._picturer.truth(boxes, frame.camera)
        names, shown = list(boxes), np.unique(segments[segments != NOTHING])
        numbers = np.full(len(names) + 1, NOTHING, dtype=np.int16)
        numbers[shown] = np.arange(len(shown))
        rows = np.zeros((len(shown), len(self.stock.names)))
        for row, index in enumerate(shown.tolist()):
            rows[row, self.stock.names.index(names[index])] = 1.0
        return Detections(numbers[segments], self.stock.names, rows)

    def drain_streams(self) -> Iterable[StreamMessage]:
        """Return nothing: there are no joints, and the looks are on the blackboard."""
        return ()

    def stop(self) -> None:
        """Bring the tool to rest."""
        self.tool.stop()

    def emergency_stop(self) -> None:
        """Bring the tool to rest for good."""
        self.tool.emergency_stop()

    def close(self) -> None:
        """Do nothing: nothing is held."""

    def snapshot(self) -> bytes:
        """Return the state of shelf, tool and chance.

        Raises:
            DeviceError: The tool moves.
        """
        if not self.tool.resting():
            raise DeviceError("shelf cell: the tool moves; expected a cell at rest")
        boxes = {
            name: [box.x_m, box.y_m, *box.size_m, box.bottom_m]
            for name, box in self._contents.boxes.items()
        }
        state = {
            "scene": self._scene.digest,
            "steps": self.steps,
            "boxes": boxes,
            "viewpoint": self.tool.viewpoint,
            "taken": self.tool.taken,
            "toppled": self.tool.toppled,
            "mishaps": self.tool.chance_state,
            "noise": self._picturer.noise_state,
        }
        return json.dumps(state).encode()

    def restore(self, snapshot: bytes) -> None:
        """Go on from a snapshot of a cell with the same configuration, scenario and seed.

        Raises:
            InputError: It is no snapshot, or one of another scene.
        """
        try:
            state = json.loads(snapshot)
        except ValueError:
            raise InputError("shelf cell: got bytes that are no snapshot of it") from None
        if state.get("scene") != self._scene.digest:
            raise InputError("shelf cell: got a snapshot of another scene")
        self._contents.set_boxes(
            {name: Box(row[0], row[1], (row[2], row[3], row[4]), row[5])
             for name, row in state["boxes"].items()}
        )  # fmt: skip
        self.tool.restore(
            state["viewpoint"], tuple(state["taken"]), state["toppled"], state["mishaps"]
        )
        self._picturer.take_noise_state(state["noise"])
        self.steps = state["steps"]

    def truth(self) -> ShelfTruth:
        """Score the search."""
        target, taken = self._scene.target, self.tool.taken
        boxes, retrieved = self._contents.boxes, target in taken
        seen = target in boxes and (self._picturer.visible_share(boxes, target, self._front) > 0.0)
        first = dict(zip(self._scene.names, self._scene.boxes, strict=True))
        away = [
            float(np.hypot(box.x_m - first[name].x_m, box.y_m - first[name].y_m))
            for name, box in boxes.items()
        ]
        return ShelfTruth(
            target=target,
            found=retrieved or seen,
            retrieved=retrieved,
            taken=taken,
            wrong=tuple(name for name in taken if name != target),
            toppled=self.tool.toppled,
            disorder_m=round(float(np.mean(away)), 4) if away else 0.0,
        )
