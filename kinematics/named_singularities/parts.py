"""Determinants of parts of an arm as products; each function returns (constant, factors).

With ``c_k = z_k × (P - o_k)`` the velocity of a point P per unit speed of a revolute joint, two
identities split them: ``(u × a) × (u × b) = u (u · (a × b))`` for parallel axes, and
``(u × a) × (v × a) = a (a · (u × v))`` for axes that meet. Bounds of factors hold at every q: no
factor is divided by a length that may become zero.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.named_singularities.posture import (
    Factor,
    Posture,
    Zeros,
    across,
    cross,
    dot,
    norm,
    triple,
)
from kinematics.named_singularities.reach import Reach
from kinematics.named_singularities.relations import Relations
from robots.robot import FloatArray

Product: TypeAlias = tuple[FloatArray, list[Factor]]
WRIST_CENTRE = say("the wrist centre")


def wrist(at: Posture, i: int, j: int, k: int, where: str) -> Product:
    """Return ``z_i · (z_j × z_k)``: the sine of the middle joint's angle times a constant."""
    a, b, c = at.z(i), at.z(j), at.z(k)
    scale = norm(cross(a, b)) * norm(cross(b, c))
    part = np.maximum(scale, 1e-300)
    sine = triple(b, a, c) / part
    zeros = Zeros(j, sine, (dot(a, c) - dot(a, b) * dot(b, c)) / part, np.ones_like(sine))
    return -scale, [Factor("wrist", sine, np.ones_like(sine), "1", (i, j, k), where, zeros)]


def in_one_plane(i: int, j: int, k: int) -> str:
    """Say that three axes through one point lie in one plane."""
    return say(
        "axes {i}, {j} and {k} lie in one plane (or two of them coincide)",
        i=i + 1,
        j=j + 1,
        k=k + 1,
    )


def bend(
    at: Posture, i: int, j: int, point: FloatArray, end: str, largest: FloatArray | None = None
) -> Product:
    """Return ``z_i · ((P - o_i) × (P - o_j))`` of parallel axes i, j: 0 with P in their plane.

    Args:
        at: The posture.
        i: The first axis.
        j: The second.
        point: P, shape (n, 3).
        end: P in words.
        largest: Bound of its distance from axis j at every q, m; None where joint j alone moves it.
    """
    z, zj = at.z(i), at.z(j)
    between = across(at.O[:, j] - at.O[:, i], z)
    length = norm(between)
    e = between / np.maximum(length, 1e-300)[:, None]
    r = at.from_axis(j, point)
    value = triple(z, e, r)
    where = say(
        "stretched or folded: {end} is in the plane of axes {i} and {j}", end=end, i=i + 1, j=j + 1
    )
    zeros = None if largest is not None else Zeros(j, value, dot(e, r), np.sign(dot(z, zj)))
    bound = at.lever(j, point) if largest is None else largest
    return length, [Factor("elbow", value, bound, "m", (i, j), where, zeros)]


