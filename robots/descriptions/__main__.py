"""`python -m robots.descriptions` writes the URDF files anew from the tables."""

from robots.descriptions import DESCRIPTIONS, urdf_path
from robots.descriptions.urdf import to_urdf


def main() -> None:
    """Write one URDF file a robot beside this module."""
    for name, describe in DESCRIPTIONS.items():
        urdf_path(name).write_text(to_urdf(describe()), encoding="utf-8")


if __name__ == "__main__":
    main()
