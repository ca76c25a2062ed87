"""Two missions in one process, tick by tick in two threads: nothing of one is seen in the other."""

import threading
from typing import ClassVar

import toy_missions
from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.ports import PortInformation, PortsMixin
from toy_missions import Rehearsal, skills_of_missions

from executive.engine.nodes.foreign import skill_from_behaviour
from executive.engine.running.runner import MissionOutcome

ROUNDS = 30


class CountUp(PortsMixin, Behaviour):
    """A py_trees leaf, whose own blackboard is one for the whole process."""

    INPUT_PORTS: ClassVar = {"step": PortInformation(data_type=int, description="step")}
    OUTPUT_PORTS: ClassVar = {"total": PortInformation(data_type=int, description="total")}

    def initialise(self):
        self.total = 0
        self.rounds = 0

    def update(self):
        self.total += self.get_input("step")
        self.rounds += 1
        self._set_output("total", self.total)
        return Status.SUCCESS if self.rounds == ROUNDS else Status.RUNNING


class Turns:
    """An observer that lets the other mission have the next tick."""

    def __init__(self, barrier):
        self._barrier = barrier

    def on_tick(self, tick):
        if tick.number < ROUNDS - 1:
            self._barrier.wait(10.0)

    def on_streams(self, messages):
        pass


def test_two_missions_share_nothing(tmp_path, monkeypatch):
    def registry():
        known = skills_of_missions()
        known.add("count_up", skill_from_behaviour(CountUp))
        return known

    monkeypatch.setattr(toy_missions, "skills_of_missions", registry)
    barrier = threading.Barrier(2)
    missions, results = {}, {}
    for step in (1, 100):
        folder = tmp_path / str(step)
        folder.mkdir()
        root = f"""
        parallel:
          - {{skill: count_up, in: {{step: {step}}}, out: {{total: $total}}}}
          - {{skill: swing, in: {{steps: {ROUNDS - 2}}}, out: {{steps: $steps}}}}
          - {{set: {{total: {step}}}}}
        """
        missions[step] = Rehearsal(folder, root)
        missions[step].runner._observers = (missions[step].seen, Turns(barrier))
    threads = [
        threading.Thread(target=lambda step=step: results.update({step: missions[step].run()}))
        for step in missions
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60.0)
    for step, mission in missions.items():
        assert results[step].outcome is MissionOutcome.SUCCESS
        assert mission.tree.scope["total"] == ROUNDS * step
        writes = [write for tick in mission.seen.ticks for write in tick.writes]
        assert [write.value for write in writes if write.writer.endswith("count_up")] == [
            ROUNDS * step
        ]
        assert len(mission.journal.lines) == ROUNDS - 2
        assert mission.cell.calls == ["stop"]