def arm(at: Posture, axes: Relations, reach: Reach, point: FloatArray, end: str) -> Product:
    """Return ``det [c_1 c_2 c_3]`` of the first three joints at a point that they carry.

    Args:
        at: The posture.
        axes: How they lie to each other.
        reach: How far points can be from them.
        point: P, shape (n, 3).
        end: P in words.
    """
    t1, t2, t3 = (bool(is_revolute) for is_revolute in axes.is_revolute[:3])
    z1, z2, z3 = at.z(0), at.z(1), at.z(2)
    if t2 and t3 and axes.parallel[1, 2]:
        constant, factors = bend(at, 1, 2, point, end)
        constant = constant * np.sign(dot(z2, z3))
        if not t1:
            return constant * dot(z1, z2), factors
        n, sine = _normal(z1, z2)
        offset = np.abs(dot(at.O[:, 1] - at.O[:, 0], n))
        largest = offset + norm(across(at.O[:, 2] - at.O[:, 1], z2)) + at.lever(2, point)
        where = say("{end} is in the plane through axis 1 along axis 2", end=end)
        value = dot(at.from_axis(0, point), n)
        return -constant * sine, [Factor("shoulder", value, largest, "m", (0, 1), where), *factors]
    if t1 and t2 and axes.parallel[0, 1]:
        constant, factors = bend(at, 0, 1, point, end, reach.from_axis(at, 1, 2, point))
        constant = constant * np.sign(dot(z1, z2))
        if not t3:
            return constant * dot(z1, z3), factors
        n, sine = _normal(z1, z3)
        value = dot(at.from_axis(2, point), n)
        where = say("{end} is in the plane through axis 3 along axis 1", end=end)
        forearm = Factor("forearm", value, at.lever(2, point), "m", (2,), where)
        return constant * sine, [*factors, forearm]
    if t1 and t2 and axes.meeting is not None:
        return _about_a_point(at, axes.meeting, reach, point, end, slides=not t3)
    columns = [at.column(k, point, bool(axes.is_revolute[k])) for k in range(3)]
    value = triple(*columns)
    largest = np.ones_like(value)
    for k in range(3):
        if axes.is_revolute[k]:
            largest = largest * reach.from_axis(at, k, 2, point)
    power = int(np.count_nonzero(axes.is_revolute[:3]))
    unit = "1" if power == 0 else "m" if power == 1 else f"m^{power}"
    where = say("the velocities that joints 1, 2 and 3 give {end} lie in one plane", end=end)
    return np.ones_like(value), [Factor("arm", value, largest, unit, (0, 1, 2), where)]


def _about_a_point(
    at: Posture, meeting: FloatArray, reach: Reach, point: FloatArray, end: str, *, slides: bool
) -> Product:
    """Return the determinant where axes 1 and 2 meet in a point, not being parallel."""
    a, z3 = point - meeting, at.z(2)
    n, sine = _normal(at.z(0), at.z(1))
    where = say("{end} is in the plane of axes 1 and 2", end=end)
    if slides:
        # The slide carries the point along itself: at q = 0 it is as far from the meeting point
        # as along and across the slide together, at every q.
        largest = norm(across(a, z3)) + reach.along(2, dot(a, z3))
        right_angle = say(
            "the line from the point where axes 1 and 2 meet to {end} is at right"
            " angles to axis 3 (or the two points coincide)",
            end=end,
        )
        return sine, [
            Factor("shoulder", dot(a, n), largest, "m", (0, 1), where),
            Factor("slide", dot(a, z3), largest, "m", (2,), right_angle),
        ]
    between = across(at.O[:, 2] - meeting, z3)
    length = norm(between)
    e = between / np.maximum(length, 1e-300)[:, None]
    r = at.from_axis(2, point)
    largest = norm(at.foot(2, point) - meeting) + at.lever(2, point)
    stretched = say(
        "stretched or folded: {end} is in the plane of axis 3 and the point"
        " where axes 1 and 2 meet",
        end=end,
    )
    bent = triple(z3, e, r)
    zeros = Zeros(2, bent, dot(e, r), np.ones_like(bent))
    return -length * sine, [
        Factor("shoulder", dot(a, n), largest, "m", (0, 1), where),
        Factor("elbow", bent, at.lever(2, point), "m", (2,), stretched, zeros),
    ]


