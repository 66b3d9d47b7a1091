"""From a table to its inverse model, or to the reason why there is none in closed form."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from fractions import Fraction

import numpy as np

from dh_to_urdf.messages import chained, plural, say
from dh_to_urdf.table import Convention, DHTable
from kinematics.symbolic.expressions import symbols
from kinematics.symbolic.inverse_model.all_parallel import all_parallel
from kinematics.symbolic.inverse_model.arm import (
    LENGTH,
    Arm,
    FixedBetween,
    arm_of,
    constant,
    coordinates,
    pose_of,
)
from kinematics.symbolic.inverse_model.builder import Builder, InverseNames, flat, twist
from kinematics.symbolic.inverse_model.first_three import (
    FRONT,
    RANKS,
    REACH,
    SENSE,
    column,
    column_slide,
    elbow,
    general,
    shoulder,
    telescope,
)
from kinematics.symbolic.inverse_model.parallel_axes import SIDES, TURNS, parallel_axes
from kinematics.symbolic.inverse_model.plane_arm import ELBOW
from kinematics.symbolic.inverse_model.shoulder_elbow_wrist import ends, shoulder_elbow_wrist
from kinematics.symbolic.inverse_model.slides import directions, three_slides, turn_and_slides
from kinematics.symbolic.inverse_model.statements import (
    Coordinate,
    Derivation,
    hoisted,
    symbols_of,
)
from kinematics.symbolic.inverse_model.target import (
    Target,
    end_of_three,
    named_rotation,
    say_taken_off,
    target_of,
    turned,
    without_base_and_tool,
)
from kinematics.symbolic.inverse_model.wrist import FLIP, wrist
from kinematics.symbolic.length_names import Length, written_name
from kinematics.symbolic.parameters import lengths_of, unusual_angles
from kinematics.symbolic.polynomial import Polynomial
from kinematics.symbolic.request import SymbolicRequest
from kinematics.symbolic.steps import Rotation, Vector

MAX_UNUSUAL = 2
FIRST = ("RRR", "RRP", "RPP", "PPP")
"""Three joints that place a point in closed form."""
FirstThree = Callable[[Builder, Arm, Vector, Polynomial], None]


class NoClosedForm(ValueError):
    """There is no inverse model in closed form; the text says why."""


def derive(table: DHTable, request: SymbolicRequest) -> Derivation:
    """Return the inverse model of a table.

    Args:
        table: The table.
        request: Names of lengths, base and frame.

    Raises:
        NoClosedForm: There is none.
    """
    taken = reserved(table, request)
    names = InverseNames(
        table.dof,
        request.parameters == "symbolic",
        {**dict(request.symbols), **{length.name: length.name for length in taken}},
        rounded=unusual_angles(table) > MAX_UNUSUAL,
    )
    try:
        arm = arm_of(table, names, request.base, request.frame)
    except FixedBetween:
        raise NoClosedForm(
            say(
                "a fixed row between two joints turns and shifts at once; write the table of the"
                " joints that move alone"
            )
        ) from None
    builder = Builder(
        names,
        khalil=table.convention is Convention.KHALIL,
        first_matrix="A1" if table.convention is Convention.STANDARD else "0T1",
    )
    back = _back(table, arm)
    target = target_of(builder)
    kind, description, postures, most = _solved(builder, arm, target)
    notes: list[str] = [
        say(
            "{name} is a word of the functions here; the length is called {default}",
            name=named,
            default=length.name,
        )
        for length, named in taken.items()
    ]
    return _derivation(
        table, request, builder, arm, target, (kind, description, postures, most), back, notes
    )


_WORDS = frozenset(
    (
        *("T", "given", "size", "count", "solutions", "root", "signs", "wrap", "either", "angles"),
        *("hypot", "atan2", "free", "posture", "values", "value", "rank", "ranks", "i", "j", "k"),
        *("n", "first_sign", "real_roots", "polynomial", "inverse_model", "inverse_solution"),
        *("isnan", "NAN", "fabs", "fmax", "pow", "sorted", "sum", "enumerate", "nargin", "zeros"),
        *("struct", "find", "numel", "norm", "abs", "sign", "end", "function", "roots", "all"),
    )
)
"""Words that the functions use themselves."""


def reserved(table: DHTable, request: SymbolicRequest) -> dict[Length, str]:
    """Return the lengths whose names the functions need themselves, with these names."""
    symbolic = request.parameters == "symbolic"
    chosen = dict(request.symbols)
    found = {}
    for length in lengths_of(table):
        name, _ = written_name(length, chosen, symbolic=symbolic)
        if (
            name is not None
            and name != length.name
            and (name in _WORDS or re.fullmatch(r"(theta|posture|free)\d*", name))
        ):
            found[length] = name
    return found


def _solved(
    builder: Builder, arm: Arm, target: Target
) -> tuple[str, str, tuple[tuple[str, ...], ...], int]:
    links, count = arm.links, len(arm.links)
    if not 2 <= count <= 7:
        raise NoClosedForm(
            plural(
                "the frame has {count} joint before it; closed forms are known of 2 to 7",
                "the frame has {count} joints before it; closed forms are known of 2 to 7",
                count=count,
            )
        )
    lifted = count == 3 and arm.types in FIRST and arm.types != "RRR"
    if all(flat(link.alpha) for link in links[:-1]) and not lifted:
        return _flat(builder, arm, target)
    if count == 6:
        return _six(builder, arm, target)
    if count == 3:
        return _three(builder, arm, target)
    if arm.types == "RRRRRRR" and _is_srs(builder, arm):
        R, centre = _wrist_centre(builder, arm, target)
        shoulder_elbow_wrist(builder, arm, R, centre, builder.names.fresh(SWIVEL))
        text = say("spherical shoulder, elbow, spherical wrist")
        return "srs", text, (SENSE, SENSE, SENSE), 8
    raise NoClosedForm(_why(builder, arm))


def _flat(
    builder: Builder, arm: Arm, target: Target
) -> tuple[str, str, tuple[tuple[str, ...], ...], int]:
    turning = arm.types.count("R")
    slides = len(arm.links) - turning
    up = pose_of(arm.mount, builder.names).axes[2]
    across = math.hypot(builder.constant(up[0]), builder.constant(up[1]))
    if (turning, slides) not in ((2, 0), (3, 0), (3, 1)):
        raise NoClosedForm(
            say(
                "all axes are parallel; a closed form is known of two or three turns, and of"
                " three turns with one slide (SCARA)"
            )
        )
    if not slides and across > 1e-8:
        raise NoClosedForm(
            say(
                "the axes of this plane arm are not along z of base_link, so that x and y of the"
                " base are no target for it"
            )
        )
    if not all_parallel(builder, arm, target):
        raise NoClosedForm(
            say("one of the two links of this plane arm has no length; ask ik/solutions")
        )
    kind, text = {
        (2, 0): ("planar_2r", say("planar 2R: two parallel axes")),
        (3, 0): ("planar_3r", say("planar 3R: three parallel axes")),
        (3, 1): (
            "scara",
            say("SCARA: three turns and a slide about and along parallel axes"),
        ),
    }[turning, slides]
    return kind, text, (ELBOW,), 2


def _three(
    builder: Builder, arm: Arm, target: Target
) -> tuple[str, str, tuple[tuple[str, ...], ...], int]:
    """Solve three joints for the position of the frame."""
    found = _first_three(builder, arm) if arm.types in FIRST else None
    if found is None:
        raise NoClosedForm(_why(builder, arm))
    solve, text, choices = found
    builder.step(say("The position seen from axis 1"))
    builder.remark(say("Of the target X, Y and Z count alone."))
    w = end_of_three(builder, arm, target)
    if w == target.origin:
        builder.remark(say("It is the origin of the frame itself: X, Y, Z."))
    x, y, z = (builder.let(f"{a}w", p) for a, p in zip("xyz", w, strict=True))
    solve(builder, arm, (x, y, z), Polynomial({}))
    return "three_joints", say("three joints; {text}", text=text), (*choices, ("",)), 4


def _six(
    builder: Builder, arm: Arm, target: Target
) -> tuple[str, str, tuple[tuple[str, ...], ...], int]:
    if _meet_in_one_point(builder, arm):
        found = _first_three(builder, arm)
        if found is not None:
            solve, text, choices = found
            w = _wrist_centre(builder, arm, target)
            R, centre = w
            solve(builder, arm, centre, arm.links[3].slide)
            wrist(builder, arm, 3, turned(builder, arm, 0, 3), R, 2)
            return (
                "spherical_wrist",
                say("spherical wrist; {text}", text=text),
                (*choices, FLIP),
                8,
            )
    if _three_parallel(arm):
        R, centre = _wrist_centre(builder, arm, target)
        parallel_axes(builder, arm, R, centre)
        return (
            "parallel_axes",
            say("axes 2, 3 and 4 parallel, axes 5 and 6 apart")
            if arm.links[4].a
            else say("axes 2, 3 and 4 parallel, axes 5 and 6 meeting"),
            (RANKS if arm.links[4].a else SIDES, ELBOW, TURNS),
            16 if arm.links[4].a else 8,
        )
    raise NoClosedForm(_why(builder, arm))


def _wrist_centre(builder: Builder, arm: Arm, target: Target) -> tuple[Rotation, Vector]:
    if len(arm.links) == 7:
        builder.step(say("The centre of the wrist, where axes 5, 6 and 7 meet"))
        count = 4
    elif _three_parallel(arm):
        builder.step(
            say("The point of axis 6 nearest to axis 5")
            if arm.links[4].a
            else say("The point where axes 5 and 6 meet")
        )
        count = 4
    else:
        builder.step(say("The centre of the wrist, where axes 4, 5 and 6 meet (Pieper)"))
        count = 3
    builder.remark(say("It depends on the first {count} joints alone.", count=count))
    last = arm.links[-1].slide
    say_taken_off(builder, arm, last)
    R, origin = without_base_and_tool(builder, arm, target, last)
    R = named_rotation(builder, R)
    if origin == target.origin:
        builder.remark(say("It is the origin of the frame itself: X, Y, Z."))
    x, y, z = (builder.let(f"{a}w", p) for a, p in zip("xyz", origin, strict=True))
    return R, (x, y, z)


SWIVEL = "swivel"


def _is_srs(builder: Builder, arm: Arm) -> bool:
    """Return whether axes 1, 2, 3 meet in one point and axes 5, 6, 7 in another, off axis 4."""
    one, two, _, _, five, six, _ = arm.links
    meeting = not (one.a or two.a or five.a or six.a) and all(
        _is_zero(builder, arm, link.slide) for link in (two, six)
    )
    if not meeting or any(flat(link.alpha) for link in (one, two, five, six)):
        return False
    return all(
        not (_is_zero(builder, arm, x) and _is_zero(builder, arm, y))
        for x, y, _ in ends(builder, arm)
    )


def _is_zero(builder: Builder, arm: Arm, p: Polynomial) -> bool:
    return not p or abs(constant(p, builder.names)) <= LENGTH * arm.size


def _meet_in_one_point(builder: Builder, arm: Arm) -> bool:
    """Return whether axes 4, 5 and 6 meet in one point, and do turn."""
    four, five, _ = arm.links[3:6]
    return (
        arm.types[:3] in FIRST
        and arm.types[3:] == "RRR"
        and not four.a
        and not five.a
        and _is_zero(builder, arm, five.slide)
        and not flat(four.alpha)
        and not flat(five.alpha)
    )


def _first_three(
    builder: Builder, arm: Arm
) -> tuple[FirstThree, str, tuple[tuple[str, ...], ...]] | None:
    one, two, three = arm.links[:3]
    kind = arm.types[:3]
    if kind in ("PPP", "RPP"):
        return _slides(builder, arm)
    if kind == "RRP":
        if flat(one.alpha):
            across = not twist(builder.names, two.alpha)[0]
            if across or not one.a:
                return None
            return column_slide, say("axes 1 and 2 parallel, joint 3 slides"), (ELBOW, ("",))
        if flat(two.alpha):
            return None
        if not one.a:
            return telescope, say("axes 1 and 2 meet, joint 3 slides"), (FRONT, REACH)
        if not twist(builder.names, two.alpha)[0]:
            return telescope, say("joint 3 slides across axis 2"), (FRONT, REACH)
        return None
    if len(arm.links) == 3:
        x, y, _ = pose_of(arm.after, builder.names).origin
        on_axis_3 = _is_zero(builder, arm, x) and _is_zero(builder, arm, y)
    else:
        along = arm.links[3].slide
        on_axis_3 = not three.a and (bool(flat(three.alpha)) or _is_zero(builder, arm, along))
    if on_axis_3:
        return None
    if flat(two.alpha) and not flat(one.alpha):
        return (elbow, say("axes 2 and 3 parallel"), (FRONT, ELBOW)) if two.a else None
    if flat(one.alpha):
        if flat(two.alpha) or not one.a:
            return None
        return column, say("axes 1 and 2 parallel"), (ELBOW, SENSE)
    if not one.a:
        if not two.a and _is_zero(builder, arm, two.slide):
            return None
        return shoulder, say("axes 1 and 2 meet"), (FRONT, SENSE)
    return general, say("axes 1, 2 and 3 in general position"), (RANKS, ("",))


def _slides(
    builder: Builder, arm: Arm
) -> tuple[FirstThree, str, tuple[tuple[str, ...], ...]] | None:
    """Return how slides place a point; None where they do not move it in three directions."""
    zero = Polynomial({})
    _, (first, second, third) = directions(builder, arm, (zero, zero, zero))
    one, two, three = (np.array([builder.constant(p) for p in v]) for v in (first, second, third))
    if abs(np.linalg.det([one, two, three])) <= 1e-8 and arm.types[:3] == "PPP":
        return None
    if arm.types[:3] == "PPP":
        return three_slides, say("joints 1, 2 and 3 slide"), (("",), ("",))
    if np.linalg.norm(np.cross(two, three)) <= 1e-8 or max(abs(two[2]), abs(three[2])) <= 1e-8:
        return None
    return (
        turn_and_slides,
        say("joint {turning} turns, the others slide", turning=1),
        (REACH, ("",)),
    )


def _three_parallel(arm: Arm) -> bool:
    one, two, three, four, five, _ = arm.links
    return (
        arm.types == "RRRRRR"
        and bool(flat(two.alpha) and flat(three.alpha))
        and not (flat(one.alpha) or flat(four.alpha) or flat(five.alpha))
        and bool(two.a and three.a)
    )


def _why(builder: Builder, arm: Arm) -> str:
    """Say which axes would have to meet or be parallel."""
    names = builder.names
    if len(arm.links) != 6:
        text = say(
            "of {count} joints ({types}) closed forms are written for plane arms, SCARA, six joints"
            " with a spherical wrist or axes 2, 3 and 4 parallel, and seven with a spherical"
            " shoulder and wrist",
            count=len(arm.links),
            types=arm.types,
        )
    else:
        del names
        text = say(
            "axes 4, 5 and 6 do not meet in one point (Pieper), nor are axes 2, 3 and 4 parallel"
        )
    return chained("", (text, say("; ik/solutions finds all solutions by algebra or search")))


def _back(table: DHTable, arm: Arm) -> list[tuple[dict[int, Fraction], int]]:
    """Return each entry of q in coordinates of the links, by index, with the entry's number.

    Raises:
        NoClosedForm: The coordinates do not determine q.
    """
    lines = coordinates(table, arm)
    entries = sorted({number for terms, _ in lines for number in terms})
    size = len(lines)
    if len(entries) != size:
        raise NoClosedForm(
            say(
                "the {joints} joints before the frame are moved by {count} entries of q: closed"
                " forms are written where each joint has its own; ask ik/solutions",
                joints=size,
                count=len(entries),
            )
        )
    matrix = [
        [Fraction(terms.get(number, 0.0)).limit_denominator(10**6) for number in entries]
        for terms, _ in lines
    ]
    inverse = _inverted(matrix)
    if inverse is None:
        raise NoClosedForm(say("the couplings of the joints have no inverse; ask ik/solutions"))
    return [
        ({k: value for k, value in enumerate(row) if value}, number)
        for row, number in zip(inverse, entries, strict=True)
    ]


def _inverted(matrix: list[list[Fraction]]) -> list[list[Fraction]] | None:
    n = len(matrix)
    rows = [[*row, *(Fraction(int(i == k)) for k in range(n))] for i, row in enumerate(matrix)]
    for place in range(n):
        pivot = next((i for i in range(place, n) if rows[i][place]), None)
        if pivot is None:
            return None
        rows[place], rows[pivot] = rows[pivot], rows[place]
        rows[place] = [value / rows[place][place] for value in rows[place]]
        for i in range(n):
            if i != place and rows[i][place]:
                factor = rows[i][place]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[place], strict=True)]
    return [row[n:] for row in rows]


def _derivation(
    table: DHTable,
    request: SymbolicRequest,
    builder: Builder,
    arm: Arm,
    target: Target,
    about: tuple[str, str, tuple[tuple[str, ...], ...], int],
    back: list[tuple[dict[int, Fraction], int]],
    notes: list[str],
) -> Derivation:
    kind, description, postures, most = about
    numbers = {k: number for terms, number in back for k in terms}
    ranked = numbers[2 if kind == "spherical_wrist" else 0] if postures[0] == RANKS else 0
    lines = coordinates(table, arm)
    found = []
    for terms, number in back:
        value, turn, is_angle = Polynomial({}), 0.0, False
        for k, factor in terms.items():
            link = arm.links[k]
            plain: int | Fraction = int(factor) if factor.denominator == 1 else factor
            constant_part = lines[k][1]
            if link.is_revolute:
                value += builder.theta(k + 1).scaled(plain * link.sign)
                turn -= float(factor) * (link.sign * link.turn + constant_part)
                is_angle = True
            else:
                slid = Polynomial.symbol(builder.slide_name(k + 1)) - link.slide
                value += (slid.scaled(link.sign) - builder.names.number(constant_part)).scaled(
                    plain
                )
        turn = math.remainder(turn, 2 * math.pi)
        found.append(Coordinate(f"q{number}", builder.sum(value), turn, is_angle))
    given = {
        k + 1: (
            tuple((number, link.sign * factor) for number, factor in lines[k][0].items()),
            link.sign * lines[k][1] + link.turn,
        )
        for k, link in enumerate(arm.links)
        if link.is_revolute
    }
    steps = tuple(hoisted(step) for step in builder.steps)
    used = set().union(*(symbols_of(one) for step in steps for one in step.statements))
    used = used.union(*(symbols(one.value) for one in found))
    if arm.rounded:
        notes.append(
            say("twists within 1e-8 rad of a multiple of pi/2, and tiny lengths, are taken as such")
        )
    return Derivation(
        kind,
        description,
        request.frame,
        request.base,
        table.dof,
        len(arm.links),
        target.places,
        {name: value for name, value in builder.names.lengths.items() if name in used},
        arm.size,
        steps,
        tuple(found),
        given,
        postures,
        most,
        ranked,
        SWIVEL if kind == "srs" else "",
        tuple(notes),
    )
