"""Robots as documents of every type."""

from __future__ import annotations

import json
from typing import Any

from tests.recorded.fixture import FOLDER
from tests.torture.seeds import TABLE

URDF = (
    '<robot name="small"><link name="base"/><link name="arm"/><link name="hand"/>'
    '<link name="tip"/>'
    '<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>'
    '<axis xyz="0 0 1"/><origin xyz="0 0 0.3" rpy="0.1 0 0"/>'
    '<limit lower="-1" upper="1" effort="10" velocity="2"/></joint>'
    '<joint name="slide" type="prismatic"><parent link="arm"/><child link="hand"/>'
    '<axis xyz="0 1 0"/><origin xyz="0.4 0 0"/>'
    '<limit lower="0" upper="0.5" effort="10" velocity="2"/></joint>'
    '<joint name="end" type="fixed"><parent link="hand"/><child link="tip"/>'
    '<origin xyz="0 0 0.1" rpy="0 1.5 0"/></joint></robot>'
)
TREE: dict[str, Any] = {
    "convention": "khalil",
    "units": {"angle": "deg", "length": "mm"},
    "tool": {"xyz": [0, 0, 50], "quaternion_xyzw": [0, 0, 0, 1]},
    "joints": [
        {"name": "a", "type": "R", "ant": 0, "alpha": 0, "d": 0, "r": 300},
        {"name": "b", "sigma": 0, "ant": 1, "alpha": -90, "d": 100, "r": 0, "gamma": 10, "b": 20},
        {
            "name": "c",
            "type": "P",
            "ant": 2,
            "alpha": 90,
            "d": 0,
            "theta": 30,
            "limits": {"lower": 0, "upper": 500},
        },
        {"name": "e", "type": "F", "ant": 1, "alpha": 45, "d": 10, "theta": 0, "r": 20},
    ],
}
YAML = (
    "convention: khalil\nunits: {angle: deg, length: m}\ntool: {xyz: [0, 0, 0.07]}\njoints:\n"
    "  - {type: R, alpha: 0,   d: 0, r: 0.317, limits: {lower: -177, upper: 177}}\n"
    "  - {type: R, alpha: -90, d: 0, r: 0,     limits: {lower: -94,  upper: 94}}\n"
    "  - {type: P, alpha: 90,  d: 0, theta: 0, limits: {lower: 0, upper: 0.3}}\n"
)
CSV = (
    "name,type,alpha,a,d,theta,offset,sign,lower,upper,velocity,effort\n"
    "j1,R,pi/2,0,0.4,0,0,1,-170deg,170deg,2,10\nj2,R,0,0.3,0,0,pi/2,-1,-2,2,,\n"
)
PAR = (
    "(* Robotname = 'planar' *)\nNL = 2\nNJ = 2\nNF = 2\nType = 0\n"
    "ant = {0,1}\nsigma = {0,0}\nb = {0,0}\nd = {0,0.5}\nr = {0,0}\ngamma = {0,0}\n"
    "alpha = {0,0}\nmu = {1,1}\ntheta = {th1,th2}\n"
)
PASTED = (
    "| i | α_i | a_i | d_i | θ_i |\n|---|-----|-----|-----|-----|\n"
    "| 1 | 90° | 0 | 0,4 | θ_1 |\n| 2 | 0 | L3 | 0 | θ_2 - π/2 |\n"
)
LATEX = r"""\begin{tabular}{ccccc}
$i$ & $\alpha_i$ & $a_i$ & $d_i$ & $\theta_i$ \\ \hline
1 & 90 & 0 & 0{,}4 & $\theta_1$ \\
2 & 0 & $l_2$ & 0 & $\theta_2 - \frac{\pi}{2}$ \\
\end{tabular}"""
MATLAB = (
    "L(1) = Link('d', 0.4, 'a', 0, 'alpha', pi/2);\nL(2) = Link('d', 0, 'a', 0.3, 'alpha', 0);\n"
    "robot = SerialLink(L, 'name', 'two');\n"
)
PYTHON = (
    "from roboticstoolbox import DHRobot, RevoluteDH\n"
    "robot = DHRobot([RevoluteDH(d=0.4, alpha=pi/2), RevoluteDH(a=0.3)], name='two')\n"
)
BARE = {name: value for name, value in TABLE.items() if name != "name"}
_PARS = FOLDER.parent / "fixtures" / "par"
DOCUMENTS: dict[str, tuple[str, str, str]] = {
    "JSON modified": ("application/json", "", json.dumps(BARE)),
    "JSON khalil": ("application/json", "", json.dumps(TREE)),
    "JSON standard": (
        "application/json",
        "",
        json.dumps(
            {
                "convention": "standard",
                "joints": [
                    {"type": "R", "alpha": "pi/2", "a": 0, "d": 0.3, "theta": "q1-pi/2"},
                    {"type": "C", "alpha": 0, "a": 0.4, "d": 0, "sign": -1},
                    {"type": "P", "alpha": 0, "a": 0, "theta": "90deg"},
                ],
            }
        ),
    ),
    "YAML": ("application/yaml", "", YAML),
    "CSV standard": ("text/csv", "convention=standard", CSV),
    "CSV modified": ("text/csv", "convention=craig", CSV),
    "CSV khalil": ("text/csv", "convention=khalil", "type;alpha;d;r\nR;0;0;0,3\nR;pi/2;0,1;0\n"),
    "par": ("text/x-symoro", "", PAR),
    "par rx90": ("text/x-symoro", "values=D3:0.45,RL4:450mm", (_PARS / "rx90.par").read_text()),
    "par tree": ("text/x-symoro", "", (_PARS / "tree.par").read_text()),
    "par stanford": ("text/x-symoro", "", (_PARS / "stanford.par").read_text()),
    "pasted": ("text/plain", "convention=standard&values=L3:0.25", PASTED),
    "pasted LaTeX": ("text/plain", "convention=standard&angle=deg&values=l2:0.3", LATEX),
    "pasted MATLAB": ("text/x-matlab", "", MATLAB),
    "pasted Python": ("text/x-python", "", PYTHON),
    "pasted columns": (
        "text/plain",
        "convention=dh&columns=theta,d,a,alpha&angle=deg",
        "q1 0.4 0 90\nq2 0 0.3 0\n",
    ),
    "pasted TSV": (
        "text/tab-separated-values",
        "convention=mdh&angle=deg",
        "alpha\ta\td\ttheta\n0\t0\t0.4\tq1\n90\t0.3\t0\tq2\n",
    ),
    "URDF": ("application/xml", "", URDF),
    "URDF by another type": ("text/xml", "tip=hand&base=arm", URDF),
}
