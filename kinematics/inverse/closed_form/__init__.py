"""All inverse solutions of common arms in closed form: ``closed_form_of`` and ``solutions``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.chain import Chain
from kinematics.inverse.closed_form import parallel_axes, planar, spherical_wrist, srs
from kinematics.inverse.closed_form.candidates import SAME, Candidates, FormConstants
from kinematics.inverse.closed_form.classify import classify
from kinematics.inverse.closed_form.form import ClosedForm, Kind
from kinematics.inverse.task_error import task_chain
from kinematics.task import POSE, Task
from robots.robot import FloatArray

__all__ = ["ClosedForm", "Kind", "Solutions", "closed_form_of", "solutions", "swivel_of"]

_SOLVERS: dict[Kind, Callable[..., int]] = {
    "three_joints": spherical_wrist.solve,
    "spherical_wrist": spherical_wrist.solve,
    "parallel_axes": parallel_axes.solve,
    "planar_2r": planar.solve,
    "planar_3r": planar.solve,
    "planar": planar.solve,
    "scara": planar.solve,
    "srs": srs.solve,
}


@dataclass(frozen=True, eq=False)
class Solutions:
    """All solutions of one target, checked on the chain.

    Attributes:
        q: One a row, in the chain's order, angles in (-pi, pi]; shape (n, K), rad and m.
        codes: Which of the two values each posture has, see ``ClosedForm.postures``; (n, m).
        free: True where a singular branch leaves the joint free, so that this is one of a
            family: it took the given value (parallel axes: or the nearest within reach);
            shape (n, K).
        position_errors: Measured in the task's axes, m, shape (n,).
        orientation_errors: Likewise, rad.
    """

    q: FloatArray
    codes: NDArray[np.int64]
    free: NDArray[np.bool_]
    position_errors: FloatArray
    orientation_errors: FloatArray

    def postures(self, form: ClosedForm) -> list[tuple[str, ...]]:
        """Return the names of the postures of each solution."""
        return [
            tuple(
                names[code] for names, code in zip(form.postures, row, strict=True) if names[code]
            )
            for row in self.codes.tolist()
        ]


@lru_cache(maxsize=512)
def closed_form_of(chain: Chain) -> ClosedForm | None:
    """Return the closed form of a chain, from memory if asked for before; None: there is none."""
    return classify(chain)


def solutions(
    form: ClosedForm,
    chain: Chain,
    target: FloatArray,
    *,
    task: Task = POSE,
    given: FloatArray | None = None,
    swivel: float = 0.0,
) -> Solutions:
    """Find all solutions of one target, regardless of joint limits.

    Args:
        form: What :func:`closed_form_of` says of the chain.
        chain: The chain.
        target: Pose of the frame in base axes, shape (4, 4); rows outside the task do not count.
        task: One of ``form.tasks``.
        given: Values for joints that a singular branch leaves free, in the chain's order, shape
            (K,); default 0.
        swivel: For ``srs``: the swivel angle psi, rad; see :mod:`srs`.

    Returns:
        The solutions; none where the target is out of reach. A family of solutions that a
        singular branch leaves is represented by the one with the given value.

    Raises:
        ValueError: The closed form does not solve the task.
    """
    if task.name not in form.tasks:
        raise ValueError(
            say(
                "{kind} solves {tasks}, not {task}",
                kind=form.kind,
                tasks=", ".join(form.tasks),
                task=task.name,
            )
        )
    count, most = chain.length, form.most + 1
    found = Candidates(
        np.empty((most, count)),
        np.zeros((most, len(form.postures)), dtype=np.int64),
        np.zeros(most, dtype=np.int64),
        np.empty((most, 2)),
    )
    n = _SOLVERS[form.kind](
        FormConstants(
            form.constants,
            task_chain(chain, task),
        ),
        np.ascontiguousarray(target, dtype=np.float64),
        np.zeros(count) if given is None else np.ascontiguousarray(given, dtype=np.float64),
        float(swivel),
        True,
        found,
    )
    bits = (found.free[:n, None] >> np.arange(count)) & 1
    errors = found.errors[:n]
    if form.ranked is not None:
        found.codes[:n, 0] = _ranks(found.q[:n, form.ranked])
    return Solutions(found.q[:n], found.codes[:n], bits.astype(bool), errors[:, 0], errors[:, 1])


def _ranks(values: FloatArray) -> NDArray[np.int64]:
    """Return how many different values are below each; those within ``SAME`` are one."""
    order = np.argsort(values)
    steps = np.diff(values[order], prepend=values[order[:1]]) > SAME
    ranks = np.empty(len(values), dtype=np.int64)
    ranks[order] = np.cumsum(steps)
    return ranks


def swivel_of(form: ClosedForm, q: FloatArray) -> float:
    """Return the swivel angle psi of a configuration of an ``srs`` arm, rad, in (-pi, pi].

    Args:
        form: Of kind ``srs``.
        q: In the chain's order, shape (7,), rad.
    """
    if form.kind != "srs":
        raise ValueError(say("{kind} has no swivel angle", kind=form.kind))
    return float(srs.swivel_of(form.constants, np.ascontiguousarray(q, dtype=np.float64)))
