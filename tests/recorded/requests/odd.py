"""Refusals for reasons of their own, names that are misspelt, expressions, uneven batches."""

from __future__ import annotations

from collections.abc import Iterator

from tests.recorded.fixture import MINE, Asked
from tests.recorded.requests.bases import IK, Q3, Q6
from tests.recorded.requests.computations import TABLE
from tests.recorded.requests.sent import get, inline, post


def asked() -> Iterator[Asked]:
    """What fails for a reason of its own, and names that are misspelt."""
    kind = "refused: special"
    yield get("jacobian", kind, "puma560", "q=0,0,0,0,0,0&euler=ZXZ")
    yield post("jacobian", kind, "puma560", {"q": [Q6, [0] * 6], "euler": "ZYZ"})
    yield post("step", kind, "planar_3r", {"q": [0, 0, 0], "delta_x": [0.1, 0], "task": "xy"})
    yield post("step", kind, "planar_3r", {"q": [0, 0, 0], "delta_x": [0.1, 0, 0], "task": "xy"})
    yield post(
        "step",
        kind,
        "planar_3r",
        {
            "q": Q3,
            "delta_x": [0.1, 0],
            "task": "xy",
            "z": Q3,
            "secondary": [{"delta_x": [0.1], "task": "x"}],
        },
    )
    yield post("dh-matrices", kind, "ur5_urdf", {"q": Q6})
    yield get("dh-matrices", kind, "panda_urdf", "q=0,0,0,0,0,0,0,0,0")
    for robot, names in {
        "ur5_urdf": (
            "shoulder_pan_joint",
            "shoulder_lift_joint",
            "elbow_joint",
            "wrist_1_joint",
            "wrist_2_joint",
            "wrist_3_joint",
        ),
        "puma560": ("j1", "j2", "j3", "j4", "j5", "j6"),
    }.items():
        good = dict.fromkeys(names, 0.1)
        for what in (
            good,
            dict(reversed(good.items())),
            {**good, names[0][:-1]: 0.1},
            dict.fromkeys(names[1:], 0.1),
            {**good, names[2]: None},
            {**good, names[2]: "x"},
            {**good, names[2]: True},
            {**good, names[2]: 1e300},
            {**good, names[2]: [1]},
            {**good, "a/b~c": 1},
            {},
            {names[0]: 0.1},
            {**good, "\u202e": 1},
        ):
            yield post("fk", kind, robot, {"q": what})
            yield post("twist", kind, robot, {"q": what, "qd": good})
            yield post("twist", kind, robot, {"q": good, "qd": what})
            yield post(
                "ik",
                kind,
                robot,
                {"target": {"position": [0.4, 0.2, 0.3]}, "task": "position", "seed": what, **IK},
            )
    for frame in ("frame3", "Tool", "frame_33", "", "universe", "world", "tool\n", "x" * 90):
        yield post("fk", kind, "puma560", {"q": Q6, "frames": [frame]})
        yield post("fk", kind, "puma560", {"q": Q6, "frames": ["tool", frame]})
        for name, extra in (
            ("jacobian", {}),
            ("singularity", {}),
            ("twist", {"qd": Q6}),
            ("joint-torques", {"wrench": [0] * 6}),
            ("hessian", {}),
        ):
            yield post(name, kind, "puma560", {"q": Q6, "frame": frame, **extra})
        yield inline("fk", kind, TABLE, {"q": [0, 0], "frames": [frame]})
    for query in (
        "q=90,45&angle=deg",
        "q=pi/2,0.5",
        "q=90deg,45deg",
        "q=1e-3,-.5",
        "q=[0.1,0.2]",
        "q=%200.1%20,0.2",
        "q=pi,2*pi&angle=deg",
        "q=sqrt(2),0",
        "q=π/2,90°",
        "q=%CF%80/2,0",
        "q=90%C2%B0,0",
        "q=0.1;0.2",
        "q=0%2C1,0",
        "q=300mm,0",
        "q=0.1,0.2,0.3",
        "q=-pi/4,(1%2B2)/4",
        "q=1/0,0",
        "q=q1,0",
    ):
        query = "".join(
            c if c.isascii() else "".join(f"%{b:02X}" for b in c.encode()) for c in query
        )
        for name, robot in (
            ("fk", "planar_2r"),
            ("jacobian", f"{MINE}urdf"),
            ("dh-matrices", "planar_2r"),
            ("picture.svg", "planar_2r"),
        ):
            yield get(name, "form: expressions", robot, query)
    for rows in (
        [[0, 0], [0]],
        [[0], [0]],
        [[0, 0], 0],
        [[0, 0], ["x", 0]],
        [[0, 0], [None, 0]],
        [[]],
        [[0, 0], []],
        [[[0, 0]]],
        [[0, 0, 0]],
        [[0, 1e300]],
        [[0, True]],
        [0, [0]],
        [[0, 0]] * 3 + [[0, 1e7]],
    ):
        for name, extra in (
            ("fk", {}),
            ("jacobian", {}),
            ("singularity", {"task": "xy"}),
            ("twist", {"qd": [1, 1]}),
            ("wrench", {"tau": [1, 1]}),
            ("picture.svg", {}),
        ):
            yield post(name, kind, "planar_2r", {"q": rows, **extra})
        yield post("twist", kind, "planar_2r", {"q": [0, 0], "qd": rows})
        yield post("wrench", kind, "planar_2r", {"q": [0, 0], "tau": rows})
        yield post(
            "joint-velocities", kind, "planar_2r", {"q": [0, 0], "twist": rows, "task": "xy"}
        )
        yield post("joint-torques", kind, "planar_2r", {"q": [0, 0], "wrench": rows})
