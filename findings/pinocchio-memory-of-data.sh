#!/usr/bin/env bash
# Expected: the working memory of a model (pinocchio.Data) grows at most with the square of its
# joints, as the largest matrices of its algorithms do (mass matrix, Jacobians, Coriolis).
#
# What happens (pin 4.1.0): it grows with the cube. createData() makes room for second derivatives of
# the dynamics (such as d2tau_dqdq, nv x nv x nv numbers), whether they will be computed or not: a
# chain of 200 joints takes half a GB for one thread, where its forward kinematics needs some kB.
#
# Why it matters: a service that loads a humanoid with hands, and keeps one Data a thread, is out of
# memory with a handful of robots that are small files. Build the model on the chain that is asked
# for, or compute from the placements of its joints.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pin==4.1.0
"$work/venv/bin/python" - <<'PYTHON'
import subprocess
import sys

CODE = """
import resource, sys
import numpy as np, pinocchio as pin
model, joint = pin.Model(), 0
for k in range(int(sys.argv[1])):
    joint = model.addJoint(joint, pin.JointModelRZ(), pin.SE3.Identity(), f"j{k}")
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
data = model.createData()
pin.forwardKinematics(model, data, np.zeros(model.nq))
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024)
"""
taken = {}
for joints in (50, 100, 200):
    out = subprocess.run([sys.executable, "-c", CODE, str(joints)], capture_output=True, text=True, check=True)
    taken[joints] = float(out.stdout)
    print(f"{joints} joints: {taken[joints]:.0f} MB")
growth = taken[200] / taken[100]
print(f"twice the joints take {growth:.1f} times the memory")
assert growth > 5.5 and taken[200] > 100, "this has changed"
PYTHON
