"""D-H tables in every format: hostile, broken, ambiguous; and right ones that look odd."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from typing import Any

from tests.corpus.case import CSV, JSON, MINE, PAR, PASTED, YAML, Case, body
from tests.torture.large_tables import LARGE

TABLE: dict[str, Any] = {
    "name": MINE,
    "convention": "standard",
    "units": {"angle": "rad", "length": "m"},
    "base": {"xyz": [0, 0, 0.1], "rpy": [0, 0, 0]},
    "tool": {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1]]},
    "joints": [
        {
            "name": "j1",
            "type": "R",
            "alpha": "pi/2",
            "a": 0,
            "d": 0.3,
            "theta": 0,
            "limits": {"lower": -1, "upper": 1, "velocity": 2, "effort": 10},
        },
        {"name": "j2", "type": "P", "alpha": 0, "a": 0.2, "theta": 0},
    ],
}
BIG = 10**400
CHANGES: dict[str, tuple[tuple[Any, ...], Any, tuple[str, ...]]] = {
    "no convention": (("convention",), KeyError, ("convention", "missing")),
    "unknown convention": (("convention",), "denavit", ("denavit", "khalil")),
    "convention null": (("convention",), None, ("convention",)),
    "convention a list": (("convention",), ["standard"], ("convention",)),
    "unknown field": (("colour",), "red", ("colour", "unknown")),
    "prototype": (("__proto__",), {"a": 1}, ("unknown",)),
    "field with a newline": (("a\nb",), 1, ("unknown",)),
    "unknown unit": (("units",), {"angle": "grad"}, ("grad", "deg")),
    "inches": (("units",), {"length": "inch"}, ("inch", "mm")),
    "units a text": (("units",), "deg", ("units",)),
    "alpha nan": (("joints", 0, "alpha"), float("nan"), ("joint 1", "alpha")),
    "alpha infinite": (("joints", 0, "alpha"), float("inf"), ("joint 1", "alpha")),
    "alpha 1e308": (("joints", 0, "alpha"), 1e308, ("joint 1", "alpha")),
    "alpha of 400 digits": (("joints", 0, "alpha"), BIG, ("joint 1", "alpha")),
    "alpha true": (("joints", 0, "alpha"), True, ("joint 1", "alpha")),
    "alpha null": (("joints", 0, "alpha"), None, ("joint 1", "alpha")),
    "alpha empty": (("joints", 0, "alpha"), "", ("joint 1", "alpha")),
    "alpha a list": (("joints", 0, "alpha"), [1], ("joint 1", "alpha")),
    "alpha NaN as text": (("joints", 0, "alpha"), "nan", ("joint 1", "alpha")),
    "alpha infinity as text": (("joints", 0, "alpha"), "-inf", ("joint 1", "alpha")),
    "alpha a length": (("joints", 0, "alpha"), "10mm", ("joint 1", "alpha")),
    "code": (("joints", 0, "alpha"), "__import__('os').system('id')", ("joint 1", "alpha")),
    "attributes": (("joints", 0, "alpha"), "().__class__.__bases__", ("joint 1", "alpha")),
    "tower of powers": (("joints", 0, "alpha"), "9**9**9**9", ("joint 1", "alpha")),
    "factorial": (("joints", 0, "alpha"), "99999!", ("joint 1", "alpha")),
    "zero division": (("joints", 0, "alpha"), "pi/0", ("joint 1", "zero")),
    "open brackets": (("joints", 0, "alpha"), "(" * 5000, ("joint 1", "alpha")),
    "many minus signs": (("joints", 0, "alpha"), "-" * 5000 + "1", ("joint 1", "alpha")),
    "long sum": (("joints", 0, "alpha"), "+".join(["1"] * 20_000), ("joint 1", "alpha")),
    "another name": (("joints", 0, "alpha"), "beta", ("joint 1", "alpha")),
    "a variable of none": (("joints", 0, "theta"), "q1+q9", ("joint 1", "theta", "q9")),
    "variable times two": (("joints", 0, "theta"), "2*q1", ("joint 1", "theta")),
    "shell": (("joints", 0, "alpha"), "$(id)", ("joint 1", "alpha")),
    "template": (("joints", 0, "alpha"), "{{7*7}}", ("joint 1", "alpha")),
    "formula": (("joints", 0, "alpha"), "=cmd|' /C calc'!A0", ("joint 1", "alpha")),
    "Arabic digits": (("joints", 0, "alpha"), "٣", ("joint 1", "alpha")),
    "a is missing": (("joints", 0, "a"), KeyError, ("joint 1", "a is missing")),
    "a beyond": (("joints", 0, "a"), 1e7, ("joint 1", "a ")),
    "a in degrees": (("joints", 0, "a"), "90deg", ("joint 1", "a ")),
    "r is no column here": (("joints", 0, "r"), 0, ("joint 1", "khalil")),
    "misspelt column": (("joints", 0, "alfa"), 0, ("joint 1", "alfa")),
    "no type": (("joints", 0, "type"), KeyError, ("joint 1", "type")),
    "type ball": (("joints", 0, "type"), "ball", ("joint 1", "ball")),
    "type 1": (("joints", 0, "type"), 1, ("joint 1", "type")),
    "sign 2": (("joints", 0, "sign"), 2, ("joint 1", "sign")),
    "sign 0": (("joints", 0, "sign"), 0, ("joint 1", "sign")),
    "offset nan": (("joints", 0, "offset"), "nan", ("joint 1", "offset")),
    "swapped limits": (("joints", 0, "limits"), {"lower": 1, "upper": -1}, ("joint 1", "swap")),
    "one limit": (("joints", 0, "limits"), {"lower": 1}, ("joint 1", "both")),
    "limit nan": (("joints", 0, "limits"), {"lower": float("nan"), "upper": 1}, ("joint 1",)),
    "limit unknown": (("joints", 0, "limits"), {"min": 0, "max": 1}, ("joint 1", "min")),
    "limits a list": (("joints", 0, "limits"), [-1, 1], ("joint 1", "limits")),
    "velocity negative": (("joints", 0, "limits", "velocity"), -1, ("joint 1", "velocity")),
    "mass negative": (
        ("joints", 0, "inertial"),
        {"mass": -1, "com": [0, 0, 0], "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
        ("joint 1", "mass"),
    ),
    "name taken": (("joints", 1, "name"), "j1", ("joint 2", "taken")),
    "name with a newline": (("joints", 1, "name"), "j\n2", ("joint 2", "name")),
    "name universe": (("joints", 1, "name"), "universe", ("universe",)),
    "name too long": (("joints", 1, "name"), "j" * 5000, ("joint 2", "name")),
    "name with direction": (("joints", 1, "name"), "j\u202e2", ("joint 2", "name")),
    "name of a filler": (("joints", 1, "name"), "\u3164", ("joint 2", "name")),
    "effort an angle": (("joints", 0, "limits", "effort"), "90deg", ("joint 1", "effort", "angle")),
    "mass an angle": (("joints", 0, "inertial"), {"mass": "90°"}, ("joint 1", "mass", "angle")),
    "values with thousands": (("values",), {"L1": "1,234"}, ("L1", "two numbers")),
    "name a number": (("joints", 1, "name"), 2, ("joint 2", "name")),
    "no joints": (("joints",), [], ("joints", "empty")),
    "joints a text": (("joints",), "none", ("joints", "list")),
    "joints null": (("joints",), None, ("joints",)),
    "joints an object": (("joints",), {"j1": {}}, ("joints",)),
    "a row null": (("joints", 1), None, ("joint 2",)),
    "a row a list": (("joints", 1), [0, 0, 0, 0], ("joint 2",)),
    "65 joints": (("joints",), [{"type": "R", "alpha": 0, "a": 0, "d": 0}] * 65, ("65 joints",)),
    "all fixed": (
        ("joints",),
        [{"type": "F", "alpha": 0, "a": 0, "d": 0, "theta": 0}],
        ("no joint that moves",),
    ),
    "bad rows without end": (("joints",), [{}] * 5000, ("joints",)),
    "matrix of two": (("tool",), {"matrix": [[1, 0], [0, 1]]}, ("tool", "four rows")),
    "matrix that grows": (
        ("tool",),
        {"matrix": [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]},
        ("rotation",),
    ),
    "matrix that mirrors": (
        ("tool",),
        {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]},
        ("rotation",),
    ),
    "matrix of nan": (("tool",), {"matrix": [[float("nan")] * 4] * 4}, ("tool",)),
    "last row": (
        ("tool",),
        {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 2]]},
        ("tool",),
    ),
    "quaternion zero": (
        ("tool",),
        {"xyz": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 0]},
        ("quaternion",),
    ),
    "two rotations": (
        ("tool",),
        {"xyz": [0, 0, 0], "rpy": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 1]},
        ("tool",),
    ),
    "base a number": (("base",), 3, ("base",)),
    "xyz of two": (("base",), {"xyz": [0, 0]}, ("base", "xyz")),
    "name another": (("name",), "other", ("name", "other")),
    "name a path": (("name",), "../../etc/passwd", ("name",)),
    "name empty": (("name",), "", ("name",)),
    "name of letters that lie": (("name",), "соrрus", ("name",)),
}
TEXTS: dict[str, tuple[str, str, bytes | str, tuple[str, ...]]] = {
    "json cut": (JSON, "", '{"convention": "standard", "joints": [', ("JSON",)),
    "json nothing": (JSON, "", "", ("empty",)),
    "json null": (JSON, "", "null", ()),
    "json list": (JSON, "", "[]", ()),
    "json text": (JSON, "", '"standard"', ()),
    "json key twice": (
        JSON,
        "",
        '{"convention": "standard", "convention": "modified"}',
        ("convention", "twice"),
    ),
    "json comments": (JSON, "", '{"convention": "standard" /* a */}', ("JSON",)),
    "json single quotes": (JSON, "", "{'convention': 'standard'}", ("JSON",)),
    "json deep": (JSON, "", "[" * 1_100, ("JSON",)),
    "json UTF-16": (JSON, "", json.dumps(TABLE).encode("utf-16"), ("UTF-8",)),
    "json bytes": (JSON, "", b'{"name": "\xff\xfe"}', ("UTF-8",)),
    "json NUL": (JSON, "", json.dumps(TABLE) + "\0", ("JSON",)),
    "json half of a pair": (JSON, "", '{"name": "\\ud800"}', ()),
    "json twice": (JSON, "", json.dumps(TABLE) * 2, ("JSON",)),
    "yaml laughs": (
        YAML,
        "",
        "a: &a [x, x]\n"
        + "".join(
            f"b{k}: &b{k} [{f'*{c}, ' * 9}*{c}]\n"
            for k in range(9)
            for c in ("a" if k == 0 else f"b{k - 1}",)
        ),
        (),
    ),
    "yaml object": (YAML, "", "name: !!python/object/apply:os.system ['id']", ()),
    "yaml tag": (YAML, "", "name: !!binary aGk=", ()),
    "yaml own tag": (YAML, "", "!evil {convention: dh}", ()),
    "yaml merge": (YAML, "", "a: &a {convention: dh}\nb:\n  <<: *a\n", ()),
    "yaml loop": (YAML, "", "a: &a\n  b: *a\n", ()),
    "yaml two documents": (YAML, "", "a: 1\n---\nb: 2\n", ()),
    "yaml tabs": (YAML, "", "joints:\n\t- a: 1\n", ()),
    "yaml key twice": (YAML, "", "convention: dh\nconvention: mdh\njoints: []\n", ("convention",)),
    "yaml .nan": (
        YAML,
        "",
        "convention: dh\njoints: [{type: R, alpha: .nan, a: 0, d: 0}]\n",
        ("joint 1", "alpha"),
    ),
    "yaml .inf": (
        YAML,
        "",
        "convention: dh\njoints: [{type: R, alpha: -.inf, a: 0, d: 0}]\n",
        ("joint 1", "alpha"),
    ),
    "yaml yes": (
        YAML,
        "",
        "convention: dh\njoints: [{type: R, alpha: yes, a: 0, d: 0}]\n",
        ("joint 1", "alpha"),
    ),
    "yaml base 60": (
        YAML,
        "",
        "convention: dh\njoints: [{type: R, alpha: 1:30, a: 0, d: 0}]\n",
        ("joint 1", "alpha"),
    ),
    "yaml underscores": (
        YAML,
        "",
        "convention: dh\njoints:\n- {type: R, alpha: 0, a: 1_000, d: 0}\n",
        ("line 3", "1_000"),
    ),
    "yaml underscores by a tag": (
        YAML,
        "",
        "convention: dh\njoints:\n- {type: R, alpha: 0, a: !!int '1_0', d: 0}\n",
        ("line 3", "1_0"),
    ),
    "yaml binary": (
        YAML,
        "",
        "convention: dh\njoints: [{type: R, alpha: 0, a: 0b11, d: 0}]\n",
        ("line 2", "0b11"),
    ),
    "yaml 1.1": (
        YAML,
        "",
        "%YAML 1.1\n---\nconvention: dh\njoints:\n- {type: R, alpha: 1:30, a: 010, d: 0}\n",
        ("YAML 1.1", "remove"),
    ),
    "yaml merge in place": (
        YAML,
        "",
        "convention: dh\njoints:\n- {<<: {type: R, alpha: 0, a: 1}, a: 2, d: 0}\n",
        ("line 3", "<<"),
    ),
    "yaml date": (YAML, "", "convention: dh\nname: 2001-01-01\njoints: []\n", ()),
    "yaml list": (YAML, "", "- a\n- b\n", ()),
    "yaml number": (YAML, "", "3", ()),
    "yaml nothing": (YAML, "", "", ()),
    "yaml open": (YAML, "", "{convention: [", ()),
    "yaml bytes": (YAML, "", b"\xff\xfe\xfd", ()),
    "yaml NUL": (YAML, "", b"a: \0", ()),
    "yaml complex key": (YAML, "", "? [a, b]\n: c\n", ()),
    "yaml long int": (YAML, "", "convention: 0x" + "f" * 5000, ()),
    "csv no convention": (CSV, f"name={MINE}", "type,alpha,a,d\nR,0,0,0\n", ("convention",)),
    "csv no rows": (CSV, f"name={MINE}&convention=dh", "type,alpha,a,d\n", ()),
    "csv nothing": (CSV, f"name={MINE}&convention=dh", "", ()),
    "csv no header": (CSV, f"name={MINE}&convention=dh", "R,0,0,0\n", ()),
    "csv a cell more": (CSV, f"name={MINE}&convention=dh", "type,alpha,a,d\nR,0,0,0,9\n", ()),
    "csv a cell less": (CSV, f"name={MINE}&convention=dh", "type,alpha,a,d\nR,0,0\n", ()),
    "csv column twice": (
        CSV,
        f"name={MINE}&convention=dh",
        "type,a,a,alpha,d\nR,0,0,0,0\n",
        ("a",),
    ),
    "csv unknown column": (
        CSV,
        f"name={MINE}&convention=dh",
        "type,alpha,a,d,x\nR,0,0,0,0\n",
        ("x",),
    ),
    "csv formula": (
        CSV,
        f"name={MINE}&convention=dh",
        "type,alpha,a,d\nR,=HYPERLINK(1),0,0\n",
        ("alpha",),
    ),
    "csv NUL": (CSV, f"name={MINE}&convention=dh", "type,alpha,a,d\nR,\0,0,0\n", ()),
    "csv open quote": (CSV, f"name={MINE}&convention=dh", 'type,alpha,a,d\nR,"0,0,0\n', ()),
    "csv a line end in a cell": (
        CSV,
        f"name={MINE}&convention=dh",
        'type,alpha,a,d\nR,0,"1\n5",0\n',
        ("line 2", "one line"),
    ),
    "csv a blank line in a cell": (
        CSV,
        f"name={MINE}&convention=dh",
        'type,alpha,a,d\n\nR,0,"0.\r\n\r\n5",0\n',
        ("line 3",),
    ),
    "csv a cell less below blank lines": (
        CSV,
        f"name={MINE}&convention=dh",
        "type,alpha,a,d\n\n\nR,0,0\n",
        ("line 4",),
    ),
    "csv decimal middle dot": (
        CSV,
        f"name={MINE}&convention=dh",
        "type,alpha,a,d\nR,0,0·4,0\n",
        ("joint 1", "·", "product"),
    ),
    "csv uncertainty": (
        CSV,
        f"name={MINE}&convention=dh",
        "type,alpha,a,d\nR,0,0.4318(2),0\n",
        ("joint 1", "parentheses"),
    ),
    "csv thousands in values": (
        CSV,
        f"name={MINE}&convention=dh&values=L1:1,234",
        "type,alpha,a,d\nR,0,L1,0\n",
        ("L1", "two numbers"),
    ),
    "csv nan": (CSV, f"name={MINE}&convention=dh", "type,alpha,a,d\nR,nan,0,0\n", ("alpha",)),
    "par nothing": (PAR, f"name={MINE}", "", ()),
    "par words": (PAR, f"name={MINE}", "hello world", ()),
    "par NJ a million": (PAR, f"name={MINE}", "NL = 1000000\nNJ = 1000000\nalpha={0}", ()),
    "par of unequal lists": (
        PAR,
        f"name={MINE}",
        "NL=2\nNJ=2\nsigma={0,0}\nalpha={0}\nd={0,0}\nr={0,0}\ntheta={t1,t2}\nant={0,1}\n",
        (),
    ),
    "par a loop": (
        PAR,
        f"name={MINE}",
        "NL=2\nNJ=2\nsigma={0,0}\nalpha={0,0}\nd={0,0}\nr={0,0}\ntheta={t1,t2}\nant={2,1}\n",
        (),
    ),
    "par mu 2": (
        PAR,
        f"name={MINE}",
        "NL=1\nNJ=1\nsigma={0}\nalpha={0}\nd={0}\nr={0}\ntheta={t1}\nant={0}\nmu={2}\n",
        ("mu", "'2'"),
    ),
    "par comments that differ": (
        PAR,
        f"name={MINE}",
        "(* Joint 1: lower = -1, upper = 1 *)\n"
        "(* Joint 1: upper = 2 *)\nNL=1\nNJ=1\nsigma={0}\nalpha={0}\n"
        "d={0}\nr={0}\ntheta={t1}\nant={0}\n",
        ("joint 1", "upper twice"),
    ),
    "par a name twice": (
        PAR,
        f"name={MINE}",
        "(* Joint 1: name = 'a', name = 'b' *)\nNL=1\nNJ=1\n"
        "sigma={0}\nalpha={0}\nd={0}\nr={0}\ntheta={t1}\nant={0}\n",
        ("joint 1", "name twice"),
    ),
    "par code": (
        PAR,
        f"name={MINE}",
        "NL=1\nNJ=1\nsigma={0}\nalpha={Run[id]}\nd={0}\nr={0}\ntheta={t1}\nant={0}\n",
        (),
    ),
    "pasted nothing": (PASTED, f"name={MINE}&convention=dh", "", ()),
    "pasted prose": (PASTED, f"name={MINE}&convention=dh", "Dear all, here is my arm.", ()),
    "pasted code": (PASTED, f"name={MINE}&convention=dh", "import os; os.system('id')", ()),
    "pasted evil link": (PASTED, f"name={MINE}&convention=dh", "L = [Link(__import__('os'))]", ()),
    "pasted without units": (
        PASTED,
        f"name={MINE}&convention=dh",
        "| a | b |\n|---|---|\n|1|2|",
        (),
    ),
    "pasted footnote as a subscript": (
        PASTED,
        f"name={MINE}&convention=dh",
        "α a d θ\n90° 0 0.4₁ θ_1\n",
        ("line 2", "0.4"),
    ),
    "pasted stray brace": (
        PASTED,
        f"name={MINE}&convention=dh",
        "|α|a|d|θ|\n|90°|0|2}3|θ_1|\n",
        ("line 2", "2}3"),
    ),
    "pasted brace at the end": (
        PASTED,
        f"name={MINE}&convention=dh",
        "|α|a|d|θ|\n|90°|0|0.4}|θ_1|\n",
        ("line 2", "0.4}"),
    ),
    "pasted backslash before a digit": (
        PASTED,
        f"name={MINE}&convention=dh",
        "|α|a|d|θ|\n|90°|0|2\\3|θ_1|\n",
        ("line 2",),
    ),
    "pasted backslash before a minus": (
        PASTED,
        f"name={MINE}&convention=dh",
        "|α|a|d|θ|\n|90°|0|\\-0.4|θ_1|\n",
        ("line 2",),
    ),
    "a wrong parameter": (
        CSV,
        f"name={MINE}&convention=dh&tip=x",
        "type,alpha,a,d\nR,0,0,0\n",
        ("tip",),
    ),
    "no type at all": ("", "", json.dumps(TABLE), ("--json",)),
    "a form": ("application/x-www-form-urlencoded", "", json.dumps(TABLE), ("--json",)),
    "a multipart form": ("multipart/form-data; boundary=x", "", "--x\r\n\r\n--x--", ("send",)),
    "an octet stream": ("application/octet-stream", "", json.dumps(TABLE), ("send",)),
}
RIGHT: dict[str, tuple[str, str, bytes | str]] = {
    "json": (JSON, "", json.dumps(TABLE)),
    "json with a mark": (JSON, "", b"\xef\xbb\xbf" + json.dumps(TABLE).encode()),
    "csv UTF-16": (CSV, "convention=dh", "type,alpha,a,d\nR,0,0,0\n".encode("utf-16")),
    "json of a charset": ("application/json; charset=UTF-8", "", json.dumps(TABLE)),
    "yaml": (
        YAML,
        "",
        "convention: dh\njoints:\n  - {type: R, alpha: -90deg, a: 0, d: 0,4}\n".replace(
            "0,4", "'0,4'"
        ),
    ),
    "yaml with comments": (
        "text/yaml",
        "",
        "# mine\nconvention: mdh # Craig\njoints:\n- {type: P, alpha: π/2, a: 0, theta: 0}\n",
    ),
    "yaml with a mark": (
        YAML,
        "",
        b"\xef\xbb\xbfconvention: dh\njoints: [{type: R, alpha: 0, a: 1, d: 0}]\n",
    ),
    "yaml 1.2": (
        YAML,
        "",
        "%YAML 1.2\n---\nconvention: dh\njoints:\n- {type: R, alpha: 0, a: -1.5e-1, d: 010}\n",
    ),
    "csv": (CSV, f"name={MINE}&convention=dh", "type,alpha,a,d\nR,pi/2,0,0.1\nR,0,0,0\n"),
    "csv with CRLF and a mark": (
        CSV,
        f"name={MINE}&convention=dh",
        b"\xef\xbb\xbftype,alpha,a,d\r\nR,0,1,0\r\n",
    ),
    "csv with semicolons": (CSV, f"name={MINE}&convention=dh", "type;alpha;a;d\nR;0;0,5;0\n"),
    "par": (
        PAR,
        f"name={MINE}",
        "NL=1\nNJ=1\nNF=1\nsigma={0}\nalpha={0}\nd={0}\nr={0.1}\n"
        "theta={t1}\nant={0}\nb={0}\ngamma={0}\nmu={1}\n",
    ),
    "pasted": (
        PASTED,
        f"name={MINE}&convention=dh",
        "| i | α | a | d | θ |\n|---|---|---|---|---|\n| 1 | 90° | 0 | 0,4 | θ_1 |\n",
    ),
    "64 joints": (
        JSON,
        "",
        json.dumps(TABLE | {"joints": [{"type": "R", "alpha": 0, "a": 0.1, "d": 0}] * 64}),
    ),
}


def changed(path: tuple[Any, ...], value: Any) -> dict[str, Any]:
    document = copy.deepcopy(TABLE)
    target: Any = document
    for key in path[:-1]:
        target = target[key]
    if value is KeyError:
        del target[path[-1]]
    else:
        target[path[-1]] = value
    return document


REFUSED = (400, 413, 415, 422)


def refused() -> Iterator[Case]:
    """Tables that are none."""
    path = f"/v1/robots/{MINE}"
    for name, (place, value, words) in CHANGES.items():
        yield body(
            f"table: {name}",
            path,
            json.dumps(changed(place, value)),
            (422, 400),
            *words,
            method="PUT",
        )
    for name, (kind, query, text, words) in TEXTS.items():
        url = f"{path}?{query.replace(f'name={MINE}&', '').replace(f'name={MINE}', '')}"
        yield body(f"table: {name}", url, text, REFUSED, *words, kind=kind, method="PUT")
    kinds = {"json": JSON, "yaml": YAML, "csv": CSV, "par": PAR, "pasted": PASTED}
    for name, text in LARGE.items():
        asked = "?convention=dh" if text.format in ("csv", "pasted") else ""
        yield body(
            f"table: large: {name}",
            path + asked,
            text.content,
            REFUSED,
            kind=kinds[text.format],
            method="PUT",
        )


def accepted() -> Iterator[Case]:
    """Tables that must not be refused."""
    for name, (kind, query, text) in RIGHT.items():
        url = f"/v1/robots/{MINE}?{query.replace(f'name={MINE}&', '').replace(f'name={MINE}', '')}"
        yield body(f"table, right: {name}", url, text, 201, kind=kind, method="PUT")
