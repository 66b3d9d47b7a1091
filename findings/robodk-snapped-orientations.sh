#!/usr/bin/env bash
# Expected: RoboDK's conversions between poses and makers' orientations (robodk.robomath) give an
# orientation back to rounding, as those of KUKA, Fanuc and Stäubli do.
#
# What happens (robodk 6.0.2): orientations close to special ones are moved onto them, by more than
# robots repeat.
# - pose_2_quaternion (which Pose_2_ABB uses): within .00044 rad (.025 degrees) of a half turn the
#   rest of the turn is dropped, as the test is on the cosine of the angle, whose error of 1e-7 is an
#   angle of 4.5e-4. A turn of less than 4.4e-5 rad becomes none.
# - Pose_2_Adept and Pose_2_Comau (Euler angles Z, Y, Z): a tilt of less than 1.4e-5 rad becomes
#   none, by the same kind of test.
#
# Why it matters: a tool that points down is half a turn from the base frame, so that this is where
# most poses of an ABB robot are: a tool that was aligned to .02 degrees loses it on the way to the
# controller, .3 mm at the end of one metre. Who takes this library for an oracle must keep away from
# half turns, or will look for a fault in his own code.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check robodk==6.0.2 numpy==2.4.6 scipy==1.17.1
"$work/venv/bin/python" -W ignore - <<'PYTHON'
import numpy as np
from robodk import robomath
from scipy.spatial.transform import Rotation


def pose(rotation):
    T = np.eye(4)
    T[:3, :3] = rotation.as_matrix()
    return robomath.Mat(T.tolist())


def moved(rotation, write, read):
    """Angle between a rotation and what comes back, rad."""
    back = np.array(read(write(pose(rotation))).Rows())[:3, :3]
    return (Rotation.from_matrix(back).inv() * rotation).magnitude()


quaternion = robomath.pose_2_quaternion, robomath.quaternion_2_pose
comau = robomath.Pose_2_Comau, robomath.Comau_2_Pose
kuka = robomath.Pose_2_KUKA, robomath.KUKA_2_Pose
down = Rotation.from_euler("x", np.pi)
seen = {}
for name, rotation, (write, read) in (
    ("quaternion, tool down, turned by 4e-4 rad", down * Rotation.from_euler("x", 4e-4), quaternion),
    ("quaternion, tool down, turned by 6e-4 rad", down * Rotation.from_euler("x", 6e-4), quaternion),
    ("quaternion, turned by 4e-5 rad", Rotation.from_euler("x", 4e-5), quaternion),
    ("Comau, tilted by 1e-5 rad", Rotation.from_euler("x", 1e-5), comau),
    ("Comau, tilted by 2e-5 rad", Rotation.from_euler("x", 2e-5), comau),
    ("KUKA, tilted by 1e-5 rad", Rotation.from_euler("x", 1e-5), kuka),
):
    seen[name] = moved(rotation, write, read)
    print(f"{name}: comes back {seen[name]:.1e} rad off")
lost = [abs(value) > 1e-6 for value in seen.values()]
assert lost == [True, False, True, True, False, False], "this has changed"
PYTHON
