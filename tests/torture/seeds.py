"""Requests that work, from the examples of the OpenAPI document."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from typing import Any
from urllib.parse import quote

import httpx
import numpy as np

from tests.torture.exchange import Sent

JSON = ("Content-Type", "application/json")
NPY = ("Content-Type", "application/x-npy")
TABLE = {
    "name": "torture",
    "convention": "modified",
    "units": {"angle": "deg", "length": "m"},
    "base": {"xyz": [0, 0, 0.1], "rpy": [0, 0, "pi/4"]},
    "tool": {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1]]},
    "values": {"L1": 0.5},
    "joints": [
        {
            "name": "a",
            "type": "R",
            "alpha": 0,
            "a": 0,
            "d": 0.3,
            "limits": {"lower": -170, "upper": 170},
        },
        {
            "name": "b",
            "type": "P",
            "alpha": -90,
            "a": "L1",
            "theta": 0,
            "sign": -1,
            "limits": {"lower": 0, "upper": 1, "velocity": 1, "effort": 10},
        },
        {"name": "c", "type": "revolute", "alpha": "pi/2", "a": 0.1, "d": 0, "offset": 90},
    ],
}
URDF = (
    '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="revolute">'
    '<parent link="a"/><child link="b"/><axis xyz="0 0 1"/><origin xyz="0 0 1" rpy="0 0 0"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
)
FULL_PATH = {
    "q": [0.4] * 8,
    "circle": {"center": [0.3, 0.2], "plane": "xy", "turns": 0.5},
    "task": "xy",
    "method": "null_space",
    "time_law": "quintic",
    "tf": 1.5,
    "samples": 21,
    "obstacles": [
        {"type": "sphere", "center": [3, 3, 0], "radius": 0.1},
        {"type": "capsule", "start": [3, 0, 0], "end": [3, 1, 0], "radius": 0.1},
        {"type": "half_space", "normal": [0, 0, 1], "offset": -1},
        {"type": "box", "center": [3, 3, 3], "size": [0.1, 0.1, 0.1], "rpy": [0, 0, 0]},
    ],
    "link_radius": 0.01,
    "d_safe": 0.01,
    "tolerance": {"position": 1e-4, "orientation": 1e-4},
    "gains": {"limits": 0.1, "manipulability": 0.1, "obstacles": 0.1, "posture": 0.1},
    "posture": [0.3] * 8,
    "influence": 0.2,
    "margin": 0.001,
    "perturb": 0.0,
}
RICHER = {
    "ik": [
        {
            "target": {"matrix": np.eye(4).tolist()},
            "seed": [0.1] * 7,
            "max_restarts": 3,
            "tolerance": {"position": 1e-6, "orientation": 1e-6},
            "random_seed": 1,
            "max_iterations": 50,
            "time_budget_ms": 20,
            "choose": "closest",
        },
        {
            "targets": [{"position": [0.3, 0.2, 0.5]}, {"position": [0.1, 0.2, 0.3]}],
            "task": "position",
            "max_restarts": 2,
            "time_budget_ms": 10,
        },
        {
            "targets": {"position": [[0.3, 0.2, 0.5]], "quaternion_xyzw": [[0, 0, 0, 1]]},
            "max_restarts": 2,
            "time_budget_ms": 10,
        },
    ],
    "fk": [
        {"q": [[0.1] * 7, [0.2] * 7], "frames": "all", "euler": "zyx"},
        {"q": {f"j{k}": 0.1 for k in range(1, 8)}, "frames": ["tool", "frame_1"]},
    ],
    "jacobian": [{"q": [0.1] * 7, "frame": "frame_3", "euler": "ZYX"}],
    "singularity": [
        {
            "q": [[0.5, 0.2], [0.1, 0.0]],
            "task": [1, 1, 0, 0, 0, 0],
            "tolerance": 1e-9,
            "characteristic_length": 0.5,
        }
    ],
    "step": [
        {
            "q": [0.5, -0.7, 1.0],
            "delta_x": [0.01, 0],
            "task": "xy",
            "damping": 0.1,
            "secondary": [{"delta_x": [0.01], "task": "x", "frame": "frame_2"}],
        }
    ],
    "path": [
        FULL_PATH,
        {**FULL_PATH, "method": "task_priority", "secondary": [{"frame": "frame_4", "gain": 0.1}]},
    ],
    "symbolic": [
        {
            "quantities": ["A", "T0", "T", "position", "rotation", "jacobian"],
            "parameters": "symbolic",
            "symbols": {"a2": "L1"},
            "frame": "frame_3",
            "base": "frame_0",
            "format": "python",
            "time_budget_ms": 200,
        }
    ],
    "path/compare": [
        {
            **{k: v for k, v in FULL_PATH.items() if k not in ("method", "samples")},
            "samples": 11,
            "methods": ["damped", {"method": "sqp", "label": "x", "margin": 0.01}],
        }
    ],
}
DOCUMENTS = {
    "application/json": json.dumps(TABLE),
    "application/yaml": "name: torture\nconvention: standard\njoints:\n"
    "  - {type: R, alpha: 0, a: 1, d: 0}\n  - {type: P, alpha: pi/2, a: 0, theta: 0}\n",
    "application/xml": URDF,
}


def npy(values: Any) -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.array(values, dtype=np.float64))
    return stream.getvalue()


def seeds(document: dict[str, Any]) -> list[Sent]:
    """Every operation in every form that the document names."""
    return [one for path, item in document["paths"].items() for one in _of_path(path, item)]


def _of_path(path: str, item: dict[str, Any]) -> Iterator[Sent]:
    for method, operation in item.items():
        parameters = operation.get("parameters", [])
        robot = next((p.get("example", "torture") for p in parameters if p["in"] == "path"), "")
        url = path.replace("{robot_id}", robot)
        verb = method.upper()
        query = "&".join(
            f"{p['name']}={quote(str(p['example']), safe=',:')}"
            for p in parameters
            if p["in"] == "query" and "example" in p
        )
        content = operation.get("requestBody", {}).get("content", {})
        if not content:
            yield Sent(verb, url, query)
        for kind, form in content.items():
            yield from _of_form(verb, url, query, kind, form)


def _of_form(verb: str, url: str, query: str, kind: str, form: dict[str, Any]) -> Iterator[Sent]:
    header = (("Content-Type", kind),)
    if kind == NPY[1]:
        dof = 6 if "puma560" in url else 2 if "planar_2r" in url else 7
        array = np.eye(4)[None] if url.endswith("/ik") else np.full((2, dof), 0.1)
        yield Sent("POST", url, "", header, npy(array))
        return
    example = form.get("example")
    if isinstance(example, str):
        yield Sent(
            verb,
            url,
            f"convention=standard&name=torture&angle=deg{query}",
            header,
            example.encode(),
        )
    elif example is not None:
        yield Sent(verb, url, query, header, json.dumps(example).encode())
        name = url.removeprefix("/v1/")
        name = name.split("/", 2)[-1] if name.startswith("robots/") else name
        for body in RICHER.get(name, []):
            extra = {"robot": example["robot"]} if "robot" in example else {}
            yield Sent(verb, url, query, header, json.dumps({**extra, **body}).encode())
    if kind in DOCUMENTS:
        asked = {"/v1/urdf-to-dh": "convention=modified", "/v1/convert-dh": "to=standard"}
        if url == "/v1/robots" or url.startswith(
            ("/v1/robots/torture", "/v1/dh", "/v1/c", "/v1/u")
        ):
            yield Sent(verb, url, asked.get(url, query), header, DOCUMENTS[kind].encode())
    if kind == "application/json" and isinstance(example, dict) and "robot" in example:
        yield Sent(verb, url, query, header, json.dumps({**example, "robot": TABLE}).encode())
        inline = json.dumps({**example, "robot": {"urdf": URDF}})
        yield Sent(verb, url, query, header, inline.encode())


def document_of(port: int) -> dict[str, Any]:
    return httpx.get(f"http://127.0.0.1:{port}/openapi.json", timeout=60).json()
