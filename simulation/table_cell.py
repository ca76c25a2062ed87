"""The simulated table cell: a YuMi, a table, an overhead camera, and cables."""

from collections.abc import Iterable, Mapping

import numpy as np

from executive.core.world import StreamMessage
from perception.camera import Camera
from robots.interfaces import ArmsDriver
from robots.motion.model import yumi_model
from simulation.arms_driver import SimArmsDriver
from simulation.cable.truth import CableTruth, cable_truth
from simulation.clock import SimClock
from simulation.freezing_camera import FreezingCamera
from simulation.overhead_camera import OverheadCamera
from simulation.plan_stream import PlanStream
from simulation.snapshots import TableSnapshot
from simulation.streams import Stream, joint_states_json, scene_json
from simulation.table_cables import lay_cables
from simulation.table_cell_config import TableCellConfig, TableScenario, read_settings
from simulation.table_setup import planning_scene, rod_parameters
from simulation.table_world import TableWorld
from simulation.turns import Turns
from simulation.unreliable_arms import ArmFaults, UnreliableArms


class TableCell:
    """`executive.core.world.Cell` in simulation; the same seed gives the same cell.

    Attributes:
        clock: The world's time; waiting on it lets the physics go on.
        driver: Controllers of both arms.
        commanded: The same as missions command them: with what goes wrong.
        camera: Looks straight down on the table.
        seen: The same as missions see through it: with what goes wrong.
        scene: Where the robot stands, and what it must not touch; for the planner.
        devices: Clock, driver and camera, by name.
    """

    def __init__(
        self, config: Mapping[str, object], scenario: Mapping[str, object], seed: int
    ) -> None:
        """Set the cell up.

        Args:
            config: See `TableCellConfig`.
            scenario: See `TableScenario`.
            seed: Of everything random: the cables, the cloth, the camera's noise.

        Raises:
            InputError: A key or value is not known, or a cable cannot be laid.
        """
        settings = read_settings(TableCellConfig, config, "cell config")
        found = read_settings(TableScenario, scenario, "scenario")
        faults = ArmFaults(**found.arms.model_dump())
        cable_seed, camera_seed, faults_seed, arms_seed = np.random.SeedSequence(seed).spawn(4)
        parameters = rod_parameters(settings.cable)
        lines_m = lay_cables(found, np.random.default_rng(cable_seed), parameters)
        self.scene = planning_scene(settings.layout)
        self._world = TableWorld(
            lines_m, settings.physics.step_hz, self.scene.placement, parameters
        )
        self.driver: SimArmsDriver = self._world.driver
        self.commanded: ArmsDriver = self.driver
        if faults.any():
            arms_rng = np.random.default_rng(arms_seed)
            self.commanded = UnreliableArms(self.driver, faults, arms_rng)
        self.camera = OverheadCamera(
            self._world,
            settings.camera,
            np.random.default_rng(camera_seed),
            np.random.default_rng(faults_seed),
        )
        freezes_after = found.camera.freezes_after
        self.seen: Camera = (
            self.camera if freezes_after is None else FreezingCamera(self.camera, freezes_after)
        )
        self.clock = SimClock(self)
        self._turns = Turns()
        self.devices: Mapping[str, object] = {
            "clock": self.clock,
            "camera": self.seen,
            "driver": self.commanded,
        }
        rates = settings.physics
        self._joint_states = Stream("/joint_states", "JointStates", rates.joint_states_hz)
        self._scene = Stream("/scene", "Scene", rates.scene_hz)
        self._plans = PlanStream(yumi_model(self.scene.placement), rates.joint_states_hz)
        self._steps_a_record = max(1, rates.step_hz // rates.joint_states_hz)
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
        end = self.steps + steps
        while self.steps < end:
            with self._turns.step():
                self._step(end)

    def drain_streams(self) -> Iterable[StreamMessage]:
        """Return joint states and scenes since the last call, in the order of time."""
        with self._turns.look():
            messages = [*self._joint_states.drain(), *self._scene.drain(), *self._plans.drain()]
        return sorted(messages, key=lambda message: message.time_s)

    def stop(self) -> None:
        """Bring the arms to rest by a jerk-limited stop; grippers keep what they hold."""
        self.driver.stop()
        self._come_to_rest()

    def emergency_stop(self) -> None:
        """Bring the arms to rest as fast as the brakes allow; grippers keep what they hold.

        Safe from any thread, whatever another one does meanwhile: this one takes the world on
        until the arms rest. They take no command after that.
        """
        with self._turns.first():
            self.driver.emergency_stop()
            while not self.driver.at_rest:
                self._step(self.steps + 1)

    def close(self) -> None:
        """Shut the physics server."""
        self._world.body.close()

    def snapshot(self) -> bytes:
        """Return the state of arms, cable and camera.

        Raises:
            DeviceError: Something moves or is held.
        """
        return TableSnapshot(self._world.state(), self.camera.noise_state).to_bytes()

    def restore(self, snapshot: bytes) -> None:
        """Go on from a snapshot of a cell with the same configuration, scenario and seed.

        Raises:
            InputError: It is no snapshot, or one of another cable.
        """
        state = TableSnapshot.from_bytes(snapshot)
        self._world.take_state(state.world)
        self.camera.take_noise_state(state.camera)
        for stream in (self._joint_states, self._scene, self._plans):
            stream.restart()
        self._record()

    def truth(self) -> CableTruth:
        """Score the cables as they lie now."""
        return cable_truth(*self._world.rod.lines_m)

    def _come_to_rest(self) -> None:
        while not self.driver.at_rest:
            self.advance(1)

    def _step(self, end: int) -> None:
        self._world.advance(min(end - self.steps, self._steps_a_record))
        self._record()

    def _record(self) -> None:
        now_s, world = self._world.now_s(), self._world
        if self._joint_states.due(now_s):
            self._joint_states.add(now_s, joint_states_json(self.driver.state()))
        self._plans.watch(now_s, self.driver.motion)
        if self._scene.due(now_s):
            names, rod = world.body.link_names, world.rod
            poses = world.body.link_poses(names)
            self._scene.add(now_s, scene_json(names, *poses, rod.lines_m, rod.parameters.radius_m))
