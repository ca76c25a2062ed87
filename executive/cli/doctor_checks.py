"""What `cellwright doctor` tries: every library on a small task, then the cell itself."""

import os
import platform
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np

MIN_FREE_BYTES = 500_000_000


@dataclass(frozen=True, slots=True)
class Check:
    """One thing to try.

    Attributes:
        name: What is tried.
        attempt: Tries it; returns a few words on what was found, raises when it is broken.
        fix: What to do when it is broken.
    """

    name: str
    attempt: Callable[[], str]
    fix: str


class CheckError(Exception):
    """Something works, but not as it should; the message says what."""


def _reinstall(package: str) -> str:
    return f"pip install --force-reinstall {package}, or make setup in a clone"


def python() -> str:
    """Check the version of Python."""
    if platform.python_version_tuple()[:2] != ("3", "11"):
        raise CheckError(f"Python {platform.python_version()}; 3.11 is needed")
    return platform.python_version()


def numba() -> str:
    """Compile and run a function."""
    from numba import njit

    doubled = njit(lambda x: 2.0 * x)
    if doubled(21.0) != 42.0:
        raise CheckError("a compiled function gives a wrong answer")
    return version("numba")


def opencv() -> str:
    """Encode and decode an image."""
    import cv2

    image = np.arange(256, dtype=np.uint8).reshape(16, 16)
    encoded = cv2.imencode(".png", image)[1]
    decoded = cv2.imdecode(encoded, cv2.IMREAD_GRAYSCALE)
    if decoded is None or not np.array_equal(decoded, image):
        raise CheckError("an image does not survive being written and read")
    return version("opencv-python-headless")


def pybullet() -> str:
    """Let a ball fall."""
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setGravity(0, 0, -9.81, physicsClientId=client)
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_SPHERE, radius=0.1, physicsClientId=client
        )
        ball = pybullet.createMultiBody(1.0, shape, physicsClientId=client)
        pybullet.stepSimulation(physicsClientId=client)
        height_m = pybullet.getBasePositionAndOrientation(ball, physicsClientId=client)[0][2]
    finally:
        pybullet.disconnect(client)
    if not height_m < 0.0:
        raise CheckError("a ball does not fall")
    return version("pybullet")


def pinocchio() -> str:
    """Load the YuMi's description and put its joints somewhere."""
    import pinocchio

    from robots.descriptions import urdf_path

    model = pinocchio.buildModelFromUrdf(str(urdf_path("yumi")))
    pinocchio.forwardKinematics(model, model.createData(), pinocchio.neutral(model))
    return f"{version('pin')}, YuMi with {model.nq} joint positions"


def coal() -> str:
    """Measure the distance of two balls."""
    import coal

    ball, place = coal.Sphere(0.5), coal.Transform3s()
    place.setTranslation(np.array([2.0, 0.0, 0.0]))
    distance = coal.distance(
        ball, coal.Transform3s(), ball, place, coal.DistanceRequest(), coal.DistanceResult()
    )
    if abs(distance - 1.0) > 1e-6:
        raise CheckError(f"two balls 1 m apart are {distance:g} m apart")
    return version("coal")


def ruckig() -> str:
    """Time a motion of one joint."""
    from ruckig import InputParameter, Result, Ruckig, Trajectory

    wanted, found = InputParameter(1), Trajectory(1)
    wanted.target_position, wanted.max_velocity = [1.0], [1.0]
    wanted.max_acceleration, wanted.max_jerk = [1.0], [1.0]
    if Ruckig(1).calculate(wanted, found) not in (Result.Working, Result.Finished):
        raise CheckError("no trajectory for one joint")
    return version("ruckig")


def meshcat() -> str:
    """Find the page that views are shown in."""
    from importlib.resources import files

    page = files("meshcat") / "viewer/dist/main.min.js"
    if not page.is_file():
        raise CheckError("the viewer's page is missing")
    return version("meshcat")


