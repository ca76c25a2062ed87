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
    "begin_search": "skills.shelf.begin_search:BeginSearch",
    "bring_knot": "skills.cable.bring_knot:BringKnot",
    "check_drape": "skills.cable.check_drape:CheckDrape",
    "choose_move": "skills.shelf.choose_move:ChooseMove",
    "choose_policy": "skills.cable.choose_policy:ChoosePolicy",
    "classify_crossings": "skills.cable.classify_crossings:ClassifyCrossings",
    "clear_way": "skills.shelf.clear_way:ClearWay",
    "compare_looks": "skills.cable.compare_looks:CompareLooks",
    "conclude": "skills.cable.conclude:Conclude",
    "detect_endpoints": "skills.cable.detect_endpoints:DetectEndpoints",
    "detect_objects": "skills.shelf.detect_objects:DetectObjects",
    "dilate_knot": "skills.cable.dilate_knot:DilateKnot",
    "find_knots": "skills.cable.find_knots:FindKnots",
    "find_start_points": "skills.cable.find_start_points:FindStartPoints",
    "go_home": "skills.motion.go_home:GoHome",
    "look_at_shelf": "skills.shelf.look_at_shelf:LookAtShelf",
    "observe_workspace": "skills.cable.observe_workspace:ObserveWorkspace",
    "open_knot": "skills.cable.open_knot:OpenKnot",
    "orient_trace": "skills.cable.orient_trace:OrientTrace",
    "perturb_doubt": "skills.cable.perturb_doubt:PerturbDoubt",
    "perturb_endpoint": "skills.cable.perturb_endpoint:PerturbEndpoint",
    "place_object": "skills.shelf.place_object:PlaceObject",
    "pull_in": "skills.cable.pull_in:PullIn",
    "push_object": "skills.shelf.push_object:PushObject",
    "refine_names": "skills.shelf.refine_names:RefineNames",
    "refuse_move": "skills.shelf.refuse_move:RefuseMove",
    "restore_order": "skills.shelf.restore_order:RestoreOrder",
    "retrieve_object": "skills.shelf.retrieve_object:RetrieveObject",
    "separate_ends": "skills.cable.separate_ends:SeparateEnds",
    "shake_off": "skills.cable.shake_off:ShakeOff",
    "state_claim": "skills.cable.state_claim:StateClaim",
    "state_search": "skills.shelf.state_search:StateSearch",
    "stir_cable": "skills.cable.stir_cable:StirCable",
    "take_order": "skills.shelf.take_order:TakeOrder",
    "trace_cable": "skills.cable.trace_cable:TraceCable",
    "update_belief": "skills.shelf.update_belief:UpdateBelief",
    "verify_target": "skills.shelf.verify_target:VerifyTarget",
    "weigh_look": "skills.cable.weigh_look:WeighLook",
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
    "Detections": "perception.shelf.detections:Detections",
    "Endpoint": "perception.cable.types:Endpoint",
    "Knot": "perception.cable.types:Knot",
    "Place": "perception.shelf.planning.moves:Place",
    "Push": "perception.shelf.planning.moves:Push",
    "RgbdFrame": "perception.rgbd:RgbdFrame",
    "SearchClaim": "perception.shelf.beliefs:SearchClaim",
    "ShelfBelief": "perception.shelf.beliefs:ShelfBelief",
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
