"""Compiled: three joints that place a point, and a spherical wrist, in lanes.

The lanes of :mod:`kinematics.inverse.closed_form.spherical_wrist`; directions and points are those
at q = 0 in base axes.
"""

from __future__ import annotations

from kinematics.compiled import inner
from kinematics.inverse.closed_form.lanes.nearest import Chosen, Joints, consider
from kinematics.inverse.closed_form.lanes.subproblems import (
    SMALL,
    Mask,
    Three,
    Two,
    align,
    angle_between,
    component,
    dihedral,
    distance,
    signed_angle,
    slid_to,
)
from kinematics.inverse.closed_form.regional import (
    ELBOW,
    H1,
    H2,
    H3,
    P1,
    P2,
    P3,
    REVERSED,
    SHOULDER,
    SIZE,
    SLIDES,
    VARIANT,
    WRIST,
)
from kinematics.inverse.closed_form.spherical_wrist import (
    AXIS6_IN_TIP,
    SIDE6_IN_TIP,
    TRIPLE,
    WRIST_IN_TIP,
)
from kinematics.inverse.closed_form.vectors import add, cross, dot, scale, sub, turn, vector
from kinematics.lanes.memory import Pointer, load, past, store
from kinematics.lanes.trigonometry import sine_cosine
from kinematics.lanes.vector import LANES, Vector, bits, select, splat

# Rows of a choice of the first three joints.
Q1, Q2, Q3, EXISTS, SHARP = 0, 1, 2, 3, 4
ARM = 5
"""Rows of one choice; there are up to four."""
ARMS = 4


@inner
def rotated(target: Pointer, v: Three, like: Vector) -> Three:
    """Apply the rotation of targets to a vector."""
    return (
        load(target, 0, like) * v[0] + load(target, 1, like) * v[1] + load(target, 2, like) * v[2],
        load(target, 4, like) * v[0] + load(target, 5, like) * v[1] + load(target, 6, like) * v[2],
        load(target, 8, like) * v[0] + load(target, 9, like) * v[1] + load(target, 10, like) * v[2],
    )


@inner
def point_of(target: Pointer, v: Three, like: Vector) -> Three:
    """Return the points of targets that are at v in their axes."""
    x, y, z = rotated(target, v, like)
    return load(target, 3, like) + x, load(target, 7, like) + y, load(target, 11, like) + z


@inner
def one_of(middle: Vector, half: Vector, i: int) -> Vector:
    """Return the first or the second of two solutions."""
    return middle + half if i == 0 else middle - half


@inner
def three_turns(
    numbers: Pointer, start: int, image_c: Three, image_v: Three, bent: Vector
) -> tuple[Mask, Vector, Vector, Vector, Vector]:
    """Return where it is unsure, how sharp, and qa, qb, qc; see :mod:`.closed_form.spherical`."""
    a, b = vector(numbers, start), vector(numbers, start + 3)
    c, v = vector(numbers, start + 6), vector(numbers, start + 12)
    qb = bent - numbers[start + 11]
    sb, cb = sine_cosine(qb, 0.0)
    unsure, sharp, qa = align(a, turn(b, cb, sb, c), image_c, 1.0)
    sa, ca = sine_cosine(qa, 0.0)
    w = turn(b, cb, -sb, turn(a, ca, -sa, image_v))
    return unsure, sharp, qa, qb, signed_angle(dot(c, cross(v, w)), dot(v, w))


@inner
def bend(numbers: Pointer, start: int, image_c: Three) -> tuple[Mask, Mask, Vector, Vector]:
    """Return what :func:`dihedral` does of the middle one of three joints."""
    a = vector(numbers, start)
    return dihedral(numbers[start + 9], numbers[start + 10], angle_between(a, image_c))


