"""Plans for undoing a cable, by the diagrams that moves should leave."""

from perception.cable.planning.agreement import Agreement, agreement, agrees
from perception.cable.planning.finder import MoveRules
from perception.cable.planning.grasping import Grasp
from perception.cable.planning.moves import MoveKind
from perception.cable.planning.open_diagram import OpenDiagram, open_diagram
from perception.cable.planning.plan import (
    Plan,
    PlanFailure,
    PlannerConfig,
    PlanStep,
    plan_moves,
    plan_trace,
)

__all__ = [
    "Agreement",
    "Grasp",
    "MoveKind",
    "MoveRules",
    "OpenDiagram",
    "Plan",
    "PlanFailure",
    "PlanStep",
    "PlannerConfig",
    "agreement",
    "agrees",
    "open_diagram",
    "plan_moves",
    "plan_trace",
]
