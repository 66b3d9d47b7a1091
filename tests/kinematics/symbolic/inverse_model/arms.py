"""Arms of every class that is solved on paper: random tables, and the closed form as a judge."""

from __future__ import annotations

import math

import numpy as np

from dh_to_urdf.table import Convention, DHRow, DHTable, JointType
from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.inverse.closed_form import closed_form_of, solutions
from kinematics.jacobian import jacobian
from kinematics.task import TASKS

CLASSES = (
    *("elbow", "three_parallel_then_wrist", "shoulder", "column", "telescope", "general"),
    *("parallel_axes", "parallel_axes_apart", "planar_2r", "planar_3r", "scara", "srs"),
)
PLANAR = ("planar_2r", "planar_3r")
RIGHT = math.pi / 2
SWIVEL = 0.7


def random_table(name, seed, *, any_twist=False):
    """A table of a class: lengths, signs, offsets, base and tool at random.

    With ``any_twist`` the twists that are not 0 or pi are any, else right angles.
    """
    rng = np.random.default_rng(seed)
    convention = list(Convention)[seed % 3]
    links = _links(name, rng, any_twist)
    rows = []
    for k, (kind, _, d, _) in enumerate(links):
        own = convention is Convention.STANDARD
        before = links[k - 1] if k else ("R", 0.0, 0.0, 0.0)
        _, a, _, alpha = links[k] if own else before
        slides = kind == "P"
        rows.append(
            DHRow(
                name=f"j{k + 1}",
                type=JointType.PRISMATIC if slides else JointType.REVOLUTE,
                alpha=alpha,
                a=a,
                d=0.0 if slides else d,
                theta=float(rng.choice([0.0, RIGHT, -RIGHT, 0.3])) if slides else 0.0,
                parent=k,
                offset=d if slides else float(rng.choice([0.0, RIGHT, -RIGHT, math.pi, 0.4])),
                sign=int(rng.choice([1, -1])),
            )
        )
    upright = name in PLANAR
    base = _placement(rng, int(rng.choice([0, 1, 3] if upright else [0, 1, 2, 3])))
    tool = _placement(rng, int(rng.choice([0, 1] if upright else [0, 1, 2, 3])))
    if name == "planar_2r" and convention is not Convention.STANDARD:
        tool[0, 3] += 1.0
    return DHTable("random", convention, tuple(rows), base, tool)


def _links(name, rng, any_twist):
    """Joint type, a, d and alpha of each joint and the link after it (Paul's order)."""

    def length(wanted=None):
        wanted = rng.random() < 0.6 if wanted is None else wanted
        size = rng.uniform(0.2, 0.9) * rng.choice([1, -1])
        return float(np.round(size, 3)) if wanted else 0.0

    def across():
        return float(rng.uniform(0.4, 2.6) if any_twist else RIGHT) * float(rng.choice([1, -1]))

    def along():
        return float(rng.choice([0.0, math.pi]))

    def turn(a, d, alpha):
        return ("R", length(a), length(d), alpha)

    wrist = [turn(False, True, across()), turn(False, False, across()), turn(None, None, across())]
    if name == "elbow":
        return [turn(None, None, across()), turn(True, None, along()), turn(None, None, across()),
                *wrist]  # fmt: skip
    if name == "three_parallel_then_wrist":
        return [turn(None, None, across()), turn(True, None, along()), turn(True, None, along()),
                *wrist]  # fmt: skip
    if name == "shoulder":
        return [turn(False, None, across()), turn(None, True, across()),
                turn(None, None, across()), *wrist]  # fmt: skip
    if name == "column":
        return [turn(True, None, along()), turn(None, None, across()), turn(None, None, across()),
                *wrist]  # fmt: skip
    if name == "telescope":
        return [turn(False, None, across()), turn(None, None, across()),
                ("P", length(), length(), float(rng.choice([0.0, RIGHT]))), *wrist]  # fmt: skip
    if name == "general":
        return [turn(True, None, across()), turn(None, None, across()), turn(None, None, across()),
                *wrist]  # fmt: skip
    if name in ("parallel_axes", "parallel_axes_apart"):
        return [turn(None, None, across()), turn(True, None, along()), turn(True, None, along()),
                turn(None, None, across()), turn(name != "parallel_axes", None, across()),
                turn(None, None, across())]  # fmt: skip
    if name == "srs":
        return [turn(False, None, across()), turn(False, False, across()),
                turn(None, True, across()), turn(None, None, across()), *wrist]  # fmt: skip
    links = [turn(True, None, along()) for _ in range(2 if name == "planar_2r" else 3)]
    if name == "scara":
        links.insert(int(rng.integers(0, 4)), ("P", length(), length(), along()))
    return links


def _placement(rng, kind):
    """Nothing, a shift, a shift and any rotation, or a half turn about x."""
    T = np.eye(4)
    if kind:
        T[:3, 3] = np.round(rng.uniform(-0.5, 0.5, 3), 3)
    if kind == 2:
        q, r = np.linalg.qr(rng.normal(size=(3, 3)))
        q *= np.sign(np.diag(r))
        T[:3, :3] = q * np.sign(np.linalg.det(q))
    if kind == 3:
        T[:3, :3] = np.diag([1.0, -1.0, -1.0])
    return T


class Judge:
    """All solutions of the service's closed form, and how they compare with others.

    Of an arm with a swivel angle those at ``SWIVEL``.
    """

    def __init__(self, robot):
        self.robot = robot
        self.chain = chain_of(robot, robot.tip_frame)
        self.form = closed_form_of(self.chain.mechanism)
        self.turns = robot.is_revolute[self.chain.columns]

    def targets(self, count, seed):
        """Poses of the tip at random q, shape (count, 4, 4)."""
        q = np.random.default_rng(seed).uniform(-3, 3, (count, self.robot.dof))
        q[:, ~self.robot.is_revolute] /= 3
        return fk(self.robot, q)[self.robot.tip_frame]

    def solutions(self, T):
        """q, shape (n, dof), and the names of their postures."""
        task = TASKS[self.form.tasks[0]]
        found = solutions(self.form, self.chain.mechanism, T, task=task, swivel=SWIVEL)
        q = found.q
        if self.chain.inverse is not None:
            q = (q - self.chain.offset) @ self.chain.inverse.T
        return q, found.postures(self.form)

    def check(self, T, given):
        """That solutions (q, posture) are those of the closed form, one for one."""
        q, postures = self.solutions(T)
        assert len(given) == len(q), (len(given), len(q))
        left = list(range(len(q)))
        for values, posture in given:
            apart = self.apart(np.array(values)[self.chain.columns], q[left])
            nearest = left.pop(int(apart.argmin()))
            assert apart.min() <= self.allowed(q[nearest]), apart.min()
            assert tuple(name for name in posture if name) == postures[nearest]

    def apart(self, one, others):
        """Largest difference of joints, rad or m, on the circle; shape (n,)."""
        difference = one - others
        on_circle = (difference + math.pi) % (2 * math.pi) - math.pi
        return np.abs(np.where(self.turns, on_circle, difference)).max(axis=1)

    def allowed(self, q):
        """1e-10, and more where the arm is so near to a singularity that rounding is amplified."""
        full = np.zeros(self.robot.dof)
        full[self.chain.columns] = q
        J = jacobian(self.robot, full)
        values = np.linalg.svd(J, compute_uv=False)
        real = values[: np.linalg.matrix_rank(J, tol=1e-9 * values[0])]
        return max(1e-10, 1e-14 * (real[0] / real[-1]) ** 2)
