"""Computations that are accepted, on many robots: tasks, frames, sequences, batches."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from random import Random
from typing import Any

from tests.recorded.fixture import MINE, Asked
from tests.recorded.requests.bases import Q3, Q6, Q7, UNHURRIED
from tests.recorded.requests.sent import get, npy, post
from tests.torture.exchange import Sent

ROBOTS = {
    "puma560": 6,
    "ur5": 6,
    "pa10": 7,
    "panda": 7,
    "planar_2r": 2,
    "planar_3r": 3,
    "planar_8r": 8,
    "scara": 4,
    "stanford": 6,
    "rx90": 6,
    "iiwa14": 7,
    "ur5_urdf": 6,
    "xarm7": 7,
    "double_pendulum_continuous": 2,
    "panda_urdf": 9,
    "baxter": 19,
    "solo8": 8,
    "so101": 6,
    f"{MINE}tree": 3,
    f"{MINE}mixed": 3,
    f"{MINE}urdf": 2,
}
SLIDES = {
    "scara": (2,),
    "stanford": (2,),
    "panda_urdf": (7, 8),
    f"{MINE}tree": (2,),
    f"{MINE}mixed": (1,),
    f"{MINE}urdf": (1,),
}
TASKS: tuple[Any, ...] = (
    "pose",
    "position",
    "orientation",
    "xy",
    "xz",
    "yz",
    "x",
    "y",
    "z",
    "xy_phi",
    "xyz_phi",
    "direction",
    "position_direction",
    [1, 0, 0, 0, 0, 1],
    [1, 1, 1, 1, 0, 0],
)
REFERENCE_FRAMES = ("world", "local", "local_world_aligned")
SEQUENCES = [
    "".join(axes)
    for letters in ("XYZ", "xyz")
    for axes in itertools.product(letters, repeat=3)
    if axes[0] != axes[1] != axes[2]
]


def q_of(robot: str, rng: Random) -> list[float]:
    """A q that any robot can have."""
    values = [round(rng.uniform(-1, 1), 3) for _ in range(ROBOTS[robot])]
    for k in SLIDES.get(robot, ()):
        values[k] = round(abs(values[k]) * 0.04, 3)
    return values


def asked() -> Iterator[Asked]:
    """All requests, in order."""
    yield from _on_robots()
    yield from _tasks()
    yield from _frames_and_sequences()
    yield from _batches()


def _on_robots() -> Iterator[Asked]:
    for robot, dof in ROBOTS.items():
        rng = Random(robot)
        q, qd = q_of(robot, rng), [round(rng.uniform(-1, 1), 3) for _ in range(dof)]
        task = "xy" if robot.startswith(("planar", "double")) else "position"
        bodies: dict[str, dict[str, Any]] = {
            "fk": {"q": q, "frames": "all"},
            "jacobian": {"q": q},
            "singularity": {"q": q, "task": task},
            "dh-matrices": {"q": q},
            "twist": {"q": q, "qd": qd},
            "joint-velocities": {
                "q": q,
                "twist": [0.1, -0.2] + [0.1] * (task == "position"),
                "task": task,
            },
            "joint-torques": {"q": q, "wrench": [1, 2, 3, 0.1, 0.2, 0.3]},
            "wrench": {"q": q, "tau": qd, "task": task},
            "jacobian-derivative": {"q": q, "qd": qd},
            "hessian": {"q": q},
            "manipulability-gradient": {"q": q, "task": task},
            "singularity/nearest": {"q": q, "task": task},
            "step": {
                "q": q,
                "delta_x": [0.01, 0.02] + [0.0] * (task == "position"),
                "task": task,
                "damping": 0.1,
            },
            "picture.svg": {"q": q},
            "workspace": {"samples": 10},
        }
        for name, body in bodies.items():
            yield post(name, "form: robots", robot, body)
            yield post(name, "form: robots", robot, body, "angle=deg&format=text")
            listed = ",".join(map(str, q))
            if set(body) == {"q"}:
                yield get(name, "form: robots", robot, f"q={listed}&angle=deg")
        yield post("picture.png", "form: robots", robot, {"q": q, "width": 200, "height": 200})
        yield Asked(
            "fk",
            "form: robots",
            Sent("GET", f"/v1/robots/{robot}/fk", f"q={listed}&format=npy", what=robot),
        )


def _tasks() -> Iterator[Asked]:
    for task in TASKS:
        count = (
            sum(task)
            if isinstance(task, list)
            else {
                "pose": 6,
                "position": 3,
                "orientation": 3,
                "xy_phi": 3,
                "xyz_phi": 4,
                "direction": 2,
                "position_direction": 5,
            }.get(task, len(task))
        )
        given = ",".join(map(str, task)) if isinstance(task, list) else task
        for robot, q in (("puma560", Q6), ("planar_3r", Q3), ("panda", Q7)):
            listed = ",".join(map(str, q))
            kind = "form: tasks"
            delta = [0.01] * count
            yield post("singularity", kind, robot, {"q": q, "task": task})
            yield get("singularity", kind, robot, f"q={listed}&task={given}&format=text")
            yield post("joint-velocities", kind, robot, {"q": q, "twist": delta, "task": task})
            yield post(
                "joint-velocities",
                kind,
                robot,
                {"q": q, "twist": delta, "task": task, "damping": 0.1},
                "angle=deg",
            )
            yield post("wrench", kind, robot, {"q": q, "tau": q, "task": task})
            yield post("manipulability-gradient", kind, robot, {"q": q, "task": task})
            yield post("step", kind, robot, {"q": q, "delta_x": delta, "task": task})
            yield post(
                "step",
                kind,
                robot,
                {"q": q, "delta_x": delta, "task": task, "damping": 0.1},
                "angle=deg",
            )
            yield get("singularity/nearest", kind, robot, f"q={listed}&task={given}")
            names = ["j1", "j2"] if robot == "planar_3r" else ["j2", "j3"]
            yield post(
                "manipulability-map",
                kind,
                robot,
                {"q": q, "joints": names, "samples": 4, "task": task},
            )


def _frames_and_sequences() -> Iterator[Asked]:
    kind = "form: frames and sequences"
    for robot, q, frame in (
        ("puma560", Q6, "frame_3"),
        ("pa10", Q7, "tool"),
        ("panda_urdf", [*Q7, 0.01, 0.02], "panda_link5"),
    ):
        for reference in REFERENCE_FRAMES:
            body = {"q": q, "frame": frame, "reference_frame": reference}
            yield post("jacobian", kind, robot, body)
            yield post("hessian", kind, robot, body)
            yield post("twist", kind, robot, {**body, "qd": q}, "angle=deg")
            yield post("jacobian-derivative", kind, robot, {**body, "qd": q}, "format=text")
            yield post("joint-torques", kind, robot, {**body, "wrench": [1, 2, 3, 0, 0, 1]})
            yield post("wrench", kind, robot, {**body, "tau": q})
            yield post("joint-velocities", kind, robot, {**body, "twist": [0.1] * 6})
    for sequence in SEQUENCES:
        listed = ",".join(map(str, Q6))
        yield get("fk", kind, "puma560", f"q={listed}&euler={sequence}")
        yield post(
            "fk", kind, "pa10", {"q": [Q7, [0] * 7], "euler": sequence}, "angle=deg&format=text"
        )
        yield post("fk", kind, "planar_2r", {"q": [0, 0], "euler": sequence})
        yield post("jacobian", kind, "puma560", {"q": Q6, "euler": sequence})
        yield get("jacobian", kind, "planar_2r", f"q=0,0&euler={sequence}")
        target = {
            "position": [0.4, 0.2, 0.5],
            "euler": {"sequence": sequence, "angles": [10, 20, 30]},
        }
        yield post("ik/solutions", kind, "puma560", {"target": target}, "angle=deg")
        yield get(
            "ik",
            kind,
            "puma560",
            f"position=0.4,0.2,0.5&euler={sequence}:0.1,20deg,pi/6"
            f"&max_restarts=5&time_budget_ms={UNHURRIED}",
        )


def _batches() -> Iterator[Asked]:
    kind = "form: batches"
    for robot in ("puma560", "scara", "panda_urdf", f"{MINE}tree"):
        rng = Random(robot)
        rows = [q_of(robot, rng) for _ in range(3)]
        for query in ("", "angle=deg", "format=text&angle=deg", "format=npy"):
            yield post("fk", kind, robot, {"q": rows, "euler": "ZYX"}, query)
            yield post("jacobian", kind, robot, {"q": rows}, query)
            yield post("singularity", kind, robot, {"q": rows, "task": "position"}, query)
            yield post("twist", kind, robot, {"q": rows, "qd": rows[0]}, query)
            yield post("twist", kind, robot, {"q": rows[0], "qd": rows}, query)
            yield post(
                "joint-velocities",
                kind,
                robot,
                {"q": rows, "twist": [0.1, 0, 0], "task": "position"},
                query,
            )
            yield post(
                "joint-torques",
                kind,
                robot,
                {"q": rows[0], "wrench": [[1, 0, 0, 0, 0, 0]] * 3},
                query,
            )
            yield post("wrench", kind, robot, {"q": rows, "tau": rows}, query)
            yield post("jacobian-derivative", kind, robot, {"q": rows, "qd": rows}, query)
            yield post("hessian", kind, robot, {"q": rows[:2]}, query)
            yield post("manipulability-gradient", kind, robot, {"q": rows}, query)
            yield post("dh-matrices", kind, robot, {"q": rows}, query)
        for name in ("fk", "jacobian", "hessian", "dh-matrices", "singularity"):
            yield Asked(
                name,
                kind,
                Sent(
                    "POST",
                    f"/v1/robots/{robot}/{name}",
                    "angle=deg&format=npy",
                    (("Content-Type", "application/x-npy"),),
                    npy(rows),
                    what=robot,
                ),
            )
        yield post("picture.svg", kind, robot, {"q": rows})
        yield post("twist", kind, robot, {"q": rows, "qd": rows[:2]})
        yield post("wrench", kind, robot, {"q": rows[:2], "tau": rows})
