"""Inverse kinematics against other solvers; needs an environment of its own, see the lock file."""

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")  # matrices of six rows gain nothing from more