def mcap() -> str:
    """Write and read a recording."""
    from io import BytesIO

    from mcap.reader import make_reader
    from mcap.writer import Writer

    file = BytesIO()
    writer = Writer(file)
    writer.start()
    channel = writer.register_channel("/x", "json", 0)
    writer.add_message(channel, 0, b"{}", 0)
    writer.flush()
    writer.finish()
    file.seek(0)
    if len(list(make_reader(file).iter_messages())) != 1:
        raise CheckError("a message does not come back")
    return version("mcap")


def py_trees() -> str:
    """Check the version that the engine is built on."""
    found = version("py_trees")
    if not found.startswith("2.6."):
        raise CheckError(f"py_trees {found}; 2.6 is needed")
    return found


def threads() -> str:
    """Look at how many threads the linear algebra may use."""
    cores, asked = os.cpu_count() or 1, os.environ.get("OMP_NUM_THREADS", "")
    if not asked and cores > 1:
        raise CheckError(f"{cores} cores, and OMP_NUM_THREADS is not set: runs are slower for it")
    return f"{asked or 1} of {cores} cores"


def runs_folder() -> str:
    """Write a file where recordings go."""
    folder = Path("runs")
    folder.mkdir(exist_ok=True)
    with tempfile.TemporaryFile(dir=folder) as file:
        file.write(b"x")
    free = shutil.disk_usage(folder).free
    if free < MIN_FREE_BYTES:
        raise CheckError(f"only {free / 1e6:.0f} MB left")
    return f"writable, {free / 1e9:.1f} GB left"


def trees() -> str:
    """Check every tree, mission and cell that ships."""
    from executive.app.catalogue import port_types, skills
    from executive.engine.loading.library import packaged_trees
    from executive.engine.loading.loader import check_files

    files = sorted(packaged_trees().rglob("*.yaml"))
    _, faults = check_files(files, skills=skills(), types=port_types())
    if faults:
        raise CheckError("; ".join(str(fault) for fault in faults[:3]))
    return f"{len(files)} documents"


def table_cell() -> str:
    """Open the cell of the untangling mission and take a picture."""
    from executive.app.catalogue import port_types, skills
    from executive.app.compose import open_cell
    from executive.engine.loading.loader import load_mission
    from perception.camera import Camera

    mission = load_mission("untangle", skills=skills(), types=port_types())
    cell = open_cell(mission.cell, mission.document.scenario, 0)
    try:
        camera = cell.devices["camera"]
        if not isinstance(camera, Camera):
            raise CheckError("the cell has no camera")
        image = camera.capture().image
    finally:
        cell.close()
    if int(image.max()) - int(image.min()) < 50:
        raise CheckError("the camera sees nothing but one shade")
    return f"camera {image.shape[1]} x {image.shape[0]} px, arms and planner loaded"


CHECKS = (
    Check("python", python, "install Python 3.11, then make setup"),
    Check("py_trees", py_trees, "pip install 'py_trees>=2.6,<2.7'"),
    Check("mcap", mcap, _reinstall("mcap")),
    Check("numba", numba, _reinstall("numba")),
    Check("opencv", opencv, _reinstall("opencv-python-headless")),
    Check("pinocchio", pinocchio, _reinstall("pin")),
    Check("coal", coal, _reinstall("coal")),
    Check("ruckig", ruckig, _reinstall("ruckig")),
    Check("pybullet", pybullet, _reinstall("pybullet")),
    Check("meshcat", meshcat, _reinstall("meshcat")),
    Check("threads", threads, "export OMP_NUM_THREADS=1"),
    Check("runs folder", runs_folder, "make room, or change to a folder that you may write to"),
    Check("trees", trees, "cellwright check FILE shows every fault"),
    Check("table cell", table_cell, "mend what is broken above first, then report this"),
)
WARNINGS = frozenset({"threads"})
