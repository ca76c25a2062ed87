"""Every skill and port type that ships, by name.

Light on purpose: `check`, `skills` and `tree` read it, so nothing here loads a camera, a
simulator or a planner. Skills talk to interfaces; `executive.app.compose` supplies what is
behind them.
"""

from functools import cache

import numpy as np

from executive.core.registry import Registry
from executive.core.skill import Skill
from perception.cable.types import (
    CableClaim,
    Crossing,
    Endpoint,
    Knot,
    Trace,
    TraceStart,
)
from perception.camera import CameraFrame
from skills.cable.account_for_cable import AccountForCable
from skills.cable.bring_knot import BringKnot
from skills.cable.classify_crossings import ClassifyCrossings
from skills.cable.detect_endpoints import DetectEndpoints
from skills.cable.dilate_knot import DilateKnot
from skills.cable.find_knots import FindKnots
from skills.cable.find_start_points import FindStartPoints
from skills.cable.observe_workspace import ObserveWorkspace
from skills.cable.orient_trace import OrientTrace
from skills.cable.perturb_doubt import PerturbDoubt
from skills.cable.perturb_endpoint import PerturbEndpoint
from skills.cable.pull_in import PullIn
from skills.cable.state_claim import StateClaim
from skills.cable.stir_cable import StirCable
from skills.cable.trace_cable import TraceCable
from skills.motion.go_home import GoHome

_SKILLS: dict[str, type[Skill]] = {
    "account_for_cable": AccountForCable,
    "bring_knot": BringKnot,
    "classify_crossings": ClassifyCrossings,
    "detect_endpoints": DetectEndpoints,
    "dilate_knot": DilateKnot,
    "find_knots": FindKnots,
    "find_start_points": FindStartPoints,
    "go_home": GoHome,
    "observe_workspace": ObserveWorkspace,
    "orient_trace": OrientTrace,
    "perturb_doubt": PerturbDoubt,
    "perturb_endpoint": PerturbEndpoint,
    "pull_in": PullIn,
    "state_claim": StateClaim,
    "stir_cable": StirCable,
    "trace_cable": TraceCable,
}

_PORT_TYPES: dict[str, type] = {
    "bool": bool,
    "float": float,
    "int": int,
    "str": str,
    "Array": np.ndarray,
    "CableClaim": CableClaim,
    "CameraFrame": CameraFrame,
    "Crossing": Crossing,
    "Endpoint": Endpoint,
    "Knot": Knot,
    "Trace": Trace,
    "TraceStart": TraceStart,
}


@cache
def skills() -> Registry[type[Skill]]:
    """Return the skills that ship, by the name that trees use."""
    registry: Registry[type[Skill]] = Registry("skill")
    for name, skill in _SKILLS.items():
        registry.add(name, skill)
    return registry


@cache
def port_types() -> Registry[type]:
    """Return the types that ports may have in YAML, by name."""
    registry: Registry[type] = Registry("port type")
    for name, port_type in _PORT_TYPES.items():
        registry.add(name, port_type)
    return registry
