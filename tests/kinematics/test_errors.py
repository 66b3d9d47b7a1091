"""Exceptions carry data: which argument, where in it, and what would be right."""

import re
from pathlib import Path

import numpy as np
import pytest

import kinematics
from kinematics.configuration import configuration, configuration_by_name
from kinematics.errors import (
    InvalidOption,
    InvalidTarget,
    KinematicsError,
    RankDeficient,
    RepresentationSingularity,
    UnknownSequence,
    UnknownTask,
    WrongConfiguration,
    WrongVector,
)
from kinematics.inverse import IKOptions, Tolerance
from kinematics.inverse.target import Targets, target_poses
from kinematics.manipulability_map import manipulability_map
from kinematics.orientation import analytic_map, parse_sequence
from kinematics.redundancy.methods import METHODS, method_from
from kinematics.redundancy.path.geometry import Circle, Sampling
from kinematics.redundancy.step import StepTask, differential_step
from kinematics.spatial_vectors import check_same_length, spatial_vector
from kinematics.task import TASKS, task_from
from kinematics.velocity import check_options
from robots.shipped import shipped_robot

TWIST_ROWS = ("vx", "vy", "vz", "wx", "wy", "wz")

SOURCES = Path(kinematics.__file__).parent
WEB = re.compile(r"pointer|/v1|DENAVIT_|angle=deg|If-Match|\bHTTP\b")


@pytest.fixture(scope="module")
def planar():
    return shipped_robot("planar_2r")


def raised(kind, call, *args, **options):
    with pytest.raises(kind) as caught:
        call(*args, **options)
    return caught.value


def test_no_source_knows_words_of_the_web():
    found = [
        f"{path.relative_to(SOURCES)}:{number}: {line.strip()}"
        for path in sorted(SOURCES.rglob("*.py"))
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if WEB.search(line)
    ]
    assert found == []


def test_an_error_of_no_argument_has_no_location():
    assert KinematicsError("no").location == ()
    assert KinematicsError("no", argument="q", index=(3, "x")).location == ("q", 3, "x")


def test_a_value_of_q_that_is_not_finite(planar):
    error = raised(WrongConfiguration, configuration, planar, [0.0, 1e9], "seed")
    assert str(error) == "seed of joint j2 is 1e+09, beyond ±1e6; give a finite value"
    assert (error.location, error.joint, error.value) == (("seed", 1), "j2", 1e9)
    assert (error.lower, error.upper) == (-1e6, 1e6)
    row = raised(WrongConfiguration, configuration, planar, [[0.0, 0.0], [np.nan, 0.0]])
    assert (row.location, row.joint) == (("q", 1, 0), "j1")


def test_a_q_of_a_wrong_length(planar):
    error = raised(WrongConfiguration, configuration, planar, [0.0], "q", (4,))
    assert (error.location, error.expected, error.known) == (("q", 4), 2, ("j1", "j2"))
    assert raised(WrongConfiguration, configuration, planar, "x").expected == 2
    assert raised(WrongConfiguration, configuration, planar, np.zeros((1, 1, 2))).expected == 2


def test_names_of_joints(planar):
    unknown = raised(WrongConfiguration, configuration_by_name, planar, {"a/b": 0.0})
    assert (unknown.location, unknown.value) == (("q", "a/b"), "a/b")
    assert unknown.known == ("j1", "j2")
    lacking = raised(WrongConfiguration, configuration_by_name, planar, {"j1": 0.0}, "seed")
    assert (lacking.location, lacking.missing) == (("seed",), ("j2",))


def test_twists():
    short = raised(WrongVector, spatial_vector, [1.0], TWIST_ROWS, "twist")
    assert (short.location, short.expected, short.rows) == (("twist",), 6, TWIST_ROWS)
    infinite = raised(WrongVector, spatial_vector, [0, 0, np.inf], TWIST_ROWS[:3], "twist", (7,))
    assert (infinite.location, infinite.value) == (("twist", 7, 2), np.inf)
    unequal = raised(WrongVector, check_same_length, np.zeros((2, 2)), np.zeros((3, 2)), "qd")
    assert (unequal.location, unequal.expected) == (("qd",), 2)


