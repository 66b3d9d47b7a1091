"""Requests that work: for each computation bodies that hold all of its fields, and a query."""

from __future__ import annotations

from typing import Any

Q2, Q3 = [0.5, -0.7], [0.5, -0.7, 1.0]
Q6, Q7 = [0.1, 0.5, -1.2, 0.3, 0.6, 0.2], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
Q8 = [1.9, -0.25, -0.45, -0.5, -0.5, -0.35, 0, 0.2]
EYE = [[1, 0, 0, 0.4], [0, 1, 0, 0.2], [0, 0, 1, 0.5], [0, 0, 0, 1]]
UNHURRIED = 30_000
"""Milliseconds for a target: so many that none runs out of them."""
IK = {"max_restarts": 5, "time_budget_ms": UNHURRIED}
LINE = {
    "q": Q3,
    "target": {"position": [0.6, 0.5]},
    "task": "xy",
    "method": "damped",
    "samples": 4,
    "obstacles": [{"type": "circle", "center": [3, 3], "radius": 0.1}],
}
OPTIONS = {
    "frame": "tool",
    "time_law": "quintic",
    "tf": 1.5,
    "link_radius": 0.01,
    "link_geometry": "skeleton",
    "d_safe": 0.01,
    "closed_loop": True,
    "damping": 0.02,
    "iterations": 5,
    "gains": {"limits": 0.1, "manipulability": 0.1, "obstacles": 0.1, "posture": 0.1},
    "posture": [0.3, 0.2, 0.1],
    "influence": 0.2,
    "obstacle_weight": 0.1,
    "margin": 0.001,
    "secondary": [
        {"frame": "frame_2", "task": "x", "target": {"position": [0.3, 0.1]}, "gain": 0.2}
    ],
    "perturb": 0.0,
    "tolerance": {"position": 1e-4, "orientation": 1e-4},
}
SOLIDS = [
    {"type": "sphere", "center": [3, 3, 0], "radius": 0.1},
    {"type": "circle", "center": [3, 3], "radius": 0.1},
    {"type": "capsule", "start": [3, 0, 0], "end": [3, 1, 0], "radius": 0.1},
    {"type": "half_space", "normal": [0, 1, 0], "offset": -9},
    {"type": "box", "center": [3, 3, 3], "size": [0.1, 0.1, 0.1], "rpy": [0, 0, 0.1]},
    {"type": "box", "center": [3, 3, 3], "size": [0.1, 0.1, 0.1], "quaternion_xyzw": [0, 0, 0, 1]},
    {
        "type": "box",
        "center": [3, 3, 3],
        "size": [0.1, 0.1, 0.1],
        "euler": {"sequence": "ZYX", "angles": [0.1, 0.2, 0.3]},
    },
]

