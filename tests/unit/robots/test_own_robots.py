"""A robot of one's own: read by the same door, planned for by the same code, or clearly refused."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fake_arms import FakeArms

from executive.core.errors import InputError
from robots.descriptions import urdf_path
from robots.descriptions.own import robot_from_files
from robots.descriptions.specs import robot_spec, yumi_spec
from robots.interfaces import ARMS, MotionFailure, PoseGoal
from robots.motion.collision import CollisionModel
from robots.motion.model import RobotModel
from robots.motion.survey import survey
from robots.placement import YUMI_AT_TABLE, Placement, PlanningScene, table_scene
from robots.single_arm import PlannedArm

HERE = Placement((0.0, 0.0, 0.0), 0.0)


def link(name):
    """A link of 0.2 m along z."""
    return f"""<link name="{name}"><collision><origin xyz="0 0 0.1"/>
      <geometry><cylinder radius="0.03" length="0.16"/></geometry></collision></link>"""


def joint(number, axis, kind="revolute", limit='lower="-2.5" upper="2.5" velocity="2"'):
    return f"""<joint name="turn_{number}" type="{kind}"><origin xyz="0 0 0.2"/>
      <parent link="part_{number - 1}"/><child link="part_{number}"/><axis xyz="{axis}"/>
      <limit effort="10" {limit}/></joint>"""


AXES = ("0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1")
LINKS = "".join(link(f"part_{number}") for number in range(7))
JOINTS = "".join(joint(number, axis) for number, axis in enumerate(AXES, 1))


@pytest.fixture
def write(tmp_path):
    def written(name, body, tag="robot"):
        file = tmp_path / name
        file.write_text(f'<{tag} name="mine">{body}</{tag}>')
        return file

    return written


@pytest.fixture
def yumi_srdf(write):
    """The YuMi as an SRDF tells it."""
    lines = []
    for arm in ARMS:
        fingers = "".join(f'<joint name="{arm}_finger_{f}_joint"/>' for f in "ab")
        lines += [
            f'<group name="{arm}"><chain base_link="body" tip_link="{arm}_tcp"/></group>',
            f'<group name="{arm}_hand">{fingers}</group>',
            f'<end_effector name="{arm}_gripper" parent_link="{arm}_gripper_base"'
            f' group="{arm}_hand" parent_group="{arm}"/>',
            f'<disable_collisions link1="body" link2="{arm}_link_2"/>',
            f'<disable_collisions link1="{arm}_link_5" link2="{arm}_link_7"/>',
            f'<disable_collisions link1="{arm}_link_5" link2="{arm}_gripper_base"/>',
        ]
    lines.append('<group name="both"><group name="left"/><group name="right"/></group>')
    return write("yumi.srdf", "".join(lines))


def test_an_srdf_tells_arms_hands_and_overlaps(yumi_srdf):
    spec = robot_from_files(urdf_path("yumi"), yumi_srdf)
    ours = yumi_spec()
    assert list(spec.arms) == list(ours.arms)
    for arm in ARMS:
        assert spec.arms[arm].joints == ours.arms[arm].joints
        assert spec.arms[arm].fingers == ours.arms[arm].fingers
        assert spec.arms[arm].tcp == ours.arms[arm].tcp


def test_a_robot_from_files_moves_and_collides_as_the_one_of_the_tables(yumi_srdf, robot, rng):
    mine = RobotModel(robot_from_files(urdf_path("yumi"), yumi_srdf), YUMI_AT_TABLE)
    theirs, its = (CollisionModel(model, table_scene()) for model in (robot, mine))
    same = 0
    for q in rng.uniform(robot.limits.lower, robot.limits.upper, (200, 14)):
        for arm in ARMS:
            assert mine.tcp_pose(arm, q).isApprox(robot.tcp_pose(arm, q))
        same += theirs.collides(q) == its.collides(q)
    # Only the head box may be told apart by shape; an SRDF knows whole links.
    assert same >= 195


def test_what_is_measured_on_a_model_bounds_what_its_tables_say(yumi_srdf, robot):
    mine = RobotModel(robot_from_files(urdf_path("yumi"), yumi_srdf), YUMI_AT_TABLE)
    assert np.all(mine.levers_m >= 0.9 * robot.levers_m)
    assert np.all(mine.levers_m <= robot.levers_m + 0.12)
    for arm in ARMS:
        assert mine.kinematics[arm].reach_m >= robot.kinematics[arm].reach_m


def test_an_arm_without_an_srdf_is_planned_for(write):
    spec = robot_from_files(write("mine.urdf", LINKS + JOINTS))
    assert spec.arms["arm"].joints == tuple(f"turn_{number}" for number in range(1, 7))
    start = np.array([0.3, 0.6, 0.9, 0.2, 0.7, 0.0])
    driver = FakeArms(start, grippers=())
    arm = PlannedArm(driver, spec, PlanningScene(HERE), start, seed=0)
    position_m, quat_xyzw = arm.tcp_pose()
    elsewhere_m = position_m + np.array([0.0, -0.1, 0.05])
    plan = arm.plan(PoseGoal(elsewhere_m, quat_xyzw))
    assert not isinstance(plan, MotionFailure), plan
    arm.start(plan)
    driver.finish()
    assert arm.tcp_pose()[0] == pytest.approx(elsewhere_m, abs=1e-4)


def test_joints_that_turn_without_end_have_one_number_each(write):
    endless = joint(6, "0 0 1", "continuous", 'velocity="2"')
    body = LINKS + "".join(joint(n, axis) for n, axis in enumerate(AXES[:5], 1)) + endless
    model = RobotModel(robot_from_files(write("mine.urdf", body)), HERE)
    assert model.size == 6
    assert model.limits.upper[5] == pytest.approx(2 * np.pi)


def test_the_tool_can_be_named(write):
    file = write("mine.urdf", LINKS + JOINTS)
    assert robot_from_files(file, tcps={"arm": "part_5"}).arms["arm"].tcp == "part_5"
    with pytest.raises(InputError, match="did you mean 'part_5'"):
        robot_from_files(file, tcps={"arm": "part5"})
    with pytest.raises(InputError, match="no arm 'left'"):
        robot_from_files(file, tcps={"left": "part_5"})


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (LINKS + joint(1, "0 0 1", "planar"), "joint turn_1: got type 'planar'"),
        (LINKS + joint(1, "0 0 1", limit='lower="-1" upper="1"'), "velocity limit 0"),
        (LINKS + joint(1, "0 0 1", limit='lower="1" upper="-1" velocity="1"'), "lower limit"),
        (LINKS + joint(9, "0 0 1"), "parent of joint turn_9: no link 'part_8'; did you mean"),
        (LINKS, "got 0 chains of joints"),
        ('<link name="a"><collision><geometry><capsule radius="1" length="1"/></geometry>'
         "</collision></link>", "capsules need"),
    ],
)  # fmt: skip
def test_a_urdf_that_cannot_be_used_is_refused(write, body, says):
    with pytest.raises(InputError, match=says):
        robot_from_files(write("mine.urdf", body))


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ('<group name="arm"><chain base_link="part_0" tip_link="part_9"/></group>', "no link"),
        ('<group name="arm"><chain base_link="part_5" tip_link="part_2"/></group>', "not above"),
        ('<group name="arm"><joint name="turn1"/></group>', "did you mean 'turn_1'"),
        ('<group name="arm"/>', "no group with joints that turn"),
        ('<group name="a"><joint name="turn_1"/></group>'
         '<group name="b"><joint name="turn_1"/></group>', "in the groups a and b"),
        ('<group name="a"><joint name="turn_1"/></group>'
         '<disable_collisions link1="part_0" link2="parts_2"/>', "disable_collisions: no link"),
    ],
)  # fmt: skip
def test_an_srdf_that_does_not_fit_is_refused(write, body, says):
    with pytest.raises(InputError, match=says):
        robot_from_files(write("mine.urdf", LINKS + JOINTS), write("mine.srdf", body))


def test_files_that_are_none_are_refused(tmp_path, write):
    with pytest.raises(InputError, match="cannot be read"):
        robot_from_files(tmp_path / "missing.urdf")
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot>")
    with pytest.raises(InputError, match="no XML"):
        robot_from_files(broken)
    with pytest.raises(InputError, match="expected <robot>"):
        robot_from_files(write("other.urdf", "", tag="sdf"))


def test_shapes_are_asked_for(write):
    bare = "".join(f'<link name="part_{number}"/>' for number in range(7))
    with pytest.raises(InputError, match="no collision shapes"):
        RobotModel(robot_from_files(write("mine.urdf", bare + JOINTS)), HERE)


def test_pairs_that_can_never_part_are_named(write):
    wide = LINKS.replace('radius="0.03" length="0.16"', 'radius="0.25" length="0.5"')
    found = survey(robot_from_files(write("mine.urdf", wide + JOINTS)))
    assert ("part_0", "part_2") in found.always
    assert found.colliding == 1.0
    assert survey(yumi_spec()).always == ()


def test_an_unknown_robot_is_answered_with_the_closest():
    with pytest.raises(InputError, match="did you mean 'yumi'"):
        robot_spec("yumy")


def test_the_command_tells_what_is_made_of_the_files(write, tmp_path):
    def told(*files):
        command = [sys.executable, "-m", "robots.descriptions", *map(str, files)]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    fine = told(write("mine.urdf", LINKS + JOINTS))
    assert fine.returncode == 0
    assert "arm arm: turn_1, turn_2" in fine.stdout
    missing = told(Path(tmp_path / "missing.urdf"))
    assert missing.returncode == 2
    assert "cannot be read" in missing.stderr
