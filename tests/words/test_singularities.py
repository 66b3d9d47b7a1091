"""Every sentence on a singularity, on random arms, against numbers."""

import logging
import re

import numpy as np
import pytest

from kinematics.explanation import lost_direction_in_words, null_motion_in_words
from kinematics.named_singularities import factorization
from kinematics.singularity import report_on
from kinematics.task import TASKS
from tests.words.arms import axes_of, random_arm

TASKS_OF = {
    2: ("xy", "position"),
    3: ("position", "orientation", "xy_phi", "pose"),
    4: ("xyz_phi", "pose"),
    5: ("pose",),
    6: ("pose",),
    7: ("pose",),
}
NUMBER = r"-?[\d.]+(?:e-?\d+)?"


def configurations(robot, count, seed):
    """In general position, at quarter turns, at rest, and with slides at and near zero."""
    generator = np.random.default_rng(seed)
    turns = robot.is_revolute
    q = np.where(turns, generator.uniform(-3.1, 3.1, (count, robot.dof)), 0.0)
    q = np.where(turns, q, generator.uniform(-0.5, 0.5, q.shape))
    offsets = np.array([row.sign * row.offset for row in robot.table.rows])
    quarter = np.pi / 2 * generator.integers(-2, 3, q.shape) - offsets
    slide = generator.choice([0.0, 1e-9, -1e-9, 1e-5, 0.2], q.shape)
    special = np.where(turns, quarter, slide)
    share = generator.choice([0.0, 0.0, 0.3, 0.7], (count, 1))
    return np.where(generator.random(q.shape) < share, special, q)


def tasks_of(robot):
    return [TASKS[name] for name in TASKS_OF[robot.dof]]


def residual(where, axes, q):
    """How far the geometry that a sentence describes is from being so, shape (n,); None: unknown.

    Lengths count per metre, directions as sines.
    """
    Z, O = axes.Z, axes.O

    def triple(a, b, c):
        return np.einsum("ni,ni->n", a, np.cross(b, c))

    def end(text):
        if text == "the frame's origin":
            return axes.T[:, :3, 3]
        if text == "the wrist centre":
            return meeting(3, 4)
        if match := re.fullmatch(r"axis (\d)", text):
            return O[:, int(match[1]) - 1]
        return meeting(4, 5)

    def meeting(i, j):
        n = np.cross(Z[:, i], Z[:, j])
        along = np.einsum("ni,ni->n", np.cross(O[:, j] - O[:, i], Z[:, j]), n)
        return O[:, i] + (along / np.einsum("ni,ni->n", n, n))[:, None] * Z[:, i]

    if match := re.fullmatch(
        r"axes 4, 5 and 6 lie in one plane.*|axes 1, 2 and 3 are dir.*", where
    ):
        i = 3 if where.startswith("axes 4") else 0
        return np.abs(triple(Z[:, i], Z[:, i + 1], Z[:, i + 2]))
    if where.startswith("axes 5 and 6 and the parallel axes"):
        return np.abs(triple(Z[:, 1], Z[:, 4], Z[:, 5]))
    if match := re.match(r"(.*) is in the plane through axis (\d) along axis (\d)", where):
        i, j = int(match[2]) - 1, int(match[3]) - 1
        return np.abs(triple(end(match[1]) - O[:, i], Z[:, i], Z[:, j]))
    if match := re.match(r"stretched or folded: axes (\d), (\d) and (\d) lie in one plane", where):
        i, j, k = (int(match[m]) - 1 for m in (1, 2, 3))
        return np.abs(triple(O[:, j] - O[:, i], O[:, k] - O[:, i], Z[:, i]))
    if match := re.match(r"stretched or folded: (.*) is in the plane of axes (\d) and (\d)", where):
        i, j = int(match[2]) - 1, int(match[3]) - 1
        return np.abs(triple(O[:, j] - O[:, i], end(match[1]) - O[:, i], Z[:, i]))
    if match := re.match(r"(.*) is in the plane of axes 1 and 2", where):
        return np.abs(triple(end(match[1]) - O[:, 1], Z[:, 0], Z[:, 1]))
    if match := re.match(r"the line from .* meet to (.*) is at right angles to axis 3", where):
        return np.abs(np.einsum("ni,ni->n", end(match[1]) - meeting(0, 1), Z[:, 2]))
    if match := re.match(r".*: (.*) is in the plane of axis 3 and the point where", where):
        return np.abs(triple(end(match[1]) - O[:, 2], Z[:, 2], meeting(0, 1) - O[:, 2]))
    if match := re.match(
        r"the velocities that joints 1, 2 and 3 give (.*) lie in one plane", where
    ):
        lever = end(match[1])[:, None] - O[:, :3]
        columns = np.where(axes.turns[None, :3, None], np.cross(Z[:, :3], lever), Z[:, :3])
        return np.abs(np.linalg.det(columns))
    return None