BODIES: dict[str, list[tuple[str, dict[str, Any]]]] = {
    "ik": [
        (
            "puma560",
            {
                "target": {"matrix": EYE},
                "frame": "tool",
                "task": "pose",
                "seed": Q6,
                "tolerance": {"position": 1e-6, "orientation": 1e-6},
                "random_seed": 1,
                "max_iterations": 50,
                "choose": "closest",
                **IK,
            },
        ),
        (
            "puma560",
            {
                "target": {
                    "position": [0.4, 0.2, 0.5],
                    "euler": {"sequence": "ZXZ", "angles": [0.1, 0.2, 0.3]},
                },
                **IK,
            },
        ),
        (
            "puma560",
            {"target": {"position": [0.4, 0.2, 0.5], "quaternion_xyzw": [0, 0, 0, 1]}, **IK},
        ),
        ("puma560", {"target": {"position": [0.4, 0.2, 0.5], "rpy": [0.1, 0.2, 0.3]}, **IK}),
        ("planar_3r", {"target": {"position": [0.6, 0.5], "phi": 0.3}, "task": "xy_phi", **IK}),
        (
            "puma560",
            {
                "target": {"position": [0.4, 0.2, 0.5], "direction": [0, 0, -1]},
                "task": "position_direction",
                **IK,
            },
        ),
        (
            "puma560",
            {
                "targets": [{"position": [0.4, 0.2, 0.5]}, {"position": [0.3, 0.2, 0.4]}],
                "task": "position",
                **IK,
            },
        ),
        (
            "puma560",
            {
                "targets": {
                    "position": [[0.4, 0.2, 0.5], [0.3, 0.2, 0.4]],
                    "quaternion_xyzw": [[0, 0, 0, 1], [0, 0, 1, 0]],
                },
                **IK,
            },
        ),
        (
            "puma560",
            {
                "targets": {
                    "position": [[0.4, 0.2, 0.5]],
                    "euler": {"sequence": "ZYX", "angles": [[0.1, 0.2, 0.3]]},
                },
                **IK,
            },
        ),
        ("puma560", {"targets": {"matrix": [EYE, EYE]}, **IK}),
        (
            "planar_3r",
            {
                "targets": {"position": [[0.6, 0.5], [0.5, 0.4]], "phi": [0.3, 0.2]},
                "task": "xy_phi",
                **IK,
            },
        ),
    ],
    "fk": [
        ("pa10", {"q": Q7, "frames": ["tool", "frame_3"], "euler": "ZXZ"}),
        ("planar_2r", {"q": [Q2, [0.1, 0.2], [0, 0]], "frames": "all", "euler": "xyz"}),
        ("planar_2r", {"q": {"j1": 0.1, "j2": 0.2}}),
    ],
    "jacobian": [
        ("pa10", {"q": Q7, "frame": "frame_5", "reference_frame": "world"}),
        ("puma560", {"q": Q6, "euler": "ZYX"}),
        ("planar_2r", {"q": [Q2, [0.1, 0.2]], "reference_frame": "local"}),
    ],
    "singularity": [
        (
            "puma560",
            {
                "q": Q6,
                "task": "position",
                "frame": "tool",
                "tolerance": 1e-9,
                "characteristic_length": 0.5,
            },
        ),
        ("planar_2r", {"q": [[0.5, 0.2], [0.1, 0]], "task": [1, 1, 0, 0, 0, 0]}),
    ],
    "ik/solutions": [
        (
            "puma560",
            {
                "target": {"position": [0.4, 0.2, 0.5], "rpy": [0.1, 0.2, 0.3]},
                "frame": "tool",
                "task": "pose",
                "seed": Q6,
                "tolerance": {"position": 1e-6, "orientation": 1e-6},
                "random_seed": 1,
            },
        ),
        ("planar_2r", {"target": {"position": [1.2, 0.5]}, "task": "xy"}),
    ],
    "dh-matrices": [("pa10", {"q": Q7}), ("planar_2r", {"q": [Q2, [0, 0]]})],
    "twist": [
        (
            "pa10",
            {
                "q": Q7,
                "qd": [0.1, 0, 0, 0.2, 0, 0, 0],
                "frame": "frame_6",
                "reference_frame": "world",
            },
        ),
        ("planar_2r", {"q": [Q2, [0, 0]], "qd": {"j1": 1, "j2": -1}}),
    ],
    "joint-velocities": [
        (
            "pa10",
            {
                "q": Q7,
                "twist": [0.1, 0, 0],
                "task": "position",
                "frame": "tool",
                "reference_frame": "local",
                "damping": 0.1,
                "tolerance": 1e-10,
            },
        ),
        ("planar_2r", {"q": [Q2, [0, 0]], "twist": [[0.1, 0], [0, 0.1]], "task": "xy"}),
    ],
    "joint-torques": [
        (
            "puma560",
            {
                "q": Q6,
                "wrench": [0, 0, 10, 0, 0, 1],
                "frame": "frame_4",
                "reference_frame": "local",
            },
        ),
        ("planar_2r", {"q": [Q2, [0, 0]], "wrench": [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0]]}),
    ],
    "wrench": [
        (
            "puma560",
            {
                "q": Q6,
                "tau": [1, -4, -3, 0.2, 0.5, 0.8],
                "task": "pose",
                "frame": "tool",
                "reference_frame": "world",
                "tolerance": 1e-10,
            },
        ),
        ("planar_2r", {"q": [Q2, [0, 0]], "tau": [[1, 0], [0, 1]], "task": "xy"}),
    ],
    "jacobian-derivative": [
        (
            "pa10",
            {
                "q": Q7,
                "qd": [0.1, 0, 0, 0.2, 0, 0, 0],
                "frame": "frame_4",
                "reference_frame": "local",
            },
        ),
        ("planar_2r", {"q": [Q2, [0, 0]], "qd": [[1, -1], [0, 1]]}),
    ],
    "hessian": [
        ("planar_3r", {"q": Q3, "frame": "frame_3", "reference_frame": "world"}),
        ("planar_2r", {"q": [Q2, [0, 0]]}),
    ],
    "manipulability-gradient": [
        ("pa10", {"q": Q7, "task": "position", "frame": "tool", "tolerance": 1e-10}),
        ("planar_2r", {"q": [Q2, [0, 0]], "task": "xy"}),
    ],
    "singularity/nearest": [
        ("planar_3r", {"q": Q3, "task": "xy", "frame": "tool", "tolerance": 1e-10}),
    ],
    "symbolic": [
        (
            "planar_2r",
            {
                "quantities": ["position"],
                "parameters": "symbolic",
                "symbols": {"a2": "L1"},
                "frame": "frame_2",
                "base": "frame_0",
                "expressed_in": "frame_0",
                "task": "xy",
                "format": "text",
                "time_budget_ms": UNHURRIED,
            },
        ),
    ],
    "step": [
        (
            "planar_3r",
            {
                "q": Q3,
                "delta_x": [0.01, 0],
                "z": [0.1, 0, 0],
                "task": "xy",
                "frame": "tool",
                "damping": 0.1,
            },
        ),
        (
            "planar_3r",
            {
                "q": Q3,
                "delta_x": [0.01, 0],
                "task": "xy",
                "secondary": [{"delta_x": [0.01], "task": "x", "frame": "frame_2"}],
            },
        ),
    ],
    "path": [
        ("planar_3r", {**LINE, **OPTIONS}),
        ("planar_3r", {**LINE, "samples": 3, "obstacles": SOLIDS}),
        (
            "planar_3r",
            {
                "q": Q3,
                "task": "xy",
                "samples": 4,
                "circle": {"center": [0.6, 0.2], "plane": "xy", "turns": 0.2},
            },
        ),
        (
            "planar_3r",
            {
                "q": Q3,
                "task": "xy",
                "samples": 4,
                "circle": {"center": [0.6, 0.2, 0.0], "normal": [0, 0, 1]},
            },
        ),
        (
            "planar_3r",
            {
                "q": Q3,
                "task": "xy_phi",
                "samples": 4,
                "waypoints": [
                    {"position": [0.7, 0.4], "phi": 0.5},
                    {"position": [0.6, 0.5], "phi": 0.6},
                ],
            },
        ),
        ("planar_3r", {**LINE, "retime": {"acceleration": 5, "velocity": [1, 2, 3], "samples": 7}}),
        (
            "planar_3r",
            {
                **LINE,
                "retime": {"acceleration": {"j1": 5, "j2": 5, "j3": 4}},
                "link_radius": [0.01, 0.02, 0.01],
            },
        ),
        ("planar_3r", {**LINE, "link_radius": {"j1": 0.01, "j2": 0.02, "j3": 0.01}}),
    ],
    "path/compare": [
        (
            "planar_3r",
            {
                **{k: v for k, v in LINE.items() if k != "method"},
                "samples": 5,
                "methods": [
                    "damped",
                    {
                        "method": "null_space",
                        "label": "x",
                        "closed_loop": True,
                        "damping": 0.1,
                        "iterations": 4,
                        "gains": {"limits": 0.1},
                        "influence": 0.2,
                        "obstacle_weight": 0.1,
                        "margin": 0.01,
                        "perturb": 0.0,
                    },
                ],
            },
        ),
    ],
    "picture.svg": [
        (
            "puma560",
            {
                "q": Q6,
                "frames": ["tool", "frame_3"],
                "view": "iso",
                "labels": True,
                "width": 300,
                "height": 250,
            },
        ),
    ],
    "picture.png": [
        (
            "planar_2r",
            {
                "q": Q2,
                "frames": ["tool"],
                "view": "xy",
                "labels": False,
                "width": 200,
                "height": 200,
            },
        ),
    ],
    "workspace": [("planar_3r", {"samples": 20, "frame": "frame_3", "random_seed": 3})],
    "manipulability-map": [
        (
            "planar_3r",
            {"q": Q3, "joints": ["j2", "j3"], "samples": 5, "task": "xy", "frame": "tool"},
        ),
    ],
}
ALSO = {
    "planar_3r": [
        ("path", {**LINE, "method": method})
        for method in (
            "pseudo_inverse",
            "damped",
            "null_space",
            "task_priority",
            "sqp",
            "qp",
            "whole_path",
        )
    ],
}

