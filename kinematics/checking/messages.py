"""What slips are called, in sentences for students."""

from __future__ import annotations

from dh_to_urdf.messages import say
from kinematics.checking.slips import Slip

_ANGLES = {
    "": say("the joint values"),
    "all angles": say("the joint values and the constants of the table"),
}


def _degrees(slip: Slip) -> str:
    if slip.detail == "columns":
        return say("the columns are per degree; a Jacobian is per radian")
    if slip.detail == "answer":
        return say("the angles of the answer are in degrees where radians are asked")
    if slip.detail == "table":
        return say("the constant angles of the table are in degrees where radians are asked")
    return say(
        "{angle} went into sin and cos as degrees, where radians are taken",
        angle=_ANGLES[slip.detail],
    )


def _radians(slip: Slip) -> str:
    if slip.detail == "answer":
        return say("the angles of the answer are in radians where degrees are asked")
    if slip.detail == "table":
        return say("the constant angles of the table are in radians where degrees are asked")
    return say(
        "{angle} went into sin and cos as radians, where degrees are taken (a"
        " calculator in degree mode)",
        angle=_ANGLES[slip.detail],
    )


def _neighbour(what: str, slip: Slip) -> str:
    side = say("the row below") if slip.detail == "below" else say("the row above")
    if slip.where:
        return say("{what} of {where} is that of {side}", what=what, where=slip.where, side=side)
    return say(
        "{what} of every row is that of {side}: standard and modified tables differ in this",
        what=what,
        side=side,
    )


def _transposed(slip: Slip) -> str:
    if slip.detail == "rotation":
        return say("the rotation is transposed: its columns are the axes of the frame in base axes")
    return say("the matrix is transposed: rows stand where columns should")


def _joint_sign(slip: Slip) -> str:
    if slip.detail == "column":
        return say("the column of {where} has the opposite sign", where=slip.where)
    return say("{where} turns or slides the other way: its sign is reversed", where=slip.where)


def _order(slip: Slip) -> str:
    if slip.detail == "reversed":
        return say("the joint values are taken in reversed order")
    return say("the values of {detail} are exchanged", detail=slip.detail)


def _missing(slip: Slip) -> str:
    where = say("of {where} ", where=slip.where) if slip.where else say("of the joints ")
    return say("the offset {where}is left out: the variable is q + offset", where=where)


def _point(slip: Slip) -> str:
    place = (
        say("the origin of the base")
        if slip.detail == "base"
        else say("the origin of {where}", where=slip.where)
    )
    return say("the linear rows are the velocity of another point: {place}", place=place)


def _frame(slip: Slip) -> str:
    axes = {
        "frame": say("in the axes of the frame instead of the base"),
        "base": say("in the axes of the base instead of the frame"),
        "local": say("in the frame's own axes, at its origin, instead of the base's"),
        "world": say("in base axes, of the point at the origin of the base"),
    }
    return say("the Jacobian is written {axe}", axe=axes[slip.detail])


def message_of(slip: Slip) -> str:
    """Return what a slip is, as a sentence without a full stop."""
    where = slip.where
    match slip.code:
        case "degrees_for_radians":
            return _degrees(slip)
        case "radians_for_degrees":
            return _radians(slip)
        case "modified_for_standard":
            return say(
                "the table is standard (A = Rz Tz Tx Rx) but was used as modified (Tx Rx Rz Tz)"
            )
        case "standard_for_modified":
            return say(
                "the table is modified (A = Tx Rx Rz Tz) but was used as standard (Rz Tz Tx Rx)"
            )
        case "standard_for_khalil":
            return say(
                "the table is Khalil-Kleinfinger's (A = Rx Tx Rz Tz) but was used as"
                " standard (Rz Tz Tx Rx)"
            )
        case "alpha_of_neighbour_row":
            return _neighbour("alpha", slip)
        case "a_of_neighbour_row":
            return _neighbour("a", slip)
        case "alpha_and_a_of_neighbour_row":
            return _neighbour(say("alpha and a"), slip)
        case "alpha_sign" | "a_sign" | "d_sign" | "offset_sign":
            column = slip.code.removesuffix("_sign")
            return say(
                "{column} of {where} has the opposite sign",
                column=column,
                where=where or say("every row"),
            )
        case "offset_missing":
            return _missing(slip)
        case "a_missing" | "d_missing":
            return say(
                "{column} of {where} is left out",
                column=slip.code.removesuffix("_missing"),
                where=where,
            )
        case "row_missing":
            return say("the row of {where} is left out of the product", where=where)
        case "tool_forgotten":
            return say("the tool is left out: T ends with the tool's placement")
        case "base_forgotten":
            return say("the base is left out: T begins with the base's placement")
        case "joint_sign":
            return _joint_sign(slip)
        case "joints_in_other_order":
            return _order(slip)
        case "order_reversed":
            return say("the matrices are multiplied in the other order: T is A1 A2 … An")
        case _:
            return _of_answer(slip)


