"""What slips are called, in sentences for students."""

from __future__ import annotations

from kinematics.checking.slips import Slip

_ANGLES = {"": "the joint values", "all angles": "the joint values and the constants of the table"}


def _degrees(slip: Slip) -> str:
    if slip.detail == "columns":
        return "the columns are per degree; a Jacobian is per radian"
    if slip.detail == "answer":
        return "the angles of the answer are in degrees where radians are asked"
    if slip.detail == "table":
        return "the constant angles of the table are in degrees where radians are asked"
    return f"{_ANGLES[slip.detail]} went into sin and cos as degrees, where radians are taken"


def _radians(slip: Slip) -> str:
    if slip.detail == "answer":
        return "the angles of the answer are in radians where degrees are asked"
    if slip.detail == "table":
        return "the constant angles of the table are in radians where degrees are asked"
    return (
        f"{_ANGLES[slip.detail]} went into sin and cos as radians, where degrees are taken (a"
        " calculator in degree mode)"
    )


def _neighbour(what: str, slip: Slip) -> str:
    side = "the row below" if slip.detail == "below" else "the row above"
    if slip.where:
        return f"{what} of {slip.where} is that of {side}"
    return f"{what} of every row is that of {side}: standard and modified tables differ in this"


def _transposed(slip: Slip) -> str:
    if slip.detail == "rotation":
        return "the rotation is transposed: its columns are the axes of the frame in base axes"
    return "the matrix is transposed: rows stand where columns should"


def _joint_sign(slip: Slip) -> str:
    if slip.detail == "column":
        return f"the column of {slip.where} has the opposite sign"
    return f"{slip.where} turns or slides the other way: its sign is reversed"


def _order(slip: Slip) -> str:
    if slip.detail == "reversed":
        return "the joint values are taken in reversed order"
    return f"the values of {slip.detail} are exchanged"


def _missing(slip: Slip) -> str:
    where = f"of {slip.where} " if slip.where else "of the joints "
    return f"the offset {where}is left out: the variable is q + offset"


def _point(slip: Slip) -> str:
    place = "the origin of the base" if slip.detail == "base" else f"the origin of {slip.where}"
    return f"the linear rows are the velocity of another point: {place}"


def _frame(slip: Slip) -> str:
    axes = {
        "frame": "in the axes of the frame instead of the base",
        "base": "in the axes of the base instead of the frame",
        "local": "in the frame's own axes, at its origin, instead of the base's",
        "world": "in base axes, of the point at the origin of the base",
    }
    return f"the Jacobian is written {axes[slip.detail]}"


def message_of(slip: Slip) -> str:
    """Return what a slip is, as a sentence without a full stop."""
    where = slip.where
    match slip.code:
        case "degrees_for_radians":
            return _degrees(slip)
        case "radians_for_degrees":
            return _radians(slip)
        case "modified_for_standard":
            return "the table is standard (A = Rz Tz Tx Rx) but was used as modified (Tx Rx Rz Tz)"
        case "standard_for_modified":
            return "the table is modified (A = Tx Rx Rz Tz) but was used as standard (Rz Tz Tx Rx)"
        case "standard_for_khalil":
            return (
                "the table is Khalil-Kleinfinger's (A = Rx Tx Rz Tz) but was used as standard (Rz"
                " Tz Tx Rx)"
            )
        case "alpha_of_neighbour_row":
            return _neighbour("alpha", slip)
        case "a_of_neighbour_row":
            return _neighbour("a", slip)
        case "alpha_and_a_of_neighbour_row":
            return _neighbour("alpha and a", slip)
        case "alpha_sign" | "a_sign" | "d_sign" | "offset_sign":
            column = slip.code.removesuffix("_sign")
            return f"{column} of {where or 'every row'} has the opposite sign"
        case "offset_missing":
            return _missing(slip)
        case "a_missing" | "d_missing":
            return f"{slip.code.removesuffix('_missing')} of {where} is left out"
        case "row_missing":
            return f"the row of {where} is left out of the product"
        case "tool_forgotten":
            return "the tool is left out: T ends with the tool's placement"
        case "base_forgotten":
            return "the base is left out: T begins with the base's placement"
        case "joint_sign":
            return _joint_sign(slip)
        case "joints_in_other_order":
            return _order(slip)
        case "order_reversed":
            return "the matrices are multiplied in the other order: T is A1 A2 … An"
        case _:
            return _of_answer(slip)


def _of_answer(slip: Slip) -> str:
    """Return what a slip in the writing of an answer is."""
    where, detail = slip.where, slip.detail
    match slip.code:
        case "transposed":
            return _transposed(slip)
        case "inverted":
            return "this is the inverse: the pose of the base in the frame"
        case "mm_for_m":
            return f"lengths{f' of {where}' if where else ''} are in mm where m are asked"
        case "m_for_mm":
            return "lengths are in m where mm are asked"
        case "cm_for_m":
            return "lengths are in cm where m are asked"
        case "rows_swapped":
            return "the angular rows stand above the linear ones; here the linear rows come first"
        case "other_point":
            return _point(slip)
        case "other_frame":
            return _frame(slip)
        case "axes_of_neighbour_frame":
            return (
                "the axis of each joint is taken from the wrong frame: joint k turns about z of"
                " frame k - 1 (standard) or k (modified)"
            )
        case "geometric_for_analytic":
            return "this is the geometric Jacobian: its angular rows are no rates of Euler angles"
        case "opposite_sign":
            return "the sign is opposite: two rows or columns are exchanged, or one is reversed"
        case "without_sign":
            return "the determinant without its sign"
        case "transpose_for_inverse":
            return "the step uses the transpose of the Jacobian in the place of its inverse"
        case "null_motion_forgotten":
            return "the motion in the null space, (I - J†J) z, is left out"
        case "null_motion_not_projected":
            return "z is added without its projection into the null space, I - J†J"
        case "other_index":
            return f"this is the matrix of {where}"
        case "other_sequence":
            return f"these are the angles of the sequence {detail}"
        case "rpy_for_euler":
            return f"these are roll, pitch, yaw ({detail}), not the angles of the sequence asked"
        case "angles_in_other_order":
            return "the three angles stand in the other order"
        case "angle_sign":
            return f"the {where} angle has the opposite sign, or is of the other solution"
        case "quadrant":
            return f"the {where} angle is in the wrong quadrant: atan2 instead of atan finds it"
        case "rounded":
            return f"right, but rounded to {detail}; give more decimals"
        case "truncated":
            return f"right, but cut off after {detail} without rounding; give more decimals"
        case "length_missing":
            return f"the formula lacks {where}: it is right only where {where} is {detail} m"
        case "sin_and_cos_exchanged":
            return "sin stands where cos should, and the other way round"
        case "not_finite":
            return "a formula has no finite value: a division by 0, or the root of a negative"
        case "false_solution":
            return f"solution {where} does not reach the target"
        case "double_solution":
            return f"solution {where} is solution {detail} again, up to whole turns"
        case "missing_solutions":
            return f"{detail} more solutions reach the target"
        case "missing_solution":
            return "one more solution reaches the target"
        case "columns_swapped":
            return f"the columns {detail} are exchanged{f' in the row of {where}' if where else ''}"
        case _:
            raise KeyError(slip.code)