def _normal(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the unit vectors across a and b, shape (n, 3), and the sines of their angles."""
    n = cross(a, b)
    sine = norm(n)
    return n / np.maximum(sine, 1e-300)[:, None], sine


def three_parallel(at: Posture, i: int, j: int, k: int) -> Product:
    """Return the determinant of three revolute joints with parallel axes, rows (v_x, v_y, ω_h)."""
    h = at.z(i)
    constant, (found,) = bend(at, i, j, at.O[:, k], say("axis {k}", k=k + 1))
    signs = np.sign(dot(h, at.z(j))) * np.sign(dot(h, at.z(k)))
    where = say(
        "stretched or folded: axes {i}, {j} and {k} lie in one plane", i=i + 1, j=j + 1, k=k + 1
    )
    factor = Factor("elbow", found.value, found.largest, "m", (i, j, k), where, found.zeros)
    return constant * signs, [factor]


def around_parallel(
    at: Posture, is_revolute: NDArray[np.bool_], point: FloatArray, meets: bool, scale: FloatArray
) -> Product:
    """Return the part of joints 1, 5 and 6 that joints 2, 3 and 4 (parallel axes) cannot yield.

    Rows: velocity along h = z_2 of a point of axis 6, and angular velocity across h.

    Args:
        at: The posture.
        is_revolute: True for revolute joints, shape (6,).
        point: A point of axis 6; where axes 5 and 6 meet, that point.
        meets: Whether they do.
        scale: Bound of the distance of that point from axis 1's plane at every q, shape (n,).
    """
    h, z1, z5, z6 = at.z(1), at.z(0), at.z(4), at.z(5)
    along = dot(at.column(0, point, bool(is_revolute[0])), h)
    if not meets:
        value = along * triple(h, z5, z6)
        if is_revolute[0]:
            value = value - dot(at.column(4, point, True), h) * triple(h, z1, z6)
        where = say(
            "no motion of joints 1, 5 and 6 yields every velocity along the"
            " parallel axes together with every turn across them"
        )
        name, unit = (say("shoulder and wrist"), "m") if is_revolute[0] else ("wrist", "1")
        largest = scale + at.lever(4, point) if is_revolute[0] else np.ones_like(value)
        return np.ones_like(value), [Factor(name, value, largest, unit, (0, 4, 5), where)]
    where = say("axes 5 and 6 and the parallel axes 2, 3 and 4 are directed along one plane")
    constant, (sine,) = wrist(at, 1, 4, 5, where)
    factors = [Factor("wrist", sine.value, sine.largest, "1", (3, 4, 5), where, sine.zeros)]
    if not is_revolute[0]:
        return constant * along, factors
    n, skew = _normal(z1, h)
    where = say("the point where axes 5 and 6 meet is in the plane through axis 1 along axis 2")
    value = dot(at.from_axis(0, point), n)
    return -constant * skew, [Factor("shoulder", value, scale, "m", (0, 1), where), *factors]


def srs(at: Posture, shoulder: FloatArray, centre: FloatArray) -> Product:
    """Return sqrt(det J Jᵀ) of an arm of spherical shoulder, elbow and spherical wrist.

    Every 6-row minor contains the elbow's factor: w = |elbow| sqrt(W² A + S² B), with S =
    z1·(z2×z3), W = z5·(z6×z7) and A, B the squares of d · (z_i × z_j) over pairs of shoulder and
    wrist axes, d from the shoulder to the wrist.
    """
    d, z4 = centre - shoulder, at.z(3)
    between = across(at.O[:, 3] - shoulder, z4)
    length = norm(between)
    e = between / np.maximum(length, 1e-300)[:, None]
    r = at.from_axis(3, centre)
    elbow = triple(z4, e, r)
    zeros = Zeros(3, elbow, dot(e, r), np.ones_like(elbow))
    farthest = norm(at.foot(3, centre) - shoulder) + at.lever(3, centre)

    def pairs(i: int, j: int, k: int) -> FloatArray:
        z = (at.z(i), at.z(j), at.z(k))
        return np.asarray(sum(triple(d, z[a], z[b]) ** 2 for a, b in ((0, 1), (0, 2), (1, 2))))

    S, W = triple(at.z(0), at.z(1), at.z(2)), triple(at.z(4), at.z(5), at.z(6))
    value = np.hypot(W * np.sqrt(pairs(0, 1, 2)), S * np.sqrt(pairs(4, 5, 6)))
    return length, [
        Factor(
            "elbow",
            elbow,
            at.lever(3, centre),
            "m",
            (3,),
            say(
                "stretched or folded: the wrist centre is in the plane of axis 4 and"
                " the shoulder's centre"
            ),
            zeros,
        ),
        Factor(
            say("shoulder and wrist"),
            value,
            3.0 * farthest,
            "m",
            (0, 1, 2, 4, 5, 6),
            say(
                "axes 1, 2 and 3 and the line from shoulder to wrist lie in one plane;"
                " or axes 5, 6 and 7 and that line do; or axes 1, 2 and 3 lie in one"
                " plane and axes 5, 6 and 7 in another; or shoulder and wrist coincide"
            ),
        ),
    ]
