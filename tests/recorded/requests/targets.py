"""Inverse kinematics, paths and closed forms that are accepted."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

import numpy as np

from tests.recorded.fixture import MINE, Asked
from tests.recorded.requests.arms import q_of
from tests.recorded.requests.bases import IK, Q3, Q7, Q8, UNHURRIED
from tests.recorded.requests.sent import Pose, get, inline, npy, post
from tests.torture.exchange import Sent

METHODS = ("pseudo_inverse", "damped", "null_space", "task_priority", "sqp", "qp", "whole_path")


def asked(pose: Pose) -> Iterator[Asked]:
    """All requests, in order."""
    yield from _inverse(pose)
    yield from _paths(pose)
    yield from _symbolic()


def _inverse(pose: Pose) -> Iterator[Asked]:
    kind = "form: inverse"
    for robot in (
        "puma560",
        "ur5",
        "pa10",
        "panda",
        "planar_2r",
        "planar_3r",
        "planar_8r",
        "scara",
        "stanford",
        "rx90",
        "ur5_urdf",
        "xarm7",
        "baxter",
        "panda_urdf",
        "iiwa14",
        f"{MINE}tree",
        f"{MINE}mixed",
    ):
        rng = Random(robot)
        q, seed = q_of(robot, rng), q_of(robot, rng)
        matrix = pose(robot, q)
        planar = robot.startswith("planar")
        yield post("ik", kind, robot, {"target": {"matrix": matrix}, **IK})
        yield post(
            "ik",
            kind,
            robot,
            {"target": {"matrix": matrix}, "seed": seed, **IK},
            "format=text&angle=deg",
        )
        at = [row[3] for row in matrix[:3]]
        listed = ",".join(f"{value:.12g}" for value in at)
        for task in ("position", "xy", "xy_phi" if planar else "position_direction"):
            target: dict[str, Any] = {"matrix": matrix} if "_" in task else {"position": at}
            yield post("ik", kind, robot, {"target": target, "task": task, **IK})
        yield get(
            "ik",
            kind,
            robot,
            f"position={listed}&task=position&max_restarts=5&time_budget_ms=30000",
        )
        yield post("ik", kind, robot, {"target": {"position": [9, 9, 9]}, "task": "position", **IK})
        if robot in ("puma560", "ur5", "planar_2r", "planar_3r", "scara", "pa10", "rx90"):
            yield post("ik/solutions", kind, robot, {"target": {"matrix": matrix}})
            yield post(
                "ik/solutions",
                kind,
                robot,
                {"target": {"matrix": matrix}, "seed": seed},
                "format=text&angle=deg",
            )
            yield post("ik/solutions", kind, robot, {"target": {"matrix": matrix}}, "format=npy")
            yield inline("ik/solutions", kind, robot, {"target": {"matrix": matrix}}, "angle=deg")
            if planar:
                yield post(
                    "ik/solutions", kind, robot, {"target": {"position": at[:2]}, "task": "xy"}
                )
            for choose in ("closest", "most_manipulable", "farthest_from_limits"):
                yield post(
                    "ik",
                    kind,
                    robot,
                    {"target": {"matrix": matrix}, "seed": seed, "choose": choose, **IK},
                )
        matrices = [matrix, pose(robot, seed), matrix, (np.eye(4) * 1.0).tolist()]
        many = {"targets": {"matrix": matrices}, **IK}
        for query in ("", "angle=deg", "format=text", "format=npy", "format=ndjson"):
            yield post("ik", "form: batches", robot, many, query)
        yield Asked(
            "ik",
            "form: batches",
            Sent(
                "POST",
                f"/v1/robots/{robot}/ik",
                "max_restarts=5&time_budget_ms=30000&format=npy",
                (("Content-Type", "application/x-npy"),),
                npy(np.array(matrices)),
                what=robot,
            ),
        )
    common = f"max_restarts=5&time_budget_ms={UNHURRIED}"
    for query in (
        "position=0.4,0.2,0.5&quaternion_xyzw=0,0,0,1",
        "position=400mm,200mm,0.5&rpy=0,90deg,pi/2",
        "position=0.4,0.2,0.5&euler=ZXZ:10,20,30&angle=deg",
        "matrix=1,0,0,0.4,0,1,0,0.2,0,0,1,0.5,0,0,0,1",
        "matrix=1,0,0,0.4,0,1,0,0.2,0,0,2,0.5,0,0,0,1",
        "position=0.4,0.2,0.5&direction=0,0,-1&task=position_direction",
        "position=0.4,0.2,0.5&task=position&tolerance=1e-4&frame=frame_5",
        "position=0.4,0.2,0.5&rpy=0,0,0&seed=10,20,-30,0,40,0&angle=deg",
        "position=0.4,0.2,0.5&rpy=0,0,0&choose=closest",
        "position=0.4,0.2,0.5&task=1,1,1,0,0,0",
        "position=0.4,0.2,0.5&phi=0.3&task=xyz_phi",
        "rpy=0.1,0.2,0.3&task=orientation",
        "position=0.4,0.2,0.5",
        "rpy=0.1,0.2,0.3",
    ):
        yield get("ik", "form: query", "puma560", f"{query}&{common}")
        yield get("ik", "form: query", "puma560", f"{query}&{common}&format=text")
        if "choose" not in query:
            yield get("ik/solutions", "form: query", "puma560", query)
    for query in (
        "position=0.6,0.5&phi=0.3&task=xy_phi",
        "matrix=1,0,0,0.6,0,1,0,0.5,0,0,1,0,0,0,0,1&task=xy_phi",
        "position=0.6,0.5&task=xy&tolerance=1e-3&damping=0.1&method=damped&tf=1",
        "position=0.6,0.5&phi=20&task=xy_phi&angle=deg",
        "phi=0.3&task=xy_phi",
        "task=xy",
    ):
        yield get("ik", "form: query", "planar_3r", f"{query}&{common}")
        yield get("path", "form: query", "planar_3r", f"q=0.5,-0.7,1.0&samples=4&{query}")
    for frame, task in (("left_gripper", "position"), ("right_hand", "pose"), ("zzz", "pose")):
        yield post(
            "ik",
            kind,
            "baxter",
            {
                "target": {"position": [0.6, 0.3, 0.2], "rpy": [0, 1, 0]},
                "frame": frame,
                "task": task,
                **IK,
            },
        )


def _paths(pose: Pose) -> Iterator[Asked]:
    kind = "form: paths"
    example: dict[str, Any] = {
        "q": Q8,
        "target": {"position": [1.15, -0.15]},
        "task": "xy",
        "samples": 21,
        "obstacles": [
            {"type": "circle", "center": [0.73, 0.22], "radius": 0.08},
            {"type": "circle", "center": [0.91, -0.04], "radius": 0.08},
        ],
        "link_radius": 0.02,
        "d_safe": 0.02,
    }
    q7 = [0, -0.5, 0, -2, 0, 1.6, 0.8]
    end = pose("panda", [0.1, -0.4, 0.1, -1.9, 0.1, 1.6, 0.8])
    pa = pose("pa10", [value + 0.1 for value in Q7])
    scenes: list[tuple[str, dict[str, Any]]] = [
        ("planar_8r", example),
        ("panda", {"q": q7, "target": {"matrix": end}, "samples": 11}),
        (
            "pa10",
            {
                "q": Q7,
                "target": {"position": [row[3] for row in pa[:3]]},
                "task": "position",
                "samples": 11,
                "obstacles": [{"type": "sphere", "center": [0.9, 0.9, 0.9], "radius": 0.1}],
            },
        ),
        (
            "panda",
            {
                "q": q7,
                "waypoints": [{"position": [0.5, 0.1, 0.4]}, {"position": [0.5, 0, 0.5]}],
                "task": "position",
                "samples": 11,
                "time_law": "trapezoidal",
            },
        ),
        (
            "planar_3r",
            {
                "q": Q3,
                "circle": {"center": [0.7, 0.2], "turns": 1},
                "task": "xy",
                "samples": 21,
                "time_law": "linear",
            },
        ),
        (
            "ur5_urdf",
            {
                "q": [0.1, -1, 1, 0.2, 1, 0],
                "target": {"position": [0.5, 0.2, 0.4]},
                "task": "position",
                "samples": 7,
                "link_geometry": "urdf",
                "obstacles": [{"type": "half_space", "normal": [0, 0, 1], "offset": -0.3}],
            },
        ),
    ]
    for robot, scene in scenes:
        for method in METHODS:
            yield post("path", kind, robot, {**scene, "method": method})
        yield post("path", kind, robot, {**scene, "method": "damped"}, "angle=deg&format=text")
        for form in ("ndjson", "npy", "svg"):
            yield post("path", kind, robot, {**scene, "method": "damped"}, f"format={form}")
        for form in ("json", "text", "csv", "svg"):
            yield post(
                "path/compare",
                kind,
                robot,
                {**scene, "methods": ["pseudo_inverse", "damped"]},
                f"format={form}",
            )
    for law in ("linear", "cubic", "quintic", "trapezoidal"):
        yield get(
            "path",
            kind,
            "planar_3r",
            f"q=0.5,-40deg,pi/3&position=600mm,0.5&task=xy&samples=5&time_law={law}&method=damped",
        )
    timed = {**scenes[3][1], "method": "damped", "retime": {"acceleration": 5}}
    for query in ("", "angle=deg", "format=text", "format=ndjson", "format=svg"):
        yield post("path", kind, "panda", timed, query)
    yield post(
        "path/compare",
        kind,
        "planar_3r",
        {
            "q": Q3,
            "target": {"position": [0.7, 0.4]},
            "task": "xy",
            "samples": 5,
            "methods": list(METHODS),
            "retime": {"acceleration": 5, "velocity": 2},
        },
    )


def _symbolic() -> Iterator[Asked]:
    kind = "form: symbolic"
    budget = {"time_budget_ms": UNHURRIED}
    for robot in ("planar_2r", "planar_3r", "scara"):
        for quantity in ("A", "T0", "T", "position", "rotation", "jacobian", "det_jacobian"):
            for parameters in ("numeric", "symbolic"):
                yield post(
                    "symbolic",
                    kind,
                    robot,
                    {"quantities": [quantity], "parameters": parameters, **budget},
                )
    for form in ("text", "latex", "python", "c"):
        yield post(
            "symbolic",
            kind,
            "planar_2r",
            {"quantities": "all", "parameters": "symbolic", **budget},
            f"format={form}",
        )
        yield post("symbolic", kind, "planar_2r", {"quantities": ["T"], "format": form, **budget})
    yield post(
        "symbolic",
        kind,
        "puma560",
        {"quantities": ["position"], "parameters": "symbolic", "base": "frame_0", **budget},
    )
    yield get(
        "symbolic",
        kind,
        "pa10",
        "quantities=position&parameters=symbolic&base=frame_0"
        "&frame=frame_7&format=text&time_budget_ms=30000",
    )
    yield post("symbolic", kind, f"{MINE}urdf", {"quantities": ["T"], **budget})
