"""Nine reference scenarios as requests for paths."""

import json

import numpy as np

from tests.conftest import FIXTURES

SCENARIOS = json.loads((FIXTURES / "scenarios.json").read_text())["scenarios"]
DEGREE = np.pi / 180


def body_of(scenario):
    lengths, limits = scenario["L"], scenario["limits_deg"]
    joints = [
        {
            "type": "R",
            "alpha": 0,
            "a": lengths[k - 1] if k else 0,
            "d": 0,
            "limits": {"lower": limits[k][0], "upper": limits[k][1]},
        }
        for k in range(len(lengths))
    ]
    robot = {
        "convention": "modified",
        "units": {"angle": "deg", "length": "m"},
        "tool": {"xyz": [lengths[-1], 0, 0], "rpy": [0, 0, 0]},
        "joints": joints,
    }
    target = {"position": scenario["Pf"]}
    if "phi_f_deg" in scenario:
        target["phi"] = scenario["phi_f_deg"]
    return {
        "robot": robot,
        "q": scenario["q0_deg"],
        "target": target,
        "task": {"xy": "xy", "xyphi": "xy_phi"}[scenario["task"]],
        "tf": scenario["tf"],
        "samples": scenario["N"],
        "obstacles": [
            {"type": "circle", "center": [x, y], "radius": r} for x, y, r in scenario["obstacles"]
        ],
        "link_radius": scenario["link_radius"],
        "d_safe": scenario["d_safe"],
    }


LINE = {
    "q": [0, -0.5, 0, -2.0, 0, 1.6, 0.8],
    "target": {"position": [0.4, 0.2, 0.5]},
    "task": "position",
    "samples": 101,
    "obstacles": [{"type": "sphere", "center": [0.7, 0.5, 0.5], "radius": 0.1}],
    "link_radius": 0.05,
}
