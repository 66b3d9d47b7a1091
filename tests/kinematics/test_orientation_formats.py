"""Orientations of makers: there and back, and as robodk's mathematics has them."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinematics.orientation_formats import FORMATS

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # of a renamed import that is not used here
    from robodk import robomath

RIGHT_ANGLES = 49


@pytest.fixture(scope="module", params=[500, pytest.param(10_000, marks=pytest.mark.slow)])
def rotations(request) -> np.ndarray:
    """Random ones, and those at which some format has no unique values."""
    random = Rotation.random(request.param, random_state=17).as_matrix()
    right = Rotation.create_group("O").as_matrix()
    near = (Rotation.create_group("O") * Rotation.from_rotvec([1e-9, -2e-9, 3e-10])).as_matrix()
    return np.concatenate((random, right, near, np.eye(3)[None]))


@pytest.mark.parametrize("name", FORMATS)
def test_there_and_back(name, rotations):
    found = FORMATS[name]
    values = found.values(rotations)
    assert values.shape == (len(rotations), found.size)
    again = np.array([found.rotation(row) for row in values])
    assert np.abs(again - rotations).max() < 1e-12
    one = found.values(rotations[0])
    assert np.abs(one - values[0]).max() < 1e-12


def _angles(to_pose, values):
    return np.array(to_pose([0.0, 0.0, 0.0, *np.rad2deg(values)]).Rows())


ROBODK = {
    "kuka_abc": lambda v: _angles(robomath.KUKA_2_Pose, v),
    "fanuc_wpr": lambda v: _angles(robomath.Fanuc_2_Pose, v),
    "yaskawa_rxryrz": lambda v: _angles(robomath.Motoman_2_Pose, v),
    "denso_rxryrz": lambda v: _angles(robomath.Fanuc_2_Pose, v),
    "staubli_rxryrz": lambda v: _angles(robomath.Staubli_2_Pose, v),
    "kawasaki_oat": lambda v: _angles(robomath.Adept_2_Pose, v),
    "comau_euler": lambda v: _angles(robomath.Comau_2_Pose, v),
    "ur_rotation_vector": lambda v: np.array(robomath.UR_2_Pose([0, 0, 0, *v]).Rows()),
    "rotation_vector": lambda v: np.array(robomath.UR_2_Pose([0, 0, 0, *v]).Rows()),
    "abb_quaternion": lambda v: np.array(robomath.quaternion_2_pose(list(v)).Rows()),
    "quaternion_wxyz": lambda v: np.array(robomath.quaternion_2_pose(list(v)).Rows()),
}
"""What robodk makes of the values; it knows no Denso, whose angles are written like Fanuc's."""


@pytest.mark.parametrize("name", FORMATS)
def test_robodk_reads_the_same_rotation(name, rotations):
    values = FORMATS[name].values(rotations[:-RIGHT_ANGLES])
    found = np.array([ROBODK[name](row)[:3, :3] for row in values])
    assert np.abs(found - rotations[:-RIGHT_ANGLES]).max() < 1e-9


def test_where_values_are_not_unique():
    quarter = Rotation.from_euler("y", np.pi / 2).as_matrix()
    assert FORMATS["kuka_abc"].is_degenerate(quarter)
    assert not FORMATS["kawasaki_oat"].is_degenerate(quarter)
    assert FORMATS["kawasaki_oat"].is_degenerate(np.eye(3))
    assert not FORMATS["ur_rotation_vector"].is_degenerate(np.eye(3))
    half = Rotation.from_rotvec([np.pi, 0, 0]).as_matrix()
    assert FORMATS["ur_rotation_vector"].is_degenerate(half)


def test_a_quaternion_of_another_norm_is_none():
    with pytest.raises(ValueError, match="w, x, y, z"):
        FORMATS["abb_quaternion"].rotation(np.array([1.0, 1.0, 0.0, 0.0]))
