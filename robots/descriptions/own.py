"""A robot of your own: its URDF, and its SRDF where there is one, become a `RobotSpec`.

Each `<group>` of the SRDF that moves, by a `<chain>` or a list of `<joint>`, is an arm, unless an
`<end_effector>` says that it is a hand: then its joints are the fingers of the parent group.
Without an SRDF, the joints from the root to the only link that ends a chain are one arm.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from executive.core.errors import InputError
from executive.core.registry import closest
from robots.descriptions.specs import ARM, ArmSpec, RobotSpec

_TURNING = ("revolute", "continuous")
_MOVING = (*_TURNING, "prismatic")


@dataclass(frozen=True, slots=True)
class _Tree:
    """A URDF's links and joints.

    Attributes:
        file: Where they were read.
        parents: The joint above each link.
        joints: By name.
        links: In the order of the file.
    """

    file: Path
    parents: Mapping[str, ET.Element]
    joints: Mapping[str, ET.Element]
    links: tuple[str, ...]

    def chain(self, tip: str, base: str | None) -> list[ET.Element]:
        """Return the joints down to a link, from the root or from a base link.

        Raises:
            InputError: The base is not above the tip.
        """
        found: list[ET.Element] = []
        link = tip
        while link != base and link in self.parents:
            found.append(self.parents[link])
            link = _link_of(self.parents[link], "parent")
        if base is not None and link != base:
            raise InputError(f"{self.file}: link {base!r} is not above link {tip!r}")
        return found[::-1]

    def below(self, joint: str) -> str:
        """Return the link that a joint moves."""
        return _link_of(self.joints[joint], "child")


def robot_from_files(
    urdf: Path, srdf: Path | None = None, tcps: Mapping[str, str] | None = None
) -> RobotSpec:
    """Read a robot.

    Args:
        urdf: Its description; meshes are looked for from its folder on.
        srdf: Its groups, hands, and pairs of links that may overlap.
        tcps: Link of the tool centre point of arms, z out of the tool; the last link of the
            chain for those that are not named.

    Raises:
        InputError: A file cannot be read or used; the message says where and why.
    """
    tree = _tree(urdf)
    arms = _arms(tree, _xml(srdf), srdf) if srdf else {ARM: _only_arm(tree)}
    overlaps = _overlaps(tree, _xml(srdf), srdf) if srdf else ()
    for arm, tcp in (tcps or {}).items():
        if arm not in arms:
            raise InputError(f"{srdf or urdf}: no arm {arm!r}; {closest(arm, [*arms])}")
        _demand_link(tree, tcp, f"tool of {arm}")
        arms[arm] = ArmSpec(arms[arm].joints, tcp, arms[arm].fingers)
    return RobotSpec(_xml(urdf).get("name") or urdf.stem, urdf, arms, overlaps)


def _xml(file: Path) -> ET.Element:
    try:
        root = ET.parse(file).getroot()
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from None
    except ET.ParseError as error:
        raise InputError(
            f"{file}: no XML: {error}; xacro files have to be expanded first"
        ) from None
    if root.tag != "robot":
        raise InputError(f"{file}: got <{root.tag}>; expected <robot>")
    return root


def _tree(file: Path) -> _Tree:
    root = _xml(file)
    links = tuple(link.get("name", "") for link in root.iter("link") if link.get("name"))
    joints = {joint.get("name", ""): joint for joint in root.findall("joint")}
    tree = _Tree(file, {_link_of(j, "child"): j for j in joints.values()}, joints, links)
    if root.get("version") != "1.2" and next(root.iter("capsule"), None) is not None:
        raise InputError(f'{file}: capsules need <robot version="1.2">; without, they are dropped')
    for name, joint in joints.items():
        for side in ("parent", "child"):
            _demand_link(tree, _link_of(joint, side), f"{side} of joint {name}")
        _demand_usable(file, name, joint)
    return tree


def _link_of(joint: ET.Element, side: str) -> str:
    element = joint.find(side)
    return element.get("link", "") if element is not None else ""


def _demand_link(tree: _Tree, link: str, where: str) -> None:
    if link not in tree.links:
        known = closest(link, [*tree.links])
        raise InputError(f"{tree.file}: {where}: no link {link!r}; {known}")


def _demand_usable(file: Path, name: str, joint: ET.Element) -> None:
    kind = joint.get("type", "")
    if kind not in ("fixed", *_MOVING):
        known = ", ".join(("fixed", *_MOVING))
        raise InputError(f"{file}: joint {name}: got type {kind!r}; expected one of: {known}")
    limit = joint.find("limit")
    speed = _number(limit, "velocity")
    if kind in _MOVING and not speed > 0.0:
        raise InputError(
            f"{file}: joint {name}: got velocity limit {speed:g}; expected more than 0, in "
            "rad/s or m/s: motions are timed by it"
        )
    if kind in ("revolute", "prismatic") and not _number(limit, "lower") < _number(limit, "upper"):
        raise InputError(f"{file}: joint {name}: its lower limit is not below its upper one")


def _number(element: ET.Element | None, name: str) -> float:
    try:
        return float(element.get(name, "0")) if element is not None else 0.0
    except ValueError:
        return float("nan")


def _only_arm(tree: _Tree) -> ArmSpec:
    inner = {_link_of(joint, "parent") for joint in tree.joints.values()}
    tips = [link for link in tree.links if link not in inner]
    turning = {tip: _turning(tree.chain(tip, None)) for tip in tips}
    chains = {joints for joints in turning.values() if joints}
    if len(chains) != 1:
        raise InputError(
            f"{tree.file}: got {len(chains)} chains of joints, to {', '.join(tips)}; expected "
            "one; try an SRDF that names the groups"
        )
    (joints,) = chains
    # Of several frames at the end, the first one that is fixed to the last joint.
    return ArmSpec(joints, next(tip for tip in tips if turning[tip] == joints))


def _turning(chain: list[ET.Element]) -> tuple[str, ...]:
    return tuple(joint.get("name", "") for joint in chain if joint.get("type") in _TURNING)


def _arms(tree: _Tree, srdf: ET.Element, file: Path) -> dict[str, ArmSpec]:
    groups = {group.get("name", ""): group for group in srdf.findall("group")}
    hands = {hand.get("group", ""): hand for hand in srdf.findall("end_effector")}
    arms: dict[str, ArmSpec] = {}
    for name, group in groups.items():
        joints, tip = _group(tree, group, f"{file}: group {name}")
        if joints and name not in hands:
            arms[name] = ArmSpec(joints, tip, _fingers(tree, groups, hands, name, file))
    if not arms:
        raise InputError(f"{file}: no group with joints that turn; expected one an arm")
    _demand_distinct(arms, file)
    return arms


def _group(tree: _Tree, group: ET.Element, where: str) -> tuple[tuple[str, ...], str]:
    """Return the turning joints of a group in chain order, and its last link."""
    chain = group.find("chain")
    if chain is not None:
        base, tip = chain.get("base_link", ""), chain.get("tip_link", "")
        for link in (base, tip):
            _demand_link(tree, link, where)
        return _turning(tree.chain(tip, base)), tip
    names = [joint.get("name", "") for joint in group.findall("joint")]
    for name in names:
        if name not in tree.joints:
            raise InputError(f"{where}: no joint {name!r}; {closest(name, [*tree.joints])}")
    turning = tuple(name for name in names if tree.joints[name].get("type") in _TURNING)
    return turning, tree.below(names[-1]) if names else ""


def _fingers(
    tree: _Tree,
    groups: Mapping[str, ET.Element],
    hands: Mapping[str, ET.Element],
    arm: str,
    file: Path,
) -> tuple[str, ...]:
    mine = [name for name, hand in hands.items() if hand.get("parent_group") == arm]
    joints: list[str] = []
    for name in mine:
        if name not in groups:
            known = closest(name, [*groups])
            raise InputError(f"{file}: hand of {arm}: no group {name!r}; {known}")
        joints += [joint.get("name", "") for joint in groups[name].findall("joint")]
    return tuple(
        name for name in joints if name in tree.joints and tree.joints[name].get("type") in _MOVING
    )


def _demand_distinct(arms: Mapping[str, ArmSpec], file: Path) -> None:
    owners: dict[str, str] = {}
    for arm, spec in arms.items():
        for joint in spec.joints:
            if joint in owners:
                raise InputError(
                    f"{file}: joint {joint} is in the groups {owners[joint]} and {arm}; "
                    "expected each joint in one arm"
                )
            owners[joint] = arm


def _overlaps(tree: _Tree, srdf: ET.Element, file: Path) -> tuple[tuple[str, str], ...]:
    pairs = []
    for element in srdf.findall("disable_collisions"):
        pair = element.get("link1", ""), element.get("link2", "")
        for link in pair:
            _demand_link(tree, link, f"{file}: disable_collisions")
        pairs.append(pair)
    return tuple(pairs)
