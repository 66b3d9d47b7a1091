"""Find all q that reach a target: in closed form, by polynomial equations, or by search."""

from __future__ import annotations

from weakref import WeakKeyDictionary

from dh_to_urdf.messages import say
from kinematics.chain import Chain, chain_of
from kinematics.errors import InvalidOption
from kinematics.inverse.api import solve_ik
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.branches import (
    add,
    algebraic_solutions,
    closed_form_once,
    closed_form_solutions,
    ordered,
    shown,
)
from kinematics.inverse.closed_form import closed_form_of
from kinematics.inverse.result import IKOptions, IKStatus, Tolerance
from kinematics.inverse.search import search
from kinematics.inverse.self_motion.families import joint_family
from kinematics.inverse.self_motion.parameter import parameter_of
from kinematics.inverse.solutions import IKSolution, IKSolutions
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

DEFAULTS = IKOptions()
OWN_SECONDS = 0.05
"""Time for the numeric solver beside the curves of an arm."""


def all_solutions(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    options: IKOptions | None = None,
    swivel: float | None = None,
) -> IKSolutions:
    """Find every q that brings a frame to a target.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: Reference for turns, free joints and the order; default mid-range.
        options: For the search.
        swivel: Swivel angle that is wished, rad, of an arm with a spherical shoulder and wrist;
            None: several are shown.

    Returns:
        The solutions, also those beyond the limits where they are not searched.

    Raises:
        UnknownFrame: The robot has no such frame.
        InvalidOption: The arm has no swivel angle.
    """
    name = robot.tip_frame if frame is None else frame
    options = options or DEFAULTS
    found = exact_solutions(
        robot, target, frame=name, task=task, seed=seed, tolerance=options.tolerance, swivel=swivel
    )
    if found is not None:
        return found
    chain, start = chain_of(robot, name), _start(robot, seed)
    if parameter_of(chain, task) is None:
        return ordered(search(robot, chain, target, name, task, start, options))
    own = solve_ik(
        robot, target, frame=name, task=task, seed=start, options=options.within(OWN_SECONDS)
    )
    known = own.q if own.status is IKStatus.CONVERGED else None
    found = curve_solutions(robot, target, frame=name, task=task, seed=seed, known=known)
    assert found is not None
    return found


def exact_solutions(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    tolerance: Tolerance | None = None,
    swivel: float | None = None,
) -> IKSolutions | None:
    """Find every q that brings a frame to a target, without search.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: Reference for turns, free joints and the order; default mid-range.
        tolerance: For solutions that touch a limit.
        swivel: As of :func:`all_solutions`.

    Returns:
        The solutions, also those beyond the limits; None where the arm has neither a closed form
        nor as many joints as the task has rows.

    Raises:
        UnknownFrame: The robot has no such frame.
        InvalidOption: The arm has no swivel angle.
    """
    chain = chain_of(robot, robot.tip_frame if frame is None else frame)
    start, tolerance = _start(robot, seed), tolerance or DEFAULTS.tolerance
    if swivel is not None:
        _check_swivel(chain, task, swivel)
    found = closed_form_solutions(robot, chain, target, task, start, tolerance, swivel)
    if found is None:
        found = algebraic_solutions(robot, chain, target, task, start, tolerance)
    return found


def solutions_at_once(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    tolerance: Tolerance | None = None,
) -> IKSolutions | None:
    """Find every q that reaches a target where that takes a fraction of a millisecond.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: As of :func:`all_solutions`.
        tolerance: For solutions that touch a limit.

    Returns:
        What :func:`all_solutions` returns; None where the arm has no closed form of single
        solutions, a target leaves a joint free, or none is within the limits.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    chain = chain_of(robot, robot.tip_frame if frame is None else frame)
    form = closed_form_of(chain.mechanism)
    if form is None or form.kind == "srs" or chain.is_coupled:
        return None
    start, tolerance = _start(robot, seed), tolerance or DEFAULTS.tolerance
    found = closed_form_once(robot, chain, target, task, start, tolerance)
    if found is None or not any(one.within_limits for one in found.solutions):
        return None
    return None if any(one.free for one in found.solutions) else found


def _start(robot: Robot, seed: FloatArray | None) -> FloatArray:
    if seed is not None:
        return JointBounds.of(robot).inside(seed)
    middle = _MIDDLES.get(robot)
    if middle is None:
        bounds = JointBounds.of(robot)
        middle = _MIDDLES[robot] = bounds.inside(bounds.middle())
    return middle.copy()


_MIDDLES: WeakKeyDictionary[Robot, FloatArray] = WeakKeyDictionary()


def _check_swivel(chain: Chain, task: Task, swivel: float) -> None:
    form = closed_form_of(chain.mechanism)
    if form is None or form.kind != "srs" or task.name not in form.tasks:
        raise InvalidOption(
            say(
                "swivel is the angle of an arm of seven joints with a spherical shoulder and wrist,"
                " for task pose, which this is not; leave it out, and give a seed instead"
            ),
            argument="swivel",
            value=swivel,
        )


def curve_solutions(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    known: FloatArray | None = None,
) -> IKSolutions | None:
    """Return solutions on the self-motions of an arm with one joint more than the task has rows.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: As of :func:`all_solutions`.
        known: A solution that is known, shape (dof,).

    Returns:
        None where the arm is another.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    chain = chain_of(robot, robot.tip_frame if frame is None else frame)
    start = _start(robot, seed)
    point = None if known is None else known[chain.columns]
    family = joint_family(robot, chain, task, target, start, point)
    if family is None:
        return None
    collected: list[IKSolution] = []
    for one in family.representatives:
        add(robot, collected, shown(robot, chain, target, task, one))
    found = IKSolutions(
        "algebraic", False, family.description, start, tuple(collected), family.motion
    )
    return ordered(found)
