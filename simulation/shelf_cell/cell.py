"""The shelf cell with physics: a Kinova with a bluction tool before a shelf full of boxes."""

import colorsys
import threading
from collections.abc import Iterable, Mapping

import numpy as np

from executive.core.world import StreamMessage
from perception.shelf.types import Shelf
from robots.descriptions.kinova import kinova_joint_names
from robots.shelf_arm import scene as place
from robots.shelf_arm.build import kinova_shelf_tool
from robots.shelf_tool import ToolShape
from simulation.clock import SimClock
from simulation.shelf.cameras import front_camera
from simulation.shelf.scenes import Scene, SceneRules, draw_scene
from simulation.shelf.taxonomy import shipped_domain
from simulation.shelf_cell.boxes import Matter, weighed
from simulation.shelf_cell.camera import ToolCamera
from simulation.shelf_cell.config import ShelfCellConfig, ShelfScenario
from simulation.shelf_cell.seeing import visible_shares
from simulation.shelf_cell.streams import joint_states_json, scene_json
from simulation.shelf_cell.truth import ShelfTruth, shelf_truth
from simulation.shelf_cell.world import ShelfWorld
from simulation.streams import Stream
from simulation.table_cell_config import read_settings

JOINTS = kinova_joint_names(len(place.HOME_RAD))
# The blade goes in at least that far along an object's side [m].
_OVERLAP_M = 0.02


class ShelfCell:
    """`executive.core.world.Cell` with physics; the same seed gives the same cell.

    Attributes:
        clock: The world's time; waiting on it lets the physics go on.
        tool: Does what skills ask of the arm.
        camera: Sees from the tool.
        driver: Controllers of the arm.
        devices: Clock, tool, camera and driver, by name.
    """

    def __init__(
        self, config: Mapping[str, object], scenario: Mapping[str, object], seed: int
    ) -> None:
        """Set the cell up.

        Args:
            config: See `ShelfCellConfig`.
            scenario: See `ShelfScenario`.
            seed: Of everything random: the scene, masses, noise, planning.

        Raises:
            InputError: A key or value is not known, or no such scene can be made.
        """
        settings = read_settings(ShelfCellConfig, config, "cell config")
        self._settings = settings
        wanted = read_settings(ShelfScenario, scenario, "scenario")
        chances = np.random.SeedSequence(seed).spawn(3)
        matter_rng, force_rng, camera_rng = (np.random.default_rng(chance) for chance in chances)
        self._scene = _scene(wanted, np.random.default_rng(seed))
        boxes = weighed(
            self._scene.names,
            self._scene.boxes,
            Matter(settings.matter.density_kg_m3, settings.matter.friction),
            matter_rng,
        )
        size = _size(self._scene.shelf)
        self._world = ShelfWorld(size, boxes, settings.tool, settings.physics.step_hz, force_rng)
        self.driver = self._world.driver
        self.tool = kinova_shelf_tool(
            self.driver,
            size,
            ToolShape(blade_m=settings.tool.lane_m, overlap_m=_OVERLAP_M, gap_m=0.0),
            seed=seed,
            look_from_m=(settings.camera.distance_m, settings.camera.height_m),
        )
        self._colours = colours_of(self._scene.names)
        self.camera = ToolCamera(
            self._world.physics,
            self._colours,
            settings.camera,
            self._world.now_s,
            lambda: not self.driver.at_rest,
            lambda: self.tool.at,
            camera_rng,
        )
        self.clock = SimClock(self)
        # One thread at a time lets the world go on; who makes an emergency stop goes first.
        self._stepping = threading.RLock()
        self._may_step = threading.Event()
        self._may_step.set()
        self.devices: Mapping[str, object] = {
            "clock": self.clock,
            "camera": self.camera,
            "tool": self.tool,
            "driver": self.driver,
        }
        self._joint_states = Stream(
            "/joint_states", "JointStates", settings.physics.joint_states_hz
        )
        self._scenes = Stream("/scene", "ShelfScene", settings.physics.scene_hz)
        self._record()

    @property
    def step_s(self) -> float:
        """Length of a step of the world [s]."""
        return self._world.step_s

    @property
    def steps(self) -> int:
        """Steps that the world has taken."""
        return self._world.steps

    def advance(self, steps: int) -> None:
        """Let time pass and record it; what `clock.sleep_until` does."""
        for _ in range(steps):
            self._may_step.wait()
            with self._stepping:
                self.tool.poll()
                self._step()

    def drain_streams(self) -> Iterable[StreamMessage]:
        """Return joint states and scenes since the last call, in the order of time."""
        with self._stepping:
            messages = [*self._joint_states.drain(), *self._scenes.drain()]
        return sorted(messages, key=lambda message: message.time_s)

    def stop(self) -> None:
        """Bring the arm to rest by a jerk-limited stop; the cups keep what they hold."""
        self.tool.stop()
        while not self.driver.at_rest:
            self.advance(1)

    def emergency_stop(self) -> None:
        """Bring the arm to rest as fast as the brakes allow; the cups keep what they hold.

        Safe from any thread, whatever another one does meanwhile: this one takes the world on
        until the arm rests. It takes no command after that.
        """
        self._may_step.clear()
        try:
            with self._stepping:
                self.driver.emergency_stop()
                self.tool.give_up()
                while not self.driver.at_rest:
                    self._step()
        finally:
            self._may_step.set()

    def close(self) -> None:
        """Shut the physics server."""
        self._world.physics.close()

    def truth(self) -> ShelfTruth:
        """Score the shelf as it stands now."""
        physics, shelf = self._world.physics, self._scene.shelf
        config = self._settings.camera
        watching = front_camera(shelf, config.width_px, config.distance_m, config.height_m)
        return shelf_truth(
            self._scene.target,
            physics.box_names,
            physics.box_poses(),
            visible_shares(physics, watching),
            shelf,
        )

    def _step(self) -> None:
        self._world.step()
        self._record()

    def _record(self) -> None:
        now_s, world = self._world.now_s(), self._world
        if self._joint_states.due(now_s):
            self._joint_states.add(now_s, joint_states_json(JOINTS, self.driver.state()))
        if self._scenes.due(now_s):
            held = world.cups.held
            self._scenes.add(now_s, scene_json(world.physics, self._colours, held))


def _scene(wanted: ShelfScenario, rng: np.random.Generator) -> Scene:
    rules = SceneRules(wanted.count, wanted.organisation, wanted.scale)
    return draw_scene(shipped_domain(wanted.domain), rules, rng)


def _size(shelf: Shelf) -> place.ShelfSize:
    return place.ShelfSize(shelf.width_m, shelf.depth_m, shelf.height_m)


def colours_of(names: tuple[str, ...]) -> Mapping[str, tuple[int, int, int]]:
    """Return a colour for each name, as different as can be."""
    hues = [colorsys.hsv_to_rgb(n / len(names), 0.9, 0.9) for n in range(len(names))]
    return {
        name: (round(255 * r), round(255 * g), round(255 * b))
        for name, (r, g, b) in zip(names, hues, strict=True)
    }
