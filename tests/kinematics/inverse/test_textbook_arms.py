"""Textbook arms in closed form: arms of two to four joints, in any order of turns and slides, and
before a spherical wrist; nothing missing, nothing false, names that stay."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from kinematics.inverse.closed_form import closed_form_of, solutions
from kinematics.inverse.continuation.real import chain_fibre, real_solutions
from kinematics.task import TASKS
from tests.kinematics.inverse.test_closed_form_geometry import (
    chain_from,
    differences,
    placement,
    unit,
    walk,
)

SHORT = ["".join(types) for count in (2, 3) for types in product("RP", repeat=count)]
FLAT = ["RRPR", "PRRR", "RRRP", "RPRR", "RPPR", "PRPR", "PPPR", "RPRP", "RRPP"]
WRISTED = ["".join(types) + "RRR" for types in product("RP", repeat=3)]
STYLES = ("skew", "grid", "mixed", "flat")
"""How axes lie: anyhow; along x, y, z through points of a grid; some parallel, perpendicular or
meeting; about, along or across one direction."""


def arm(random, types, style):
    """A chain of a style, in a base that stands anyhow."""
    count, turns = len(types), np.array([kind == "R" for kind in types])
    h = [unit(random) for _ in range(count)]
    p = [random.normal(size=3) for _ in range(count)]
    if style == "grid":
        h = [np.eye(3)[random.integers(3)] * random.choice([-1.0, 1.0]) for _ in range(count)]
        p = [0.5 * random.integers(-1, 2, 3) for _ in range(count)]
    elif style == "mixed":
        for k in range(1, count):
            if (chance := random.random()) < 0.3:
                h[k] = h[k - 1] * random.choice([-1.0, 1.0])
            elif chance < 0.6:
                h[k] = np.cross(h[k - 1], unit(random))
                h[k] /= np.linalg.norm(h[k])
            if random.random() < 0.4:
                p[k] = p[k - 1] + random.normal() * h[k - 1] + random.normal() * h[k]
    elif style == "flat":
        u = unit(random) if random.random() < 0.5 else np.array([0.0, 0.0, 1.0])
        for k in range(count):
            h[k] = np.cross(u, unit(random))
            h[k] /= np.linalg.norm(h[k])
            if turns[k] or random.random() < (0.5 if count > 3 else 0.15):
                h[k] = u * random.choice([-1.0, 1.0])
    if count == 6:
        centre = random.normal(size=3)
        for k in (3, 4, 5):
            h[k] = unit(random)
            p[k] = centre + random.normal() * h[k]
    pose = placement(random)
    if style == "grid" and random.random() < 0.7:
        pose[:3, 3] = 0.5 * random.integers(-1, 2, 3)
    return chain_from(h, p, pose, turns)


def cases(types, count, seed):
    """Arms of each style that have a closed form, each with its tasks and some q."""
    random = np.random.default_rng([seed, *types.encode()])
    for style in STYLES if len(types) != 4 else ("grid", "flat", "flat", "flat"):
        for _ in range(count):
            chain = arm(random, types, style)
            form = closed_form_of(chain)
            for task in () if form is None else form.tasks:
                for q in random.uniform(-2.5, 2.5, (3, len(types))):
                    yield chain, form, TASKS[task], q, random


def missed(chain, q, target, task):
    """Largest error of a configuration in the rows of a task, by another forward kinematics."""
    T = walk(chain, q)[2]
    R = target[:3, :3] @ T[:3, :3].T
    vee = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    away = np.abs(np.concatenate((target[:3, 3] - T[:3, 3], vee))[list(task.rows)]).max()
    return away + (task.name == "pose" and np.trace(R) < 0)


@pytest.mark.parametrize("types", [*SHORT, *FLAT, *WRISTED])
def test_every_solution_is_there_once_and_has_its_name(types):
    seen = 0
    for chain, form, task, q, random in cases(types, 6, 1):
        seen += 1
        target = walk(chain, q)[2]
        found = solutions(form, chain, target, task=task, given=q)
        assert 1 <= len(found.q) <= form.most, form.description
        assert differences(chain.is_revolute, found.q, q).min() < 1e-6, form.description
        assert (found.position_errors + found.orientation_errors).max() < 1e-9
        assert max(missed(chain, one, target, task) for one in found.q) < 1e-9
        names = found.postures(form)
        assert len(set(names)) == len(names), (form.description, names)
        near = q + 1e-5 * random.normal(size=len(q))
        moved = solutions(form, chain, walk(chain, near)[2], task=task, given=near)
        if len(moved.q) != len(found.q) or form.ranked is not None:
            continue
        for one, name in zip(found.q, names, strict=True):
            gaps = differences(chain.is_revolute, moved.q, one)
            if gaps.min() < 1e-2:
                assert moved.postures(form)[int(gaps.argmin())] == name, form.description
    assert seen


@pytest.mark.parametrize("types", [*SHORT, *FLAT])
def test_the_algebraic_way_finds_the_same(types):
    for number, (chain, form, task, q, random) in enumerate(cases(types, 2, 2)):
        if number % 3:
            continue
        fibre = chain_fibre(chain, task)
        if fibre is None:
            continue
        target = walk(chain, q)[2]
        if number % 2:
            target[:3, 3] += random.normal(scale=0.5, size=3) * [
                row in task.positions for row in range(3)
            ]
        theirs = real_solutions(fibre, chain, task, target, q)
        ours = solutions(form, chain, target, task=task, given=q)
        assert theirs.is_complete
        assert len(theirs.solutions) == len(ours.q), form.description
        for one in theirs.solutions:
            assert differences(chain.is_revolute, ours.q, one.q).min() < 1e-6, form.description