_TARGET = {"position": "0.4,0.2,0.5", "rpy": "0.1,0.2,pi/4"}
QUERIES: dict[str, tuple[str, dict[str, str]]] = {
    "ik": (
        "puma560",
        {
            **_TARGET,
            "task": "pose",
            "seed": "0.1,0.5,-1.2,0.3,0.6,0.2",
            "max_restarts": "5",
            "time_budget_ms": "30000",
        },
    ),
    "fk": (
        "pa10",
        {"q": "0.1,pi/8,20deg,-0.4,0.5,0.6,0.7", "frames": "tool,frame_3", "euler": "ZXZ"},
    ),
    "jacobian": ("pa10", {"q": "0.1,0.2,0.3,0.4,0.5,0.6,0.7", "reference_frame": "local"}),
    "singularity": ("planar_2r", {"q": "0.5,0", "task": "xy"}),
    "ik/solutions": ("puma560", dict(_TARGET)),
    "dh-matrices": ("planar_2r", {"q": "pi/6,-45deg"}),
    "twist": ("planar_2r", {"q": "0.5,0.3", "qd": "1,-1"}),
    "joint-velocities": ("planar_2r", {"q": "0.5,0.3", "twist": "0.1,0", "task": "xy"}),
    "joint-torques": ("puma560", {"q": "0,0.5,-1.2,0,0.6,0", "wrench": "0,0,10,0,0,1"}),
    "wrench": ("planar_2r", {"q": "0.5,0.3", "tau": "1,-4", "task": "xy"}),
    "jacobian-derivative": ("planar_2r", {"q": "0.5,0.3", "qd": "1,-1"}),
    "hessian": ("planar_2r", {"q": "0.5,0.3"}),
    "manipulability-gradient": ("planar_2r", {"q": "0.5,0.3", "task": "xy"}),
    "singularity/nearest": ("planar_3r", {"q": "0.5,0.3,0.2", "task": "xy"}),
    "symbolic": (
        "planar_2r",
        {"quantities": "position", "parameters": "symbolic", "time_budget_ms": "30000"},
    ),
    "step": ("planar_3r", {"q": "0.5236,-0.7854,60deg", "delta_x": "0.01,0", "task": "xy"}),
    "path": (
        "planar_3r",
        {"q": "0.5,-0.7,1.0", "position": "0.6,0.5", "task": "xy", "samples": "5"},
    ),
    "path/compare": (
        "planar_3r",
        {
            "q": "0.5,-0.7,1.0",
            "position": "0.6,0.5",
            "task": "xy",
            "samples": "5",
            "methods": "damped,qp",
        },
    ),
    "picture.svg": ("planar_2r", {"q": "0.5,-0.7", "width": "300", "height": "250"}),
    "picture.png": ("planar_2r", {"q": "0.5,-0.7", "width": "200", "height": "200"}),
    "workspace": ("planar_2r", {"samples": "10"}),
    "manipulability-map": (
        "planar_3r",
        {"q": "0,0.5,-0.5", "joints": "j2,j3", "samples": "4", "task": "xy"},
    ),
}
KNOWN: dict[str, tuple[str, ...]] = {
    "ik": (
        "position",
        "rpy",
        "quaternion_xyzw",
        "euler",
        "phi",
        "direction",
        "matrix",
        "frame",
        "task",
        "seed",
        "max_restarts",
        "random_seed",
        "time_budget_ms",
        "max_iterations",
        "tolerance",
        "choose",
    ),
    "fk": ("q", "frames", "euler"),
    "jacobian": ("q", "frame", "reference_frame", "euler"),
    "singularity": ("q", "task", "frame", "tolerance", "characteristic_length"),
    "ik/solutions": (
        "position",
        "rpy",
        "quaternion_xyzw",
        "euler",
        "phi",
        "direction",
        "matrix",
        "frame",
        "task",
        "seed",
        "tolerance",
        "random_seed",
    ),
    "dh-matrices": ("q",),
    "twist": ("q", "qd", "frame", "reference_frame"),
    "joint-velocities": ("q", "twist", "task", "frame", "reference_frame", "damping", "tolerance"),
    "joint-torques": ("q", "wrench", "frame", "reference_frame"),
    "wrench": ("q", "tau", "task", "frame", "reference_frame", "tolerance"),
    "jacobian-derivative": ("q", "qd", "frame", "reference_frame"),
    "hessian": ("q", "frame", "reference_frame"),
    "manipulability-gradient": ("q", "task", "frame", "tolerance"),
    "singularity/nearest": ("q", "task", "frame", "tolerance"),
    "symbolic": (
        "quantities",
        "parameters",
        "symbols",
        "frame",
        "base",
        "expressed_in",
        "task",
        "time_budget_ms",
    ),
    "step": ("q", "delta_x", "z", "task", "frame", "damping"),
    "path": (
        "q",
        "position",
        "rpy",
        "quaternion_xyzw",
        "euler",
        "phi",
        "direction",
        "matrix",
        "frame",
        "task",
        "method",
        "time_law",
        "tf",
        "samples",
        "damping",
        "tolerance",
    ),
    "path/compare": (
        "q",
        "position",
        "phi",
        "matrix",
        "frame",
        "task",
        "method",
        "time_law",
        "tf",
        "samples",
        "damping",
        "tolerance",
        "methods",
    ),
    "picture.svg": ("q", "frames", "view", "labels", "width", "height"),
    "picture.png": ("q", "frames", "view", "labels", "width", "height"),
    "workspace": ("samples", "frame", "random_seed"),
    "manipulability-map": ("q", "joints", "samples", "task", "frame"),
}
"""The parameters of the GET forms, those of targets for paths in part."""
NPY = (
    "ik",
    "fk",
    "jacobian",
    "singularity",
    "dh-matrices",
    "twist",
    "joint-velocities",
    "joint-torques",
    "wrench",
    "jacobian-derivative",
    "hessian",
    "manipulability-gradient",
)
"""Computations that take a body of type npy."""
