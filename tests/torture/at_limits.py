"""Every computation at the limits of its schema: the largest requests that are allowed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from io import BytesIO
from typing import Any

import numpy as np

DOF = 64
NUMBERS = 12_000_000
"""Numbers that one answer may hold."""
BODY = 64_000_000
"""Bytes of a body."""
BATCH, IK_BATCH = 200_000, 10_000
JSON, NPY, TEXT, NDJSON, SVG, PNG, CSV = (
    "application/json",
    "application/x-npy",
    "text/plain",
    "application/x-ndjson",
    "image/svg+xml",
    "image/png",
    "text/csv",
)
ROBOT, SMALL_ROBOT = "limits", "small"
"""Ids under which the arm with the most joints is uploaded, and one with few."""
FEW = 2
"""Joints of the small one: with it, batches are long, and what each row takes besides counts."""
ROBOTS = {ROBOT: DOF, SMALL_ROBOT: FEW}
"""Number of joints by id."""


@cache
def table(robot: str = ROBOT) -> dict[str, Any]:
    """An arm of as many joints as a robot may have, or of few."""
    alphas = np.random.default_rng(0).uniform(-1.5, 1.5, ROBOTS[robot]).round(3).tolist()
    limits = {"lower": -2.9, "upper": 2.9, "velocity": 2}
    joints = [
        {"type": "R", "a": 0.1, "alpha": alpha, "d": 0.02, "limits": limits} for alpha in alphas
    ]
    # Turned and moved at both ends, so that no number of an answer is short.
    base, tool = {"rpy": [0.3, 0.5, 0.7]}, {"xyz": [0.11, 0.13, 0.17], "rpy": [0.2, 0.4, 0.6]}
    return {"convention": "standard", "base": base, "tool": tool, "joints": joints}


@dataclass(frozen=True)
class Case:
    """A request at the limits.

    Attributes:
        name: Of the computation and of what is largest in it.
        operation: Last part of its path.
        body: What is posted.
        type: Media type of the body.
        accept: Media type of the answer.
        query: Query of the address.
        robot: Id of the robot.
    """

    name: str
    operation: str
    body: bytes = field(repr=False)
    type: str = JSON
    accept: str = JSON
    query: str = ""
    robot: str = ROBOT

    @property
    def address(self) -> str:
        """Path and query."""
        return f"/v1/robots/{self.robot}/{self.operation}{self.query}"

    @property
    def headers(self) -> dict[str, str]:
        """Its headers."""
        return {"Content-Type": self.type, "Accept": self.accept}


def rows(numbers: int, most: int = BATCH) -> int:
    """Rows of a batch whose answer holds so many numbers for each."""
    return min(most, NUMBERS // numbers)


def _posted(**fields: Any) -> bytes:
    return json.dumps(fields).encode()


def _batch(n: int, width: int = DOF, digits: int = 2) -> str:
    """A batch in JSON: one row of short numbers, n times."""
    row = json.dumps(np.linspace(-1, 1, width).round(digits).tolist())
    return "[" + ",".join([row] * n) + "]"


def _with_batches(batches: dict[str, tuple[int, int]], **fields: Any) -> bytes:
    parts = [f'"{name}": {_batch(*size)}' for name, size in batches.items()]
    parts += [f'"{name}": {json.dumps(value)}' for name, value in fields.items()]
    return ("{" + ", ".join(parts) + "}").encode()


def _npy(n: int, width: int = DOF) -> bytes:
    stream = BytesIO()
    np.save(stream, np.random.default_rng(0).uniform(-1, 1, (n, width)))
    return stream.getvalue()


Q = np.linspace(-0.2, 0.3, DOF).round(3).tolist()
BOX = {"type": "box", "center": [9, 9, 9], "size": [1, 1, 1], "rpy": [0.1, 0.2, 0.3]}
SPHERE = {"type": "sphere", "center": [9, 9, 9], "radius": 0.1}


def cases() -> Iterator[Case]:
    """Give every computation at its limits."""
    row = len(_batch(1)) - 1
    n = min(BATCH, (BODY - 100) // row)
    in_limits = ('{"q": ' + _batch(n) + "}").encode()
    for accept in (JSON, NPY, TEXT):
        yield Case(f"fk {accept}", "fk", in_limits, accept=accept)
    m = (BODY - 200) // (8 * DOF)
    yield Case("fk npy to npy", "fk", _npy(m), NPY, NPY)
    yield Case("fk npy to JSON", "fk", _npy(m), NPY, JSON)
    yield Case("fk Euler", "fk", _npy(m), NPY, JSON, "?euler=ZXZ")
    frames = (json.dumps({"frames": "all"})[:-1] + ', "q": ' + _batch(rows(32 * 70)) + "}").encode()
    for accept in (JSON, NPY, TEXT):
        yield Case(f"fk all frames {accept}", "fk", frames, accept=accept)
    for accept in (JSON, NPY, TEXT):
        yield Case(
            f"dh-matrices {accept}",
            "dh-matrices",
            ('{"q": ' + _batch(rows(32 * DOF)) + "}").encode(),
            accept=accept,
        )
    n = rows(6 * DOF)
    for accept in (JSON, NPY, TEXT):
        yield Case(f"jacobian {accept}", "jacobian", _with_batches({"q": (n, DOF)}), accept=accept)
    for axes in ("world", "local"):
        yield Case(
            f"jacobian {axes}", "jacobian", _with_batches({"q": (n, DOF)}, reference_frame=axes)
        )
    yield Case("jacobian Euler", "jacobian", _with_batches({"q": (n, DOF)}, euler="ZXZ"))
    both = {"q": (n, DOF), "qd": (n, DOF)}
    for axes in ("world", "local", "local_world_aligned"):
        body = _with_batches(both, reference_frame=axes)
        yield Case(f"jacobian-derivative {axes}", "jacobian-derivative", body)
    yield Case("twist", "twist", _with_batches(both))
    yield Case("joint-torques", "joint-torques", _with_batches({"q": (n, DOF), "wrench": (n, 6)}))
    n = rows(6 * DOF**2)
    for axes in ("world", "local", "local_world_aligned"):
        body = _with_batches({"q": (n, DOF)}, reference_frame=axes)
        yield Case(f"hessian {axes}", "hessian", body)
    body = _with_batches({"q": (n, DOF)})
    yield Case("manipulability-gradient", "manipulability-gradient", body)
    n = rows(6 * DOF + DOF**2)
    yield Case(
        "joint-velocities", "joint-velocities", _with_batches({"q": (n, DOF), "twist": (n, 6)})
    )
    yield Case("wrench", "wrench", _with_batches({"q": (n, DOF), "tau": (n, DOF)}))
    for accept in (JSON, NPY, TEXT):
        yield Case(
            f"singularity {accept}", "singularity", _with_batches({"q": (n, DOF)}), accept=accept
        )
    yield Case("singularity/nearest", "singularity/nearest", _posted(q=Q))
    step = {"delta_x": [0.001] * 6, "task": "pose"}
    yield Case(
        "step", "step", _posted(q=Q, delta_x=[0.001] * 3, task="position", secondary=[step] * 16)
    )
    for accept in (JSON, NPY, TEXT, SVG, PNG):
        yield Case(f"workspace {accept}", "workspace", _posted(samples=BATCH), accept=accept)
    grid = {"q": Q, "joints": ["j1", "j2"], "samples": 400}
    for accept in (JSON, NPY, TEXT, SVG, PNG):
        yield Case(
            f"manipulability-map {accept}", "manipulability-map", _posted(**grid), accept=accept
        )
    targets = {"position": np.random.default_rng(1).uniform(-1, 1, (IK_BATCH, 3)).round(3).tolist()}
    common = {"task": "position", "max_restarts": 0, "max_iterations": 20}
    for accept in (JSON, NPY, TEXT, NDJSON):
        yield Case(f"ik {accept}", "ik", _posted(targets=targets, **common), accept=accept)
    listed = [{"position": one, "rpy": [0.1, 0.2, 0.3]} for one in targets["position"]]
    yield Case("ik listed", "ik", _posted(targets=listed, **common))
    yield Case(
        "ik/solutions",
        "ik/solutions",
        _posted(target={"position": [0.4, 0.2, 0.5]}, task="position"),
    )
    line = {"q": Q, "target": {"position": [0.4, 0.2, 0.5]}, "task": "position"}
    for accept in (JSON, NPY, TEXT, NDJSON, SVG, PNG):
        yield Case(
            f"path {accept}",
            "path",
            _posted(**line, samples=10_000, method="damped"),
            accept=accept,
        )
    for method in ("pseudo_inverse", "null_space", "qp"):
        body = _posted(**line, samples=10_000, method=method, obstacles=[SPHERE] * 3)
        yield Case(f"path {method}", "path", body)
    body = _posted(
        **line, samples=10_000, method="damped", retime={"acceleration": 5, "samples": 10_000}
    )
    yield Case("path retimed", "path", body)
    body = _posted(**line, samples=300, method="sqp", obstacles=[BOX] * 100)
    yield Case("path obstacles", "path", body)
    methods = ["damped"] * 16
    for accept in (JSON, SVG):
        body = _posted(**line, samples=10_000, methods=methods, retime={"acceleration": 5})
        yield Case(f"path/compare {accept}", "path/compare", body, accept=accept)
    for samples, things in (
        (937, []),
        (460, [SPHERE]),
        (26, [SPHERE] * 34),
        (26, [BOX] * 34),
        (4, [BOX] * 100),
    ):
        body = _posted(**line, samples=samples, method="whole_path", obstacles=things)
        yield Case(f"path whole_path {samples} {len(things)}", "path", body)
    yield Case("symbolic", "symbolic", _posted(quantities=["T", "jacobian", "det_jacobian"]))
    many = [Q] * 32
    for form in ("svg", "png"):
        body = _posted(q=many, frames="all", width=2000, height=2000)
        yield Case(f"picture.{form}", f"picture.{form}", body, accept="*/*")
    yield from _long_batches()


def _long_batches() -> Iterator[Case]:
    """Give the computations with as many rows as a request may hold, of an arm with few joints."""
    q = {"q": (BATCH, FEW)}
    with_rates = {**q, "qd": (BATCH, FEW)}
    batches = {
        "fk": q,
        "dh-matrices": {"q": (rows(32 * FEW + 16), FEW)},
        "jacobian": q,
        "jacobian-derivative": with_rates,
        "hessian": q,
        "manipulability-gradient": q,
        "singularity": q,
        "twist": with_rates,
        "joint-velocities": {**q, "twist": (BATCH, 6)},
        "joint-torques": {**q, "wrench": (BATCH, 6)},
        "wrench": {**q, "tau": (BATCH, FEW)},
    }
    for operation, sizes in batches.items():
        body = _with_batches(sizes)
        for accept in (JSON, NPY, TEXT):
            name = f"few joints {operation} {accept}"
            yield Case(name, operation, body, accept=accept, robot=SMALL_ROBOT)
    body = _with_batches({"q": (rows(32 * (FEW + 6)), FEW)}, frames="all")
    yield Case("few joints fk all frames", "fk", body, robot=SMALL_ROBOT)
    body = _npy(BATCH, FEW)
    for query in ("", "?euler=ZXZ"):
        yield Case(f"few joints fk npy{query}", "fk", body, NPY, JSON, query, SMALL_ROBOT)
    targets = {"position": np.random.default_rng(1).uniform(-1, 1, (IK_BATCH, 3)).round(3).tolist()}
    body = _posted(targets=targets, task="position", max_restarts=0, max_iterations=20)
    for accept in (JSON, NPY, TEXT, NDJSON):
        yield Case(f"few joints ik {accept}", "ik", body, accept=accept, robot=SMALL_ROBOT)
    line = {"q": [0.1, 0.5], "target": {"position": [0.12, 0.1, 0.04]}, "task": "xy"}
    retime = {"acceleration": 5, "samples": 10_000}
    body = _posted(**line, samples=10_000, method="damped", retime=retime)
    for accept in (JSON, NPY, TEXT, NDJSON, SVG, PNG):
        yield Case(f"few joints path {accept}", "path", body, accept=accept, robot=SMALL_ROBOT)
    body = _posted(**line, samples=10_000, methods=["damped"] * 16, retime={"acceleration": 5})
    for accept in (JSON, SVG):
        name = f"few joints path/compare {accept}"
        yield Case(name, "path/compare", body, accept=accept, robot=SMALL_ROBOT)