def test_tasks_and_sequences():
    task = raised(UnknownTask, task_from, "poze", "secondary", (0, "task"))
    assert (task.location, task.value) == (("secondary", 0, "task"), "poze")
    assert task.known == tuple(TASKS)
    sequence = raised(UnknownSequence, parse_sequence, "ZZX")
    assert (sequence.location, sequence.value) == (("euler",), "ZZX")
    singular = raised(RepresentationSingularity, analytic_map, np.eye(3), "ZXZ")
    assert (singular.location, singular.sequence) == (("euler",), "ZXZ")
    assert singular.determinant < 1e-9


def test_targets_are_named_by_their_place():
    many = Targets(count=2, location=("targets",), many=True)
    error = raised(InvalidTarget, target_poses, many, TASKS["pose"])
    assert str(error) == "task pose needs a position; give targets.0.position or .matrix"
    assert (error.location, error.task) == (("targets", 0, "position"), "pose")
    short = Targets(position=[[0, 0, 0]], rpy=[[0, 0]])
    error = raised(InvalidTarget, target_poses, short, TASKS["pose"])
    assert (error.location, error.expected) == (("target", "rpy"), 3)
    euler = Targets(position=[[0, 0, 0]], euler=("ZZX", [[0, 0, 0]]))
    error = raised(UnknownSequence, target_poses, euler, TASKS["pose"])
    assert error.location == ("target", "euler", "sequence")
    bad = Targets(
        matrix=np.stack((np.eye(4), 2 * np.eye(4))),
        count=2,
        location=("targets",),
        many=True,
        by_field=True,
    )
    error = raised(InvalidTarget, target_poses, bad, TASKS["pose"])
    assert error.location == ("targets", "matrix", 1)


@pytest.mark.parametrize(
    ("call", "options", "location", "value", "lower", "upper"),
    [
        (IKOptions, {"max_restarts": -1}, ("max_restarts",), -1, 0, 10_000),
        (IKOptions, {"tolerance": Tolerance(0.0)}, ("tolerance", "position"), 0.0, 1e-12, 1e3),
        (Sampling, {"tf": 0.0}, ("tf",), 0.0, 1e-6, 1e6),
        (Sampling, {"samples": 1}, ("samples",), 1, 2, 10_000),
        (
            Circle,
            {"center": np.zeros(3), "normal": np.ones(3), "turns": 200.0},
            ("circle", "turns"),
            200.0,
            -100.0,
            100.0,
        ),
        (check_options, {"damping": 0.0, "tolerance": 1.0}, ("tolerance",), 1.0, 0.0, 1.0),
    ],
)
def test_options_out_of_bounds(call, options, location, value, lower, upper):
    error = raised(InvalidOption, call, **options)
    assert error.location == location
    assert (error.value, error.lower, error.upper) == (value, lower, upper)


def test_unknown_names(planar):
    method = raised(InvalidOption, method_from, "magic", "methods", (2,))
    assert (method.location, method.value) == (("methods", 2), "magic")
    assert method.known == tuple(METHODS)
    joint = raised(InvalidOption, manipulability_map, planar, np.zeros(2), ("j1", "j9"), 9)
    assert (joint.location, joint.known) == (("joints", 1), ("j1", "j2"))


def test_a_lost_rank_names_the_tasks_that_the_arm_can_do(planar):
    pose = StepTask(np.zeros(6), TASKS["pose"])
    error = raised(RankDeficient, differential_step, planar, np.array([0.3, 0.4]), pose)
    assert (error.location, error.rank, error.wanted) == (("q",), 2, 6)
    assert "xy" in error.known
    straight = StepTask(np.zeros(2), TASKS["xy"])
    assert raised(RankDeficient, differential_step, planar, np.zeros(2), straight).known == ()
