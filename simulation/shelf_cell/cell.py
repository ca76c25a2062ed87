"""The shelf cell with physics: a Kinova with a bluction tool before a shelf full of boxes."""

from collections.abc import Iterable, Mapping

import numpy as np

from executive.core.world import StreamMessage
from perception.shelf.types import Shelf
from robots.descriptions.kinova import kinova_joint_names
from robots.descriptions.specs import kinova_spec
from robots.motion.model import RobotModel
from robots.shelf_arm import scene as place
from robots.shelf_arm.build import kinova_shelf_tool
from robots.shelf_tool import ToolShape
from simulation.clock import SimClock
from simulation.plan_stream import PlanStream
from simulation.shelf.cameras import front_camera, viewpoint_cameras
from simulation.shelf.scenario import drawn_scene
from simulation.shelf.scenes import Scene
from simulation.shelf.stocking import stock_of
from simulation.shelf.taxonomy import shipped_domain
from simulation.shelf_cell.boxes import Matter, weighed
from simulation.shelf_cell.camera import ToolCamera
from simulation.shelf_cell.config import ShelfCellConfig, ShelfScenario, ToolConfig
from simulation.shelf_cell.oracle import OracleDetector
from simulation.shelf_cell.seeing import visible_shares
from simulation.shelf_cell.streams import joint_states_json, scene_json
from simulation.shelf_cell.suction import Vacuum, lift_of
from simulation.shelf_cell.truth import ShelfTruth, shelf_truth
from simulation.shelf_cell.world import ShelfWorld
from simulation.streams import Stream
from simulation.table_cell_config import read_settings
from simulation.turns import Turns

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
        stock: What is known of the products beforehand.
        scene: What stood there at first; truth, for scoring alone.
        search_camera: The camera at the middle viewpoint.
        settings: How the cell was set up.
        devices: Clock, tool, camera, driver and stock, by name.
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
        self.settings = settings
        wanted = read_settings(ShelfScenario, scenario, "scenario")
        # The first is that of the scene in every world, so that seeds give the same scenes.
        seeds = np.random.SeedSequence(seed).spawn(4)
        scene_rng, matter_rng, force_rng, camera_rng = map(np.random.default_rng, seeds)
        shelf = Shelf()
        self.search_camera = front_camera(shelf, settings.camera.width_px)
        self.scene: Scene = drawn_scene(wanted, shelf, self.search_camera, scene_rng)
        self.stock = stock_of(shipped_domain(wanted.domain), self.scene)
        boxes = weighed(
            self.scene.names,
            self.scene.boxes,
            Matter(settings.matter.density_kg_m3, settings.matter.friction),
            matter_rng,
        )
        size = _size(self.scene.shelf)
        self._world = ShelfWorld(size, boxes, settings.tool, settings.physics.step_hz, force_rng)
        self.driver = self._world.driver
        self.tool = kinova_shelf_tool(
            self.driver,
            size,
            _shape(settings.tool),
            seed=seed,
            viewpoints={
                name: camera.T_world_camera
                for name, camera in viewpoint_cameras(shelf, self.search_camera).items()
            },
        )
        self._colours = {product.name: product.colour for product in self.stock.products}
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
        self._turns = Turns()
        self.devices: Mapping[str, object] = {
            "clock": self.clock,
            "camera": self.camera,
            "tool": self.tool,
            "driver": self.driver,
            "stock": self.stock,
        }
        self._joint_states = Stream(
            "/joint_states", "JointStates", settings.physics.joint_states_hz
        )
        self._scenes = Stream("/scene", "ShelfScene", settings.physics.scene_hz)
        robot = RobotModel(kinova_spec(len(place.HOME_RAD)), place.arm_placement(size))
        self._plans = PlanStream(robot, settings.physics.joint_states_hz)
        self._record()

    @property
    def oracle_detector(self) -> OracleDetector:
        """A detector that is told the truth."""
        return OracleDetector(self._world.physics, self.stock.names)

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
            with self._turns.step():
                self.tool.poll()
                self._step()

    def drain_streams(self) -> Iterable[StreamMessage]:
        """Return joint states and scenes since the last call, in the order of time."""
        with self._turns.look():
            messages = [*self._joint_states.drain(), *self._scenes.drain(), *self._plans.drain()]
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
        with self._turns.first():
            self.driver.emergency_stop()
            self.tool.give_up()
            while not self.driver.at_rest:
                self._step()

    def close(self) -> None:
        """Shut the physics server."""
        self._world.physics.close()

    def truth(self) -> ShelfTruth:
        """Score the shelf as it stands now."""
        physics = self._world.physics
        shares = visible_shares(physics, self.search_camera)
        return shelf_truth(self.scene, physics.box_poses(), shares)

    def _step(self) -> None:
        self._world.step()
        self._record()

    def _record(self) -> None:
        now_s, world = self._world.now_s(), self._world
        if self._joint_states.due(now_s):
            self._joint_states.add(now_s, joint_states_json(JOINTS, self.driver.state()))
        self._plans.watch(now_s, self.driver.motion)
        if self._scenes.due(now_s):
            held = world.cups.held
            self._scenes.add(now_s, scene_json(world.physics, self._colours, held))


def _shape(tool: ToolConfig) -> ToolShape:
    lift_kg, lift_nm = lift_of(Vacuum(tool.pressure_pa, tool.friction))
    return ToolShape(tool.lane_m, _OVERLAP_M, gap_m=0.0, lift_kg=lift_kg, lift_nm=lift_nm)


def _size(shelf: Shelf) -> place.ShelfSize:
    return place.ShelfSize(shelf.width_m, shelf.depth_m, shelf.height_m)
