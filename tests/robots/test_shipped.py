import numpy as np
import pinocchio as pin
import pytest

from dh_to_urdf import dh_matrices
from robots.errors import RobotNotFound
from robots.shipped import (
    LIBRARY,
    is_shipped,
    shipped_file,
    shipped_ids,
    shipped_robot,
    urdf_path,
)

TWINS = [robot_id for robot_id in shipped_ids() if shipped_file(robot_id).twin]
ROUNDED = {"ur5_gripper": 1e-8}
CLOSE = {"panda_urdf": 1e-12} | dict.fromkeys(("ur3_urdf", "ur5_urdf", "ur10_urdf"), 1.5e-11)


def test_every_file_of_the_library_is_shipped():
    assert list(shipped_ids()) == sorted(path.stem for path in LIBRARY.glob("*.yaml"))
    assert len(shipped_ids()) >= 70


@pytest.mark.parametrize("robot_id", shipped_ids())
def test_a_shipped_robot_is_what_its_file_says(robot_id):
    head, robot = shipped_file(robot_id), shipped_robot(robot_id)
    assert head.title
    assert head.source
    assert robot.dof == head.dof
    assert len(robot.moving) == robot.model.nv
    assert robot.tip_frame == (head.tip or robot.tip_frame)
    assert robot.base_frame == (head.base or robot.base_frame)
    assert robot.kind == ("urdf" if head.urdf else "dh")
    assert shipped_robot(robot_id) is robot


@pytest.mark.parametrize("robot_id", shipped_ids())
def test_the_tip_of_a_shipped_robot_moves(robot_id, poses):
    robot = shipped_robot(robot_id)
    tips = [
        poses(robot, np.full(robot.dof, q), [robot.tip_frame])[robot.tip_frame] for q in (0.1, 0.2)
    ]
    assert np.abs(tips[0] - tips[1]).max() > 1e-3


@pytest.mark.parametrize("robot_id", shipped_ids())
def test_limits_of_a_shipped_robot_are_in_order(robot_id):
    robot = shipped_robot(robot_id)
    assert (robot.lower <= robot.upper).all()
    for joint in robot.joints:
        assert (joint.lower is None) == (joint.upper is None)
        assert joint.velocity is None or joint.velocity >= 0


@pytest.mark.parametrize("robot_id", TWINS)
def test_a_table_and_a_urdf_of_the_same_arm_agree(robot_id, poses):
    head, urdf = shipped_file(robot_id), shipped_robot(robot_id)
    table = shipped_robot(head.twin)
    assert (table.kind, urdf.kind) == ("dh", "urdf")
    rng, worst = np.random.default_rng(0), 0.0
    for _ in range(50):
        q = rng.uniform(-np.pi, np.pi, urdf.dof)
        expected = poses(urdf, q, [head.twin_tip])[head.twin_tip]
        found = poses(table, q[: table.dof], [table.tip_frame])[table.tip_frame]
        worst = max(worst, np.abs(found - expected).max())
    assert worst < ROUNDED.get(robot_id, CLOSE.get(robot_id, 2e-11))


def test_known_twins_are_among_the_twins():
    assert {*ROUNDED, *CLOSE} <= set(TWINS)
    assert {shipped_file(robot_id).twin for robot_id in TWINS} == {"panda", "ur3", "ur5", "ur10"}


def test_frames_of_the_panda_are_its_links(poses):
    table, urdf = shipped_robot("panda"), shipped_robot("panda_urdf")
    q = np.random.default_rng(1).uniform(-2, 2, urdf.dof)
    found, expected = poses(table, q[:7]), poses(urdf, q)
    for k in range(8):
        assert np.abs(found[f"frame_{k}"] - expected[f"panda_link{k}"]).max() < 1e-12


@pytest.mark.parametrize(
    ("robot_id", "name"),
    [("puma560", "Puma560"), ("stanford", "Stanford"), ("scara", "MDH_SCARA_RRPR")],
)
def test_tables_of_the_library_are_those_of_the_reference(robot_id, name, oracle_documents):
    robot = shipped_robot(robot_id)
    (configs,) = (r["configs"] for r, _ in oracle_documents if r["name"] == name)
    for config in configs:
        assert np.abs(dh_matrices(robot.table, config["q"]).T - config["fkine"]).max() < 1e-12


def test_links_of_a_urdf_are_found_where_pinocchio_alone_finds_them(poses):
    robot = shipped_robot("ur5_urdf")
    model = pin.buildModelFromUrdf(str(urdf_path(shipped_file("ur5_urdf").urdf)))
    data = model.createData()
    q = np.array([0.1, -0.2, 0.3, -0.4, 0.5, -0.6])
    pin.framesForwardKinematics(model, data, q)
    base = data.oMf[model.getFrameId("base_link")]
    for name, T in poses(robot, q).items():
        expected = base.actInv(data.oMf[model.getFrameId(name)]).homogeneous
        assert np.abs(T - expected).max() < 1e-15


@pytest.mark.parametrize("robot_id", ["", "..", "../library/ur5", "UR5", "nothing", "a\x00b", "é"])
def test_other_ids_are_not_shipped(robot_id):
    assert not is_shipped(robot_id)
    with pytest.raises(RobotNotFound):
        shipped_file(robot_id)
