import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from kinematics.errors import RepresentationSingularity, UnknownSequence
from kinematics.orientation import (
    analytic_map,
    euler_angles,
    euler_rates_matrix,
    quaternion_xyzw,
    rpy,
)

PROPER = ["XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ"]
CARDAN = ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"]
SEQUENCES = [*PROPER, *CARDAN, *map(str.lower, PROPER + CARDAN)]
angle = st.floats(-np.pi, np.pi)


@pytest.mark.parametrize("sequence", SEQUENCES)
@given(angles=st.tuples(angle, angle, angle))
def test_both_solutions_give_the_rotation_back(sequence, angles):
    R = Rotation.from_euler(sequence, angles).as_matrix()
    for solution in euler_angles(R, sequence).solutions:
        again = Rotation.from_euler(sequence, solution).as_matrix()
        np.testing.assert_allclose(again, R, atol=2e-12, rtol=0)


@pytest.mark.parametrize("sequence", SEQUENCES)
@pytest.mark.parametrize("tilt", [0.0, 1e-15, 1e-9, 1e-7, 1e-5, 1e-3])
@pytest.mark.parametrize("side", [0, 1])
def test_degenerate_orientations_are_exact_and_flagged(sequence, tilt, side):
    proper = sequence[0] == sequence[2]
    middle = side * np.pi + tilt if proper else (np.pi / 2 if side else -np.pi / 2) + tilt
    R = Rotation.from_euler(sequence, (0.3, middle, -1.1)).as_matrix()
    found = euler_angles(R, sequence)
    assert bool(found.degenerate) == (tilt < 1e-12)
    if found.degenerate:
        phi = found.solutions[0][2 if sequence.islower() else 0]
        assert phi == 0.0
    for solution in found.solutions:
        again = Rotation.from_euler(sequence, solution).as_matrix()
        np.testing.assert_allclose(again, R, atol=2e-12, rtol=0)


def test_first_solution_has_the_conventional_middle_angle():
    R = Rotation.random(200, rng=np.random.default_rng(0)).as_matrix()
    for sequence in PROPER:
        middle = euler_angles(R, sequence).solutions[:, 0, 1]
        assert ((middle >= 0) & (middle <= np.pi)).all()
    for sequence in CARDAN:
        middle = euler_angles(R, sequence).solutions[:, 0, 1]
        assert (np.abs(middle) <= np.pi / 2).all()


@pytest.mark.parametrize("text", ["", "ZZ", "ZZX", "ZXX", "zXZ", "ABC", "ZXZX", "Z,X", "ＺＸＺ"])
def test_other_texts_are_no_sequence(text):
    with pytest.raises(UnknownSequence, match="ZXZ"):
        euler_angles(np.eye(3), text)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_rates_matrix_equals_finite_differences(sequence):
    rng = np.random.default_rng(1)
    for _ in range(5):
        angles, rates, h = rng.uniform(-1, 1, 3) + 0.1, rng.normal(size=3), 1e-6
        before = Rotation.from_euler(sequence, angles - h * rates)
        after = Rotation.from_euler(sequence, angles + h * rates)
        omega = (after * before.inv()).as_rotvec() / (2 * h)
        found = euler_rates_matrix(sequence, angles) @ rates
        np.testing.assert_allclose(found, omega, atol=1e-8)


def test_no_rates_where_the_angles_are_degenerate():
    with pytest.raises(RepresentationSingularity, match="another Euler sequence"):
        analytic_map(np.eye(3), "ZXZ")


def test_quaternion_and_rpy_agree_with_scipy():
    rotations = Rotation.random(100, rng=np.random.default_rng(2))
    R = rotations.as_matrix()
    np.testing.assert_allclose(quaternion_xyzw(R), rotations.as_quat(canonical=True), atol=1e-14)
    np.testing.assert_allclose(
        Rotation.from_euler("xyz", rpy(R)).as_matrix(), R, atol=1e-14, rtol=0
    )
