"""`python -m robots.descriptions`: write the URDF files anew from the tables, or look at yours.

`python -m robots.descriptions` writes one URDF file a robot beside this module.
`python -m robots.descriptions YOURS.urdf [YOURS.srdf]` says what is made of a robot of your own.
"""

import sys
from pathlib import Path

from executive.core.errors import InputError
from robots.descriptions import DESCRIPTIONS, urdf_path
from robots.descriptions.own import robot_from_files
from robots.descriptions.urdf import to_urdf


def main() -> int:
    """Do what the command line says; 0 when all is well, 2 when a file cannot be used."""
    files = [Path(name) for name in sys.argv[1:]]
    if not files:
        write()
        return 0
    try:
        lines = report(*files[:2])
    except InputError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    sys.stdout.write("\n".join([*lines, ""]))
    return 0


def write() -> None:
    """Write the URDF files of the robots that ship with the package."""
    for name, describe in DESCRIPTIONS.items():
        urdf_path(name).write_text(to_urdf(describe()), encoding="utf-8")


def report(urdf: Path, srdf: Path | None = None) -> list[str]:
    """Return what is made of a robot, a line each.

    Raises:
        InputError: A file cannot be used.
    """
    from robots.motion.survey import survey

    found = survey(robot_from_files(urdf, srdf))
    lines = [f"{found.name}: {found.shapes} shapes, {found.pairs} pairs of links are checked"]
    for arm in found.arms:
        fingers = f", fingers {', '.join(arm.fingers)}" if arm.fingers else ""
        lines.append(
            f"arm {arm.name}: {', '.join(arm.joints)}; tool at {arm.tcp}{fingers}; "
            f"reach {arm.reach_m:.2f} m at most"
        )
    lines += [
        f"always in each other: {a} and {b}; where that is so by construction, add "
        f'<disable_collisions link1="{a}" link2="{b}"/> to the SRDF'
        for a, b in found.always
    ]
    lines.append(f"{100 * found.colliding:.0f} % of random configurations collide")
    return lines


if __name__ == "__main__":
    sys.exit(main())
