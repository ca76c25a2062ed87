"""Hands that reach everywhere take a cable, carry it and lay it down: for judging and imagining."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulation.cable.hands import DEPTH_M, WIDTH_M, GraspMode
from simulation.cable.rod import Rod

Floats = NDArray[np.float64]

SPEED_M_S, STEP_S, LIFT_M = 0.25, 0.01, 0.03
# How far apart open fingers are, as the YuMi's.
OPENING_M = 0.03
# Two hands come nearer to each other by so much each before one of them opens.
SLACK_M = 0.006


@dataclass(frozen=True, slots=True, eq=False)
class Carried:
    """What one hand does.

    Attributes:
        mode: Whether it holds the cable or lets it slide.
        from_m: Where it takes the cable, on the table, shape (2,).
        direction: Unit tangent of the cable there, shape (2,).
        to_m: Where it goes with it, shape (2,).
        lets_go: Share of the way after which it opens and stays.
    """

    mode: GraspMode
    from_m: Floats
    direction: Floats
    to_m: Floats
    lets_go: float = 1.0


def carry(rod: Rod, parts: Sequence[Carried], longest_rest_s: float) -> bool:
    """Take the cable, lift, go, lay down, let go, and wait until it rests.

    Args:
        rod: The cable, on the table.
        parts: What each hand does; they move in step.
        longest_rest_s: It is waited for so long at most.

    Returns:
        Whether every hand had taken the cable.
    """
    hands = {f"hand {k}": part for k, part in enumerate(parts)}
    height_m = rod.parameters.radius_m
    up_m = height_m + LIFT_M
    places_m = {hand: part.from_m for hand, part in hands.items()}
    for hand, part in hands.items():
        rod.move_hand(hand, _tool(part, part.from_m, height_m))
    rod.advance(STEP_S)
    held = [
        rod.close_hand(hand, part.mode, OPENING_M, DEPTH_M, WIDTH_M) for hand, part in hands.items()
    ]
    _move(rod, hands, places_m, places_m, (height_m, up_m))
    for share in sorted({1.0, *(part.lets_go for part in parts)}):
        ends_m = {hand: _on_way(part, share) for hand, part in hands.items()}
        _move(rod, hands, places_m, ends_m, (up_m, up_m))
        places_m = _nearer(ends_m)
        _move(rod, hands, ends_m, places_m, (up_m, up_m))
        for hand in [hand for hand, part in hands.items() if part.lets_go <= share < 1.0]:
            rod.release_hand(hand)
            del hands[hand]
    _move(rod, hands, places_m, places_m, (up_m, height_m))
    for hand in hands:
        rod.release_hand(hand)
    began_s = rod.time_s
    while not rod.at_rest and rod.time_s - began_s < longest_rest_s:
        rod.advance(0.25)
    return all(held)


def _on_way(part: Carried, share: float) -> Floats:
    place_m: Floats = part.from_m + share * (part.to_m - part.from_m)
    return place_m


def _nearer(places_m: Mapping[str, Floats]) -> dict[str, Floats]:
    """Return places of two hands a little nearer to each other: a taut cable is thrown."""
    if len(places_m) != 2:
        return dict(places_m)
    (first, first_m), (second, second_m) = places_m.items()
    gap_m = second_m - first_m
    nearer_m = SLACK_M * gap_m / max(float(np.linalg.norm(gap_m)), 1e-9)
    return {first: first_m + nearer_m, second: second_m - nearer_m}


def _move(
    rod: Rod,
    hands: Mapping[str, Carried],
    begin_m: Mapping[str, Floats],
    end_m: Mapping[str, Floats],
    heights_m: tuple[float, float],
) -> None:
    """Move hands between places and heights at a steady speed, in step."""
    ways_m = [float(np.linalg.norm(end_m[hand] - begin_m[hand])) for hand in hands]
    way_m = max(*ways_m, 0.0, abs(heights_m[1] - heights_m[0]))
    steps = max(round(way_m / SPEED_M_S / STEP_S), 1)
    for done in np.linspace(0.0, 1.0, steps + 1)[1:]:
        height_m = (1.0 - done) * heights_m[0] + done * heights_m[1]
        for hand, part in hands.items():
            place_m = (1.0 - done) * begin_m[hand] + done * end_m[hand]
            rod.move_hand(hand, _tool(part, place_m, height_m))
        rod.advance(STEP_S)


def _tool(part: Carried, place_m: Floats, height_m: float) -> Floats:
    """Return T_world_tcp of a gripper above a place that opens across the cable."""
    pose = np.eye(4)
    across = np.array([-part.direction[1], part.direction[0], 0.0])
    down = np.array([0.0, 0.0, -1.0])
    pose[:3, :3] = np.column_stack([across, np.cross(down, across), down])
    pose[:3, 3] = (*place_m, height_m)
    return pose