@inner
def wrist_forms(
    joints: Joints,
    numbers: Pointer,
    target: Pointer,
    arms: Pointer,
    chosen: Chosen,
    like: Vector,
) -> Chosen:
    """Choose among the solutions of three joints of two turns and one, and of a wrist.

    Args:
        joints: What solutions are chosen by.
        numbers: Geometry of the axes at q = 0, of a variant ELBOW, SHOULDER or COLUMN.
        target: Poses of the frame, twelve rows of lane memory.
        arms: Lane memory of ``ARMS · ARM`` rows.
        chosen: None yet.
        like: A vector of the width.
    """
    w = point_of(target, vector(numbers, WRIST_IN_TIP), like)
    unsure = chosen.unsure | _positions(numbers, w, arms, like)
    chosen = Chosen(chosen.distance, chosen.sharp, unsure)
    q, back = joints.q, numbers[REVERSED] == 1.0
    for i in range(ARMS):
        arm = past(arms, i * ARM * LANES)
        exists, sharp = load(arm, EXISTS, like) == 1.0, load(arm, SHARP, like)
        if bits(exists) == 0:
            continue
        if back:
            q1, q2, q3 = -load(arm, Q3, like), -load(arm, Q2, like), -load(arm, Q1, like)
        else:
            q1, q2, q3 = load(arm, Q1, like), load(arm, Q2, like), load(arm, Q3, like)
        if joints.K > 3:
            c, v = vector(numbers, AXIS6_IN_TIP), vector(numbers, SIDE6_IN_TIP)
            wrist_c, wrist_v = rotated(target, c, like), rotated(target, v, like)
            wrist_c, wrist_v = _turned_back(joints, numbers, H1, 0, q1, wrist_c, wrist_v)
            wrist_c, wrist_v = _turned_back(joints, numbers, H2, 1, q2, wrist_c, wrist_v)
            wrist_c, wrist_v = _turned_back(joints, numbers, H3, 2, q3, wrist_c, wrist_v)
            there, doubt, bent_sharp, bent = bend(numbers, TRIPLE, wrist_c)
            unsure, there = exists & doubt, exists & there
            for side in range(2):
                loose, turned_sharp, q4, q5, q6 = three_turns(
                    numbers, TRIPLE, wrist_c, wrist_v, bent if side else -bent
                )
                unsure = unsure | (there & loose)
                store(q, 0, q1)
                store(q, 1, q2)
                store(q, 2, q3)
                store(q, 3, q4)
                store(q, 4, q5)
                store(q, 5, q6)
                chosen = Chosen(chosen.distance, chosen.sharp, chosen.unsure | unsure)
                all_sharp = sharp * bent_sharp * turned_sharp
                chosen = consider(joints, there, all_sharp, chosen, like)
        else:
            store(q, 0, q1)
            store(q, 1, q2)
            store(q, 2, q3)
            chosen = consider(joints, exists, sharp, chosen, like)
    return chosen


@inner
def _turned_back(
    joints: Joints, numbers: Pointer, h: int, k: int, q: Vector, c: Three, v: Three
) -> tuple[Three, Three]:
    if joints.turns[k] == 0.0:
        return c, v
    sine, cosine = sine_cosine(q, 0.0)
    axis = vector(numbers, h)
    return turn(axis, cosine, -sine, c), turn(axis, cosine, -sine, v)


@inner
def _put(
    arms: Pointer, n: int, q1: Vector, q2: Vector, q3: Vector, exists: Mask, sharp: Vector
) -> None:
    arm = past(arms, n * ARM * LANES)
    store(arm, Q1, q1)
    store(arm, Q2, q2)
    store(arm, Q3, q3)
    store(arm, EXISTS, select(exists, splat(1.0, q1), 0.0))
    store(arm, SHARP, sharp)


@inner
def _third(
    h3: Three, p3: Three, w0: Three, slides: bool, centre: Three, square: Vector, size: float
) -> Two:
    """Solve joint 3 for the square of the distance of the point from a centre."""
    if slides:
        return slid_to(h3, sub(w0, centre), square, size)
    return distance(h3, sub(w0, p3), sub(centre, p3), square, size)


@inner
def _moved(h3: Three, p3: Three, w0: Three, slides: bool, q3: Vector) -> Three:
    """Return the point, moved by joint 3."""
    sine, cosine = sine_cosine(q3, 0.0)
    if slides:
        return add(scale(q3, h3), w0)
    return add(turn(h3, cosine, sine, sub(w0, p3)), p3)


@inner
def _swing(h: Three, p: Three, q: Vector, v: Three) -> Three:
    """Turn a point about the line through p along h."""
    sine, cosine = sine_cosine(q, 0.0)
    return add(turn(h, cosine, sine, sub(v, p)), p)


@inner
def _positions(numbers: Pointer, w: Three, arms: Pointer, like: Vector) -> Mask:
    """Write the choices of q1, q2, q3 that bring the point to w; return where that is unsure.

    Those of an arm that begins with its slide are counted from the tip.
    """
    h1, h2, h3 = vector(numbers, H1), vector(numbers, H2), vector(numbers, H3)
    p1, p2, p3 = vector(numbers, P1), vector(numbers, P2), vector(numbers, P3)
    o = splat(0.0, like)
    x, y, z = vector(numbers, WRIST)
    w0 = (o + x, o + y, o + z)
    if numbers[REVERSED] == 1.0:
        h1, h3, p1, p3, w, w0 = h3, h1, p3, p1, w0, w
    variant, slides, size = numbers[VARIANT], numbers[SLIDES] == 1.0, numbers[SIZE]
    if variant == ELBOW:
        return _elbow(h1, h2, h3, p1, p2, p3, w0, w, slides, size, arms)
    if variant == SHOULDER:
        return _shoulder(h1, h2, h3, p1, p3, w0, w, slides, size, arms)
    return _column(h1, h2, h3, p1, p2, p3, w0, w, slides, size, arms)


