"""The fields of a path: geometry, obstacles, options; read into what kinematics takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields import texts
from app.fields.bounds import coordinates, items, within
from app.fields.doubts import FAR_THING
from app.fields.field import LEFT_OUT, Field, Parameter, declared
from app.fields.joints import SingleConfiguration, optional_configuration
from app.fields.lengths import LENGTH
from app.fields.names import TASK_META, Frame, TaskSpace, one_of
from app.fields.numbers import within_query
from app.fields.per_joint import PerJoint
from app.fields.targets import (
    ORIENTATION_FIELDS,
    OrientationFields,
    PathEnd,
    Target,
    target_pose,
)
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.operation import Context
from app.operations.path_links import GEOMETRIES, read_geometry, read_radius
from app.operations.retime import RetimeField
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import chained, say
from kinematics.errors import InvalidOption
from kinematics.forward import fk
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance import obstacles as solids
from kinematics.redundancy.clearance.links import skeleton
from kinematics.redundancy.follow import result_bytes, working_bytes
from kinematics.redundancy.methods.whole_path import MOST as MOST_PROGRAM
from kinematics.redundancy.path.geometry import Circle, Path, Sampling, circle, polyline
from kinematics.redundancy.path.time_law import TimeLaw
from kinematics.redundancy.problem import (
    Gains,
    PathOptions,
    PathProblem,
    PathTolerance,
    SecondaryTask,
)
from kinematics.redundancy.program.size import expression_bytes, sample_bytes
from kinematics.redundancy.timing.result import grid_bytes, motion_bytes
from kinematics.task import POSE, TASKS, task_from
from robots.robot import FloatArray, Robot

MAX_WAYPOINTS, MAX_SAMPLES = 1000, 10_000
MAX_SECONDARY = 16
TIME_LAWS = "linear, cubic, quintic or trapezoidal."
PLANES = {"xy": (0.0, 0.0, 1.0), "xz": (0.0, -1.0, 0.0), "yz": (1.0, 0.0, 0.0)}


class CircleField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """A circle about a center, through the start; the orientation is kept.

    Its axis is the normal, or that of a plane xy (default), xz or yz; turns counts whole ones,
    right-handed about the axis, negative the other way round.
    """

    center: Annotated[list[float], coordinates(2, 3), LENGTH]
    normal: Annotated[list[float] | None, coordinates(3)] = None
    plane: Annotated[
        str | None, msgspec.Meta(extra_json_schema=one_of(tuple(PLANES), null=True))
    ] = None
    turns: Annotated[float, within(-100, 100)] = 1.0


class SphereField(msgspec.Struct, tag="sphere", forbid_unknown_fields=True, kw_only=True):
    """A ball, m."""

    center: Annotated[list[float], LENGTH]
    radius: Annotated[float, within(0, 1e6), LENGTH]


class CircleObstacleField(msgspec.Struct, tag="circle", forbid_unknown_fields=True, kw_only=True):
    """A disc in the plane xy, at every height, m."""

    center: Annotated[list[float], LENGTH]
    radius: Annotated[float, within(0, 1e6), LENGTH]


class CapsuleField(msgspec.Struct, tag="capsule", forbid_unknown_fields=True, kw_only=True):
    """All that is within radius of a segment, m."""

    start: Annotated[list[float], LENGTH]
    end: Annotated[list[float], LENGTH]
    radius: Annotated[float, within(0, 1e6), LENGTH]


class HalfSpaceField(msgspec.Struct, tag="half_space", forbid_unknown_fields=True, kw_only=True):
    """All behind a plane: normal · p < offset, m along the unit normal. A floor: [0, 0, 1], 0."""

    normal: list[float]
    offset: Annotated[float, LENGTH] = 0.0


class BoxField(OrientationFields, tag="box", forbid_unknown_fields=True, kw_only=True):
    """A box with edges of a size, m, turned by one orientation."""

    center: Annotated[list[float], LENGTH]
    size: Annotated[list[float], LENGTH]


ObstacleField: TypeAlias = (
    SphereField | CircleObstacleField | CapsuleField | HalfSpaceField | BoxField
)


class PathToleranceField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Largest errors at a sample that count as on the path, m and rad."""

    position: Annotated[float, within(1e-9, 1e3), LENGTH] = 1e-4
    orientation: Annotated[float, within(1e-9, 1e3)] = 1e-4


