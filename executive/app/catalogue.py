"""Every skill and port type that ships or comes with an installed package, by name.

Light on purpose: `check`, `skills` and `tree` read it, so nothing here loads a camera, a
simulator or a planner, and a skill is imported when a tree names it. Skills talk to
interfaces; `executive.app.compose` supplies what is behind them.
"""

from functools import cache
from typing import Final

from executive.core.registry import LazyRegistry, Registry
from executive.core.skill import Skill
from executive.engine.loading.packages import add_packaged_skills, add_packaged_types

_SKILLS: Final = {
    "account_for_cable": "skills.cable.account_for_cable:AccountForCable",
    "bring_knot": "skills.cable.bring_knot:BringKnot",
    "classify_crossings": "skills.cable.classify_crossings:ClassifyCrossings",
    "detect_endpoints": "skills.cable.detect_endpoints:DetectEndpoints",
    "dilate_knot": "skills.cable.dilate_knot:DilateKnot",
    "find_knots": "skills.cable.find_knots:FindKnots",
    "find_start_points": "skills.cable.find_start_points:FindStartPoints",
    "go_home": "skills.motion.go_home:GoHome",
    "observe_workspace": "skills.cable.observe_workspace:ObserveWorkspace",
    "orient_trace": "skills.cable.orient_trace:OrientTrace",
    "perturb_doubt": "skills.cable.perturb_doubt:PerturbDoubt",
    "perturb_endpoint": "skills.cable.perturb_endpoint:PerturbEndpoint",
    "pull_in": "skills.cable.pull_in:PullIn",
    "state_claim": "skills.cable.state_claim:StateClaim",
    "stir_cable": "skills.cable.stir_cable:StirCable",
    "trace_cable": "skills.cable.trace_cable:TraceCable",
}
_PORT_TYPES: Final = {
    "bool": "builtins:bool",
    "float": "builtins:float",
    "int": "builtins:int",
    "str": "builtins:str",
    "Array": "numpy:ndarray",
    "CableClaim": "perception.cable.types:CableClaim",
    "CameraFrame": "perception.camera:CameraFrame",
    "Crossing": "perception.cable.types:Crossing",
    "Endpoint": "perception.cable.types:Endpoint",
    "Knot": "perception.cable.types:Knot",
    "Trace": "perception.cable.types:Trace",
    "TraceStart": "perception.cable.types:TraceStart",
}


@cache
def skills() -> Registry[type[Skill]]:
    """Return the skills that ship and those of installed packages, by the name that trees use."""
    return add_packaged_skills(LazyRegistry("skill", _SKILLS))


@cache
def port_types() -> Registry[type]:
    """Return the types that ports may have in YAML, by name."""
    return add_packaged_types(LazyRegistry("port type", _PORT_TYPES))