@inner
def _elbow(
    h1: Three,
    h2: Three,
    h3: Three,
    p1: Three,
    p2: Three,
    p3: Three,
    w0: Three,
    w: Three,
    slides: bool,
    size: float,
    arms: Pointer,
) -> Mask:
    """Solve joint 1 from the component along axis 2, then a plane arm of two joints."""
    x = sub(w, p1)
    back = (-h1[0], -h1[1], -h1[2])
    first, unsure, sharp1, middle1, half1 = component(h2, back, x, dot(h2, sub(w0, p1)), size)
    for i in range(2):
        q1 = one_of(middle1, half1, i)
        sine, cosine = sine_cosine(q1, 0.0)
        y = sub(add(turn(h1, cosine, -sine, x), p1), p2)
        third, doubt, sharp3, middle3, half3 = _third(h3, p3, w0, slides, p2, dot(y, y), size)
        exists = first & third
        unsure = unsure | (first & doubt)
        for j in range(2):
            q3 = one_of(middle3, half3, j)
            loose, sharp2, q2 = align(h2, sub(_moved(h3, p3, w0, slides, q3), p2), y, size)
            unsure = unsure | (exists & loose)
            _put(arms, 2 * i + j, q1, q2, q3, exists, sharp1 * sharp2 * sharp3)
    return unsure


@inner
def _shoulder(
    h1: Three,
    h2: Three,
    h3: Three,
    centre: Three,
    p3: Three,
    w0: Three,
    w: Three,
    slides: bool,
    size: float,
    arms: Pointer,
) -> Mask:
    """Solve axes 1 and 2 that meet: joint 3 from the distance to that point, then two turns."""
    goal = sub(w, centre)
    square = dot(goal, goal)
    third, unsure, sharp3, middle, half = _third(h3, p3, w0, slides, centre, square, size)
    unsure = unsure | (square < SMALL * SMALL * size * size)
    to_goal, tilt = angle_between(h1, goal), angle_between(h1, add(scale(0.0, goal), h2))
    before = sub(h1, scale(dot(h1, h2), h2))
    for i in range(2):
        q3 = one_of(middle, half, i)
        x = sub(_moved(h3, p3, w0, slides, q3), centre)
        across = sub(x, scale(dot(h2, x), h2))
        there, doubt, bent, turned = dihedral(tilt, angle_between(h2, x), to_goal)
        exists = third & there
        on_axis = dot(across, across) < SMALL * SMALL * size * size
        unsure = unsure | (third & (doubt | on_axis))
        zero = signed_angle(dot(h2, cross(before, across)), dot(before, across))
        for j in range(2):
            q2 = (turned if j == 0 else -turned) - zero
            sine, cosine = sine_cosine(q2, 0.0)
            loose, sharp1, q1 = align(h1, turn(h2, cosine, sine, x), goal, size)
            unsure = unsure | (exists & loose)
            _put(arms, 2 * i + j, q1, q2, q3, exists, sharp1 * bent * sharp3)
    return unsure


@inner
def _column(
    h1: Three,
    h2: Three,
    h3: Three,
    p1: Three,
    p2: Three,
    p3: Three,
    w0: Three,
    w: Three,
    slides: bool,
    size: float,
    arms: Pointer,
) -> Mask:
    """Solve axes 1 and 2 parallel: joint 3 from the component along them, then a plane 2R."""
    goal = sub(w, p1)
    square = dot(goal, goal)
    if slides:
        middle = dot(h1, sub(w, w0)) / dot(h1, h3)
        half, sharp3 = 0.0 * middle, 0.0 * middle + 1.0
        third, unsure = half == 0.0, half < 0.0
    else:
        third, unsure, sharp3, middle, half = component(
            h1, h3, sub(w0, p3), dot(h1, sub(w, p3)), size
        )
    for i in range(2):
        q3 = one_of(middle, half, i)
        x = _moved(h3, p3, w0, slides, q3)
        second, doubt, sharp2, middle2, half2 = distance(h2, sub(x, p2), sub(p1, p2), square, size)
        exists = third & second
        unsure = unsure | (third & doubt)
        if slides and i == 1:
            exists = exists & ~exists
        for j in range(2):
            q2 = one_of(middle2, half2, j)
            loose, sharp1, q1 = align(h1, sub(_swing(h2, p2, q2, x), p1), goal, size)
            unsure = unsure | (exists & loose)
            _put(arms, 2 * i + j, q1, q2, q3, exists, sharp1 * sharp2 * sharp3)
    return unsure