def check_factors(robot, task, q, axes, sigma):
    """Check what is said of the determinant; return the number of sentences checked."""
    found = factorization(robot, q, task)
    full = sigma.shape[1]
    threshold = np.maximum(1.0, sigma[:, 0])
    lost = sigma[:, -1] <= 1e-9 * threshold
    surely_lost = sigma[:, -1] <= 1e-12 * threshold
    assert full == min(len(task.rows), robot.dof)
    if found.structure is None:
        if "singular at every q" in found.reason:
            assert lost.all(), found.reason
            return len(q)
        return 0
    vanishing = np.zeros(len(q), dtype=bool)
    for factor in found.factors:
        assert (np.abs(factor.value) <= factor.largest * (1 + 1e-9)).all(), factor.name
        assert np.ptp(factor.largest) <= 1e-9 * factor.largest.max()
        assert not (factor.vanishes & ~lost).any(), (factor.vanishes_where, q[factor.vanishes])
        away = residual(factor.vanishes_where, axes, q)
        if away is not None:
            assert (away[factor.vanishes] <= 1e-7).all(), factor.vanishes_where
        vanishing |= factor.vanishes
        check_zeros(robot, task, factor.vanishes_where, q)
    assert not (surely_lost & ~vanishing).any(), (found.structure, q[surely_lost & ~vanishing][:1])
    return len(q) * len(found.factors)


def check_zeros(robot, task, where, q):
    """At the values of a joint that a sentence names, whatever the others are, the rank is lost."""
    match = re.search(rf" \((\w+) = ({NUMBER})°, ({NUMBER})°\)$", where)
    if match is None:
        return
    column = [joint.name for joint in robot.joints].index(match[1])
    for value in (float(match[2]), float(match[3])):
        there = q[:8].copy()
        there[:, column] = np.deg2rad(value) + 2 * np.pi
        J = axes_of(robot, there).jacobian[:, list(task.rows)]
        sigma = np.linalg.svd(J, compute_uv=False)
        assert (sigma[:, -1] <= 1e-9 * np.maximum(1.0, sigma[:, 0])).all(), where


def check_words(robot, task, J, full):
    """Check what is said of one singular configuration; return the number of sentences."""
    report = report_on(J, robot, task)
    names = [joint.name for joint in robot.joints]
    for motion in report.null_motions:
        text = null_motion_in_words(robot, motion, full, J)
        told = np.zeros(robot.dof)
        if match := re.match(r"joint (\w+) (turns|slides) alone and does nothing", text):
            k = names.index(match[1])
            told[k] = 1.0
            assert robot.is_revolute[k] == (match[2] == "turns")
        elif match := re.match(
            r"joints (.*?) (?:turn|slide|move) as ([^ ].*?)(?: \(rad and m\))? and", text
        ):
            moving = re.split(r", | and ", match[1])
            for name, part in zip(moving, match[2].split(" : "), strict=True):
                told[names.index(name)] = float(part)
        elif match := re.match(r"joints (\w+) and (\w+) turn (.*?),? and do nothing", text):
            first, second = names.index(match[1]), names.index(match[2])
            opposite = match[3].startswith("against each other")
            told[first], told[second] = 1.0, -1.0 if opposite else 1.0
            assert (motion[first] * motion[second] < 0) == opposite, text
            if not opposite:
                assert full[3:, first] @ full[3:, second] < -0.999999
        else:
            assert "together and do nothing" in text or "next to nothing" in text, text
            continue
        told /= np.linalg.norm(told)
        assert np.linalg.norm(J @ told) <= 2e-3 * max(1.0, np.abs(J).max()), text
        assert abs(abs(told @ motion) - 1) <= 1e-3, text
    for direction in report.lost_directions:
        text = lost_direction_in_words(task, direction, J)
        if "cannot" in text or text.startswith("no twist"):
            assert np.linalg.norm(direction @ J) <= 2e-9 * max(1.0, np.abs(J).max()), text
        parts = [float(x) for x in re.findall(NUMBER, re.sub(r"\bby .*? q\)", "", text))]
        told = np.concatenate([parts[3 * k : 3 * k + 3] for k in range(len(parts) // 3)])
        if len(told) == 3:
            rows = task.positions if "move" in text else task.rotations
            told = told[list(rows)]
            part = J[: len(task.positions)] if "move" in text else J[len(task.positions) :]
            assert np.linalg.norm(told @ part) <= 1e-4 * max(1.0, np.abs(J).max()), text
    return len(report.null_motions) + len(report.lost_directions)


def examine(number, count, most_words):
    """Check all that is said of an arm; return counts of configurations and sentences."""
    robot = random_arm(number)
    q = configurations(robot, count, number)
    axes = axes_of(robot, q)
    full = axes.jacobian
    said = 0
    for task in tasks_of(robot):
        J = full[:, list(task.rows)]
        sigma = np.linalg.svd(J, compute_uv=False)
        said += check_factors(robot, task, q, axes, sigma)
        lost = np.flatnonzero(sigma[:, -1] <= 1e-10 * np.maximum(1.0, sigma[:, 0]))
        for k in lost[:most_words]:
            said += check_words(robot, task, J[k], full[k])
    return said


@pytest.mark.parametrize("number", range(30))
def test_what_is_said_of_singularities_is_so(number):
    examine(number, 60, 15)


@pytest.mark.slow
def test_no_false_sentence_on_a_grid():
    """200 arms, 500 configurations each."""
    said = sum(examine(number, 500, 40) for number in range(200))
    logging.getLogger(__name__).info(f"{said} sentences on 100,000 configurations of 200 arms")
    assert said > 150_000