@dataclass(frozen=True)
class PathToleranceForm(Field):
    """Largest errors; in a query one number for both."""

    def gathered(self, name: str, values: Mapping[str, Any]) -> PathToleranceField:
        """Return the tolerance that one number gives."""
        return PathToleranceField(position=values[name], orientation=values[name])


class GainsField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Weights of the potentials that the null-space motion goes down."""

    limits: Annotated[float, within(0, 1e6)] = 0.0
    manipulability: Annotated[float, within(0, 1e6)] = 0.0
    obstacles: Annotated[float, within(0, 1e6)] = 0.0
    posture: Annotated[float, within(0, 1e6)] = 0.0


class SecondaryField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """A task of lower priority: a frame is drawn to a target; without one it is held."""

    frame: str | None = None
    task: Annotated[str | list[int], TASK_META] = "position"
    target: Target | None = None
    gain: Annotated[float, within(0, 1)] = 0.1


class MethodOptions(msgspec.Struct, kw_only=True):
    """What methods may be told; each takes what concerns it."""

    closed_loop: Annotated[
        bool,
        msgspec.Meta(description="pseudo_inverse: false is the open loop, which drifts."),
    ] = True
    damping: Annotated[
        float, within_query(1e-9, 1e3, "damped: λ.", "0 (none), or such as 0.01.")
    ] = 0.01
    iterations: Annotated[
        int, msgspec.Meta(description="Most corrections in a sample."), within(1, 100)
    ] = 10
    gains: Annotated[
        GainsField | None, msgspec.Meta(description="null_space; default limits and obstacles.")
    ] = None
    posture: Annotated[
        FloatArray | None,
        optional_configuration("", "null_space: wanted q; default the start."),
    ] = None
    influence: Annotated[
        float | None,
        msgspec.Meta(
            description="Clearance from which on obstacles repel, m; default d_safe + a"
            " tenth of the arm."
        ),
        within(1e-9, 1e6),
        LENGTH,
    ] = None
    obstacle_weight: Annotated[
        float,
        msgspec.Meta(description="sqp: weight of the repulsion in its objective."),
        within(0, 1e6),
    ] = 0.0
    margin: Annotated[
        float,
        msgspec.Meta(
            description="sqp, qp, whole_path: kept on top of d_safe where the path leaves room for"
            " it, m."
        ),
        within(0, 1e3),
        LENGTH,
    ] = 1e-3
    secondary: Annotated[
        list[SecondaryField],
        msgspec.Meta(description="task_priority, highest priority first."),
        items(0, MAX_SECONDARY),
    ] = []
    perturb: Annotated[
        float,
        msgspec.Meta(
            description="Bends the joints by so much as the arm leaves the start, rad or"
            " m: out of a singular one."
        ),
        within(0, 1),
    ] = 0.0


class PathScenario(MethodOptions, kw_only=True):
    """From where, along what, among which obstacles."""

    q: Annotated[SingleConfiguration, msgspec.Meta(description="Start: sample 0.")]
    target: PathEnd = None
    waypoints: Annotated[
        list[Target] | None,
        msgspec.Meta(description="Corners of a polyline, each a sample."),
        items(1, MAX_WAYPOINTS),
    ] = None
    circle: CircleField | None = None
    frame: Frame = LEFT_OUT
    task: TaskSpace = POSE
    time_law: Annotated[
        str,
        declared(
            Field((Parameter(texts.text, TIME_LAWS),)),
            TIME_LAWS,
            one_of(TimeLaw),
        ),
    ] = "cubic"
    tf: Annotated[float, within_query(1e-6, 1e6, "Duration, s.", "Duration, s.")] = 2.0
    samples: Annotated[
        int,
        within_query(
            2,
            MAX_SAMPLES,
            "Samples, equally spaced in time, the start included.",
            "Number of samples, the start included.",
            texts.integer,
        ),
    ] = 101
    obstacles: Annotated[list[ObstacleField], items(0, 100)] = []
    link_radius: Annotated[
        PerJoint,
        msgspec.Meta(
            description="Radius of the capsules about the segments from each joint's origin to the"
            " next one's, the last to the frame; of an arm with slides from a D-H table about the"
            " way of the table: from frame k-1 along z by d, along x by a, to frame k (modified:"
            " along x, then z); m: one number, a list with one a joint in the robot's order, or an"
            " object {joint name: radius}.",
            examples=[0.05],
        ),
        LENGTH,
    ] = 0.0
    link_geometry: Annotated[
        str,
        msgspec.Meta(
            description="skeleton (default): those capsules. urdf: the collision shapes of the"
            " URDF, else its visual ones, of all that the arm moves, also beyond the frame: spheres"
            " and capsules as they are, boxes and cylinders as the least capsule about them;"
            " of meshes that were uploaded the least capsule about their convex hulls; for others"
            " the skeleton stands."
        ),
        msgspec.Meta(extra_json_schema=one_of(GEOMETRIES)),
    ] = "skeleton"
    d_safe: Annotated[
        float, msgspec.Meta(description="Clearance to keep, m."), within(0, 1e6), LENGTH
    ] = 0.0
    retime: Annotated[
        RetimeField | None,
        msgspec.Meta(
            description="The path in the shortest time (needs toppra, an extra).",
            examples=[{"acceleration": 5}],
        ),
    ] = None
    tolerance: Annotated[
        PathToleranceField,
        declared(PathToleranceForm((Parameter(texts.scalar, "Largest errors, m and rad."),))),
    ] = msgspec.field(default_factory=PathToleranceField)


def read_problem(robot: Robot, request: PathScenario, context: Context) -> PathProblem:
    """Return the problem of a request.

    Raises:
        KinematicsError: A field is out of range or does not fit.
        RequestProblem: Not one of target, waypoints and circle.
    """
    arm = Arm.of(robot, request.frame, request.task)
    q = request.q
    if request.time_law not in list(TimeLaw):
        raise InvalidOption(
            say(
                "time_law is {time_law}; give {timelaw}",
                time_law=quoted(request.time_law),
                timelaw=", ".join(TimeLaw),
            ),
            argument="time_law",
            value=request.time_law,
            known=tuple(TimeLaw),
        )
    sampling = Sampling(TimeLaw(request.time_law), request.tf, request.samples)
    radius = read_radius(request.link_radius, arm)
    return PathProblem(
        arm,
        q,
        _path(robot, arm, q, request, sampling, context),
        solids.encoded([_solid(one, k, context) for k, one in enumerate(request.obstacles)]),
        radius,
        request.d_safe,
        PathTolerance(request.tolerance.position, request.tolerance.orientation),
        read_geometry(request.link_geometry, radius, arm, q),
    )


def _path(
    robot: Robot,
    arm: Arm,
    q: FloatArray,
    request: PathScenario,
    sampling: Sampling,
    context: Context,
) -> Path:
    given = [
        name for name in ("target", "waypoints", "circle") if getattr(request, name) is not None
    ]
    if len(given) != 1:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "give one of target, waypoints and circle, not {given}",
                given=chained(say(" and "), given) or say("none"),
            ),
            f"/{given[1] if given else 'target'}",
        )
    start = fk(robot, q, [arm.frame])[arm.frame]
    if request.circle is not None:
        about = _circle(request.circle)
        context.doubts.place(about.center, say("the center of circle"))
        where = "normal" if request.circle.plane is None else "plane"
        return circle(start, about, arm.task, sampling, "circle", (where,))
    if request.target is not None:
        goals: list[Target] = [request.target]
        places: list[Location] = [("target",)]
    else:
        goals = request.waypoints or []
        places = [("waypoints", k) for k in range(len(goals))]
        if not 1 <= len(goals) <= MAX_WAYPOINTS:
            raise InvalidOption(
                say(
                    "waypoints holds {count}; give 1 to {max_waypoints}",
                    count=len(goals),
                    max_waypoints=MAX_WAYPOINTS,
                ),
                argument="waypoints",
                value=len(goals),
                lower=1,
                upper=MAX_WAYPOINTS,
            )
    poses = [
        target_pose(one, arm.task, context.doubts, place)
        for one, place in zip(goals, places, strict=True)
    ]
    return polyline(start, poses, arm.task, sampling)


def _circle(field: CircleField) -> Circle:
    if field.normal is not None and field.plane is not None:
        raise InvalidOption(
            say("circle has a normal and a plane; give one"), argument="circle", index=("plane",)
        )
    plane = field.plane or "xy"
    if plane not in PLANES:
        raise InvalidOption(
            say(
                "circle.plane is {plane}; give {planes}",
                plane=quoted(plane),
                planes=", ".join(PLANES),
            ),
            argument="circle",
            index=("plane",),
            value=plane,
            known=tuple(PLANES),
        )
    normal = list(PLANES[plane]) if field.normal is None else field.normal
    center = [*field.center, 0.0] if len(field.center) == 2 else field.center
    return Circle(_three(center, "center"), _three(normal, "normal"), field.turns)


def _three(values: list[float], name: str) -> FloatArray:
    if len(values) != 3 or not all(abs(value) <= 1e6 for value in values):
        sizes = say("two (in the plane z = 0) or three") if name == "center" else "three"
        raise InvalidOption(
            say(
                "circle.{name} is no point or direction; give {sizes} numbers up to 1e6",
                name=name,
                sizes=sizes,
            ),
            argument="circle",
            index=(name,),
        )
    return np.array(values)


def _solid(field: ObstacleField, index: int, context: Context) -> solids.Obstacle:
    centers = getattr(field, "center", None), getattr(field, "start", None)
    for center in centers:
        if center is not None and len(center) in (2, 3):
            context.doubts.place(np.array(center), say("obstacle {index}", index=index), FAR_THING)
    if isinstance(field, SphereField):
        return solids.Sphere(field.center, field.radius)
    if isinstance(field, CircleObstacleField):
        return solids.CircleObstacle(field.center, field.radius)
    if isinstance(field, CapsuleField):
        return solids.Capsule(field.start, field.end, field.radius)
    if isinstance(field, HalfSpaceField):
        return solids.HalfSpace(field.normal, field.offset)
    rotation = None
    turned = {name: one for name in ORIENTATION_FIELDS if (one := getattr(field, name)) is not None}
    if turned:
        target = Target(**turned)
        place = ("obstacles", index)
        rotation = target_pose(target, TASKS["orientation"], context.doubts, place)[:3, :3]
    return solids.Box(field.center, field.size, rotation)


def read_options(
    robot: Robot, request: MethodOptions, problem: PathProblem, seconds: float, context: Context
) -> PathOptions:
    """The options of a request.

    Raises:
        KinematicsError: A field is out of range or does not fit.
    """
    posture = None if request.posture is None else problem.arm.reduced(request.posture)
    if len(request.secondary) > MAX_SECONDARY:
        raise InvalidOption(
            say("give at most {max_secondary} secondary tasks", max_secondary=MAX_SECONDARY),
            argument="secondary",
        )
    gains = request.gains
    options = PathOptions(
        closed_loop=request.closed_loop,
        damping=request.damping,
        iterations=request.iterations,
        gains=None
        if gains is None
        else Gains(gains.limits, gains.manipulability, gains.obstacles, gains.posture),
        posture_q=posture,
        influence=request.influence,
        obstacle_weight=request.obstacle_weight,
        margin=request.margin,
        secondary=tuple(
            _secondary(robot, one, k, problem, context) for k, one in enumerate(request.secondary)
        ),
        perturb=request.perturb,
        seconds=seconds,
        processes=context.programs,
    )
    options.reach_of_obstacles(problem)  # Refused here, before another method has run.
    return options


def scenario_need(robot: Robot, request: PathScenario, methods: Sequence[str]) -> Need:
    """Return the need of a scenario without its answer: the results of some methods, all kept."""
    arm = Arm.of(robot, request.frame, request.task)
    samples = min(max(request.samples, 0), MAX_SAMPLES)
    each = float(working_bytes(robot.dof) + result_bytes(robot.dof) * len(methods))
    fixed = 0
    if request.retime is not None:
        each += motion_bytes(robot.dof) * len(methods)
        fixed += grid_bytes(arm.K)
    if "whole_path" in methods:
        links = _links(request, arm)
        sizes = arm.K, links, len(request.obstacles)
        if samples * (arm.K + links * len(request.obstacles)) <= MOST_PROGRAM:
            each += sample_bytes(*sizes)
            fixed += expression_bytes(*sizes)
    return Need(each, samples, fixed, "samples", "samples")


def _links(request: PathScenario, arm: Arm) -> int:
    """Return the number of capsules that keep clear of obstacles."""
    shaped = read_geometry(request.link_geometry, 0.0, arm, request.q)
    return len(skeleton(arm, 0.0) if shaped is None else shaped.links)


def _secondary(
    robot: Robot, field: SecondaryField, k: int, problem: PathProblem, context: Context
) -> SecondaryTask:
    task = task_from(field.task, "secondary", (k, "task"))
    arm = Arm.of(robot, field.frame, task, "secondary", (k, "frame"))
    if field.target is None:
        pose = fk(robot, problem.start, [arm.frame])[arm.frame]
    else:
        place = ("secondary", k, "target")
        pose = target_pose(field.target, arm.task, context.doubts, place)
    return SecondaryTask(arm, np.ascontiguousarray(pose[:3].reshape(12)), field.gain)