def _of_answer(slip: Slip) -> str:
    """Return what a slip in the writing of an answer is."""
    where, detail = slip.where, slip.detail
    match slip.code:
        case "transposed":
            return _transposed(slip)
        case "inverted":
            return say("this is the inverse: the pose of the base in the frame")
        case "mm_for_m":
            return say(
                "lengths{value} are in mm where m are asked",
                value=say(" of {where}", where=where) if where else "",
            )
        case "m_for_mm":
            return say("lengths are in m where mm are asked")
        case "cm_for_m":
            return say("lengths are in cm where m are asked")
        case "rows_swapped":
            return say(
                "the angular rows stand above the linear ones; here the linear rows come first"
            )
        case "other_point":
            return _point(slip)
        case "other_frame":
            return _frame(slip)
        case "axes_of_neighbour_frame":
            return say(
                "the axis of each joint is taken from the wrong frame: joint k turns"
                " about z of frame k - 1 (standard) or k (modified)"
            )
        case "geometric_for_analytic":
            return say(
                "this is the geometric Jacobian: its angular rows are no rates of Euler angles"
            )
        case "opposite_sign":
            return say(
                "the sign is opposite: two rows or columns are exchanged, or one is reversed"
            )
        case "without_sign":
            return say("the determinant without its sign")
        case "transpose_for_inverse":
            return say("the step uses the transpose of the Jacobian in the place of its inverse")
        case "null_motion_forgotten":
            return say("the motion in the null space, (I - J†J) z, is left out")
        case "null_motion_not_projected":
            return say("z is added without its projection into the null space, I - J†J")
        case "other_index":
            return say("this is the matrix of {where}", where=where)
        case "other_sequence":
            return say("these are the angles of the sequence {detail}", detail=detail)
        case "rpy_for_euler":
            return say(
                "these are roll, pitch, yaw ({detail}), not the angles of the sequence asked",
                detail=detail,
            )
        case "angles_in_other_order":
            return say("the three angles stand in the other order")
        case "angle_sign":
            return say(
                "the {where} angle has the opposite sign, or is of the other solution", where=where
            )
        case "quadrant":
            return say(
                "the {where} angle is in the wrong quadrant: atan2 instead of atan finds it",
                where=where,
            )
        case "rounded":
            return say("right, but rounded to {detail}; give more decimals", detail=detail)
        case "truncated":
            return say(
                "right, but cut off after {detail} without rounding; give more decimals",
                detail=detail,
            )
        case "length_missing":
            return say(
                "the formula lacks {where}: it is right only where {where} is {detail} m",
                where=where,
                detail=detail,
            )
        case "sin_and_cos_exchanged":
            return say("sin stands where cos should, and the other way round")
        case "not_finite":
            return say("a formula has no finite value: a division by 0, or the root of a negative")
        case "false_solution":
            return say("solution {where} does not reach the target", where=where)
        case "double_solution":
            return say(
                "solution {where} is solution {detail} again, up to whole turns",
                where=where,
                detail=detail,
            )
        case "missing_solutions":
            return say("{detail} more solutions reach the target", detail=detail)
        case "missing_solution":
            return say("one more solution reaches the target")
        case "columns_swapped":
            return say(
                "the columns {detail} are exchanged{value}",
                detail=detail,
                value=say(" in the row of {where}", where=where) if where else "",
            )
        case _:
            raise KeyError(slip.code)
