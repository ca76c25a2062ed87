"""Speeds, forces and clearances of what an arm does at a shelf."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ShelfArmSettings:
    """How the arm goes about it; the defaults suit packages of up to a kilogram.

    Attributes:
        before_m: How far before the shelf the tip stands before it goes in.
        push_height_m: Middle of the blade above what the object stands on.
        cup_height_m: The same when the cups take hold, at least.
        push_speed_m_s: Of the blade while it pushes.
        entry_speed_m_s: Of the tool on its way in.
        touch_speed_m_s: Of the cups when they come up to a face.
        carry_speed_m_s: Of what is carried.
        lower_speed_m_s: Of what is lowered to the floor.
        floor_force_n: More force than this from below is the floor.
        entry_force_n: More force than this on the way in means that something is in the way; a
            light box slides before a greater one is felt.
        touch_force_n: The cups press on a face no harder.
        caught_force_n: More force than this on the way out means that what is carried is caught.
        wedge_force_n: No push is harder.
        rise_n: What a pushed object meets when the force rises by that much, and
        rise_share: by that share of what it took to slide.
        felt_n: Least force that counts as touch.
        lift_m: How high things are carried over the floor.
        face_slack_m: How much nearer or farther than seen a face may be.
        seal_wait_s: How long to wait for the cups to seal.
        clear_m: Between what is carried and the front of the shelf.
        back_off_m: How far the blade leaves what it has pushed before it comes out.
    """

    before_m: float = 0.05
    push_height_m: float = 0.042
    cup_height_m: float = 0.042
    push_speed_m_s: float = 0.06
    entry_speed_m_s: float = 0.12
    touch_speed_m_s: float = 0.04
    carry_speed_m_s: float = 0.15
    lower_speed_m_s: float = 0.02
    floor_force_n: float = 1.0
    entry_force_n: float = 0.25
    touch_force_n: float = 2.0
    caught_force_n: float = 1.5
    wedge_force_n: float = 15.0
    rise_n: float = 0.4
    rise_share: float = 0.25
    felt_n: float = 0.15
    lift_m: float = 0.008
    face_slack_m: float = 0.015
    seal_wait_s: float = 0.6
    clear_m: float = 0.03
    back_off_m: float = 0.005
