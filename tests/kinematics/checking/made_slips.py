"""Slips made on purpose, with code of their own: tables as lists, matrices written out.

``python -m tests.kinematics.checking.made_slips 2000`` prints how many are diagnosed.
"""

import math
import sys
import time
from collections import Counter
from dataclasses import dataclass, replace
from itertools import count, islice

import numpy as np

from dh_to_urdf import read_mapping
from dh_to_urdf.table import Convention
from kinematics.checking.check import check_answer
from kinematics.checking.question import Quantity, Question
from robots.robot import robot_from_table
from robots.shipped import shipped_robot

LIBRARY = (
    "planar_2r", "planar_3r", "puma560", "pa10", "scara", "stanford", "ur5e", "ur10", "rx90",
    "panda", "iiwa14", "abb_irb140", "kr6_r900", "xarm7", "ur3",
)  # fmt: skip
RIGHT_ANGLES = (0.0, math.pi / 2, -math.pi / 2)


def rotation(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    T = np.eye(4)
    i, j = {"x": (1, 2), "z": (0, 1)}[axis]
    T[i, i], T[i, j], T[j, i], T[j, j] = c, -s, s, c
    return T


def shift(axis, length):
    T = np.eye(4)
    T["xyz".index(axis), 3] = length
    return T


@dataclass(frozen=True)
class Arm:
    """A table as a student has it on paper: one list a column."""

    standard: bool
    alpha: tuple
    a: tuple
    d: tuple
    theta: tuple
    offset: tuple
    sign: tuple
    slides: tuple
    q: tuple
    base: np.ndarray
    tool: np.ndarray
    backwards: bool = False
    left_out: tuple = ()

    def links(self):
        found = []
        for k, q in enumerate(self.q):
            v = self.sign[k] * q + self.offset[k]
            theta, d = (self.theta[k], v) if self.slides[k] else (v, self.d[k])
            about_z = rotation("z", theta) @ shift("z", d)
            about_x = shift("x", self.a[k]) @ rotation("x", self.alpha[k])
            found.append(about_z @ about_x if self.standard else about_x @ about_z)
        return found

    def frames(self):
        frames = [self.base]
        for k, A in enumerate(self.links()):
            frames.append(frames[-1] if k in self.left_out else frames[-1] @ A)
        return frames

    def pose(self):
        if not self.backwards:
            return self.frames()[-1] @ self.tool
        T = self.base
        for A in reversed(self.links()):
            T = T @ A
        return T @ self.tool

    def jacobian(self, point=None):
        frames, tip = self.frames(), self.pose()[:3, 3] if point is None else point
        columns = []
        for k, slides in enumerate(self.slides):
            frame = frames[k] if self.standard else frames[k + 1]
            z = frame[:3, 2] * self.sign[k]
            linear = z if slides else np.cross(z, tip - frame[:3, 3])
            columns.append(np.concatenate((linear, np.zeros(3) if slides else z)))
        return np.array(columns).T


def arm_of(robot, q):
    table = robot.table
    columns = {
        name: tuple(getattr(row, name) for row in table.rows)
        for name in ("alpha", "a", "d", "theta", "offset", "sign")
    }
    slides = tuple(not row.type.is_revolute for row in table.rows)
    standard = table.convention is Convention.STANDARD
    return Arm(standard, **columns, slides=slides, q=tuple(q), base=table.base, tool=table.tool)


def with_entry(values, k, value):
    return (*values[:k], value, *values[k + 1 :])


def scaled_angles(arm, factor):
    q = tuple(x if p else factor * x for x, p in zip(arm.q, arm.slides, strict=True))
    return replace(arm, q=q)


def shifted(values, step):
    return (*values[1:], 0.0) if step > 0 else (0.0, *values[:-1])


def choose(random, places):
    return int(random.choice(places)) if len(places) else None


def on_one(column, change):
    def slip(arm, random):
        values = getattr(arm, column)
        k = choose(random, [k for k, x in enumerate(values) if abs(x) > 1e-9])
        if k is None:
            return None
        return replace(arm, **{column: with_entry(values, k, change(values[k]))})

    return slip


def neighbours_alpha(arm, random):
    step = int(random.choice([1, -1]))
    moved = shifted(arm.alpha, step)
    if random.random() < 0.5:
        return replace(arm, alpha=moved)
    k = int(random.integers(len(moved)))
    if not 0 <= k + step < len(moved):
        return None
    return replace(arm, alpha=with_entry(arm.alpha, k, moved[k]))


def negative_q(arm, random):
    k = int(random.integers(len(arm.q)))
    return replace(arm, q=with_entry(arm.q, k, -arm.q[k]))


def exchanged_q(arm, random):
    if len(arm.q) < 2:
        return None
    k = int(random.integers(len(arm.q) - 1))
    q = list(arm.q)
    q[k], q[k + 1] = q[k + 1], q[k]
    return replace(arm, q=tuple(q))


def left_out_row(arm, random):
    if len(arm.q) < 3:
        return None
    return replace(arm, left_out=(int(random.integers(len(arm.q))),))


IN_NUMBERS = {
    "degrees_for_radians": lambda arm, random: scaled_angles(arm, 180 / math.pi),
    "radians_for_degrees": lambda arm, random: scaled_angles(arm, math.pi / 180),
    "other_convention": lambda arm, random: replace(arm, standard=not arm.standard),
    "alpha_of_neighbour_row": neighbours_alpha,
    "alpha_sign": on_one("alpha", lambda x: -x),
    "a_sign": on_one("a", lambda x: -x),
    "d_sign": on_one("d", lambda x: -x),
    "d_missing": on_one("d", lambda x: 0.0),
    "offset_missing": on_one("offset", lambda x: 0.0),
    "tool_forgotten": lambda arm, random: replace(arm, tool=np.eye(4)),
    "base_forgotten": lambda arm, random: replace(arm, base=np.eye(4)),
    "joint_sign": negative_q,
    "joints_in_other_order": exchanged_q,
}
OF_POSES = {
    "order_reversed": lambda arm, random: replace(arm, backwards=True),
    "row_missing": left_out_row,
}
IN_POSES = {
    "transposed": lambda T: np.block([[T[:3, :3].T, T[:3, 3:]], [T[3:]]]),
    "inverted": np.linalg.inv,
    "mm_for_m": lambda T: np.block([[T[:3, :3], 1000 * T[:3, 3:]], [T[3:]]]),
}


def in_frame(arm, J):
    R = arm.pose()[:3, :3]
    return np.vstack((R.T @ J[:3], R.T @ J[3:]))


IN_JACOBIANS = {
    "rows_swapped": lambda arm: (lambda J: np.vstack((J[3:], J[:3])))(arm.jacobian()),
    "other_point": lambda arm: arm.jacobian(np.zeros(3)),
    "other_frame": lambda arm: in_frame(arm, arm.jacobian()),
}


def random_robot(random, number):
    joints = []
    dof = int(random.integers(2, 8))
    for k in range(dof):
        slides = random.random() < 0.15
        row = {"type": "P" if slides else "R", "alpha": float(random.choice(RIGHT_ANGLES)),
               "a": float(np.round(random.choice([0.0, 1.0]) * random.uniform(0.1, 0.8), 2)),
               "d": float(np.round(random.choice([0.0, 1.0]) * random.uniform(0.1, 0.6), 2)),
               "theta": 0.0}  # fmt: skip
        if random.random() < 0.3:
            row["offset"] = float(random.choice([math.pi / 2, -math.pi / 2, math.pi / 6]))
        if slides:
            row["d"] = 0.0
            row.setdefault("offset", 0.0)
            row["offset"] = 0.2 if row["offset"] else 0.0
        joints.append({"name": f"j{k + 1}", **row})
    document = {
        "name": f"arm{number}", "joints": joints,
        "convention": str(random.choice(["standard", "modified", "khalil"])),
    }  # fmt: skip
    if document["convention"] == "khalil":
        for row in joints:
            row["r"], row["d"] = row.pop("d"), row.pop("a")
    if random.random() < 0.6:
        length = float(np.round(random.uniform(0.05, 0.3), 3))
        document["tool"] = {"xyz": [0, 0, length], "rpy": [0, 0, 0]}
    if random.random() < 0.5:
        place = np.round(random.uniform(-0.5, 0.5, 3), 2).tolist()
        document["base"] = {"xyz": place, "rpy": [0, 0, 0.5]}
    return robot_from_table(read_mapping(document))


def robots(random, number=50):
    named = [shipped_robot(name) for name in LIBRARY]
    shipped = [one for one in named if one.table is not None and not one.table.is_coupled
               and all(row.type.value != "fixed" for row in one.table.rows)]  # fmt: skip
    return [*shipped, *(random_robot(random, k) for k in range(number - len(shipped)))]


@dataclass(frozen=True)
class Made:
    """An answer with slips in it, and the right one."""

    question: Question
    codes: frozenset
    wrong: np.ndarray
    right: np.ndarray


def same_code(robot, code):
    if code != "other_convention":
        return code
    return {
        Convention.STANDARD: "modified_for_standard",
        Convention.MODIFIED: "standard_for_modified",
        Convention.KHALIL: "standard_for_khalil",
    }[robot.table.convention]


def made_slip(random, all_robots):
    """One or two slips on one robot; None where they do nothing, or undo each other."""
    robot = all_robots[int(random.integers(len(all_robots)))]
    q = np.round(random.uniform(-1.4, 1.4, robot.dof), 2)
    q = np.where(robot.is_revolute, q, np.abs(q) / 5)
    arm = arm_of(robot, q)
    of_pose = random.random() < 0.6
    names = [*IN_NUMBERS, *(OF_POSES if of_pose else ()), *(IN_POSES if of_pose else IN_JACOBIANS)]
    chosen = [str(one) for one in random.choice(names, int(random.integers(1, 3)), replace=False)]
    writing = [name for name in chosen if name in IN_POSES or name in IN_JACOBIANS]
    if len(writing) == 2 or len({*chosen} & {"degrees_for_radians", "radians_for_degrees"}) == 2:
        return None
    slipped = arm
    for name in chosen:
        if name not in writing:
            slipped = (IN_NUMBERS | OF_POSES)[name](slipped, random)
            if slipped is None:
                return None

    def written(one, writing):
        if of_pose:
            return IN_POSES[writing[0]](one.pose()) if writing else one.pose()
        return IN_JACOBIANS[writing[0]](one) if writing else one.jacobian()

    wrong, right = written(slipped, writing), written(arm, [])
    quantity = Quantity.T if of_pose else Quantity.JACOBIAN
    codes = frozenset(same_code(robot, name) for name in chosen)
    question = Question(quantity, robot, q)
    if np.abs(wrong - right).max() <= 2e-3:
        return None
    if len(chosen) == 2:
        # A pair of which one slip does nothing is the other one alone.
        for name in chosen:
            if name in writing and np.abs(wrong - written(slipped, [])).max() <= 1e-6:
                codes -= {same_code(robot, name)}
    return Made(question, codes, wrong, right)


def made_slips(seed, number):
    random = np.random.default_rng(seed)
    all_robots = robots(random)
    found = (made_slip(random, all_robots) for _ in count())
    return list(islice((made for made in found if made is not None), number))


def first_codes(verdict, explanation=1):
    return frozenset(one.code for one in verdict.diagnosis if one.explanation == explanation)


def outcome(made, digits):
    """Named: first; listed: among the explanations; same: others that give the same numbers."""
    verdict = check_answer(made.question, np.round(made.wrong, digits).tolist())
    assert not verdict.correct
    if first_codes(verdict) == made.codes:
        return "named"
    exact = check_answer(replace(made.question, tolerance=1e-9), made.wrong.tolist())
    if (
        first_codes(verdict)
        and first_codes(verdict) == first_codes(exact)
        and len([one for one in exact.diagnosis if one.explanation == 1]) <= len(made.codes)
    ):
        # The explanation gives the same numbers to 1e-9, by as few slips.
        return "same"
    numbers = {one.explanation for one in verdict.diagnosis}
    return "listed" if any(first_codes(verdict, k) == made.codes for k in numbers) else "missed"


def figures(number, seed=1):
    """Diagnose many slips; how many in which way, and what was missed."""
    outcomes, missed = Counter(), Counter()
    for k, made in enumerate(made_slips(seed, number)):
        result = outcome(made, (16, 6, 4)[k % 3])
        outcomes[result] += 1
        if result in ("missed", "listed"):
            missed[(made.question.quantity.value, *sorted(made.codes))] += 1
    return outcomes, missed


def main():
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    started = time.process_time()
    outcomes, missed = figures(number)
    spent = 1e3 * (time.process_time() - started) / number
    right = outcomes["named"] + outcomes["same"]
    lines = [
        f"{number} slips on 50 robots: {dict(outcomes)}",
        f"right first: {right / number:.1%}, by name {outcomes['named'] / number:.1%}",
        f"{spent:.0f} ms of CPU each, of two checks",
    ]
    lines += [f"missed {times}: {', '.join(codes)}" for codes, times in missed.most_common(15)]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
