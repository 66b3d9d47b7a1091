"""Schemas of robot documents, which dh_to_urdf.documents.readers reads."""

from __future__ import annotations

from typing import Any

_PLACEMENT = {
    "description": "xyz with rpy or quaternion_xyzw, or a 4x4 matrix.",
    "type": "object",
    "properties": {
        "xyz": {"type": "array", "items": {"$ref": "#/components/schemas/DHCell"}},
        "rpy": {"type": "array", "items": {"$ref": "#/components/schemas/DHCell"}},
        "quaternion_xyzw": {"type": "array", "items": {"type": "number"}},
        "matrix": {"type": "array", "items": {"type": "array", "items": {"type": "number"}}},
    },
    "additionalProperties": False,
}


def table_schemas() -> dict[str, Any]:
    """Schemas of robot documents, which ``dh_to_urdf.documents.readers`` reads."""
    cell = {"$ref": "#/components/schemas/DHCell"}
    columns = ("alpha", "a", "d", "theta", "offset", "r", "gamma", "b")
    row: dict[str, Any] = {
        "type": "object",
        "description": "One joint. standard and modified: alpha, a, d, theta. khalil: alpha, d,"
        " theta, r, and ant, sigma, mu, gamma, b. The variable's own column may be left out.",
        "required": ["alpha"],
        "properties": {
            "name": {"type": "string"},
            "type": {
                "type": "string",
                "description": "revolute (R), prismatic (P), continuous (C) or fixed (F).",
            },
            **dict.fromkeys(columns, cell),
            "sign": {"enum": [1, -1]},
            "ant": {"type": "integer"},
            "sigma": {"enum": [0, 1, 2]},
            "mu": {"enum": [0, 1]},
            "limits": {
                "type": "object",
                "properties": dict.fromkeys(("lower", "upper", "velocity", "effort"), cell),
                "additionalProperties": False,
            },
            "inertial": {"type": "object"},
            "visual": {"type": "boolean"},
            "mimic": {
                "description": "What a follower follows; it is no entry of q. As a text:"
                ' "-2*q1 + 0.1".',
                "anyOf": [
                    {"type": "string", "maxLength": 64},
                    {
                        "type": "object",
                        "required": ["joint"],
                        "properties": {
                            "joint": {"type": "string"},
                            "multiplier": cell,
                            "offset": cell,
                        },
                        "additionalProperties": False,
                    },
                ],
            },
            "coupling": {
                "description": "Other joints that move this one too, and coefficients. As a text:"
                ' "q2".',
                "anyOf": [
                    {"type": "string", "maxLength": 64},
                    {"type": "object", "additionalProperties": cell},
                ],
            },
            "symbols": {
                "description": "What lengths are called in closed forms, by column: L1 or -L1. A"
                " cell that is a name with a value is called so by itself.",
                "type": "object",
                "additionalProperties": {"type": "string", "maxLength": 40},
            },
        },
        "additionalProperties": False,
    }
    table: dict[str, Any] = {
        "type": "object",
        "description": "A Denavit-Hartenberg table.",
        "required": ["convention", "joints"],
        "properties": {
            "name": {"type": "string"},
            "title": {"type": "string"},
            "description": {"type": "string"},
            "source": {"type": "string"},
            "convention": {
                "type": "string",
                "description": "standard (dh, sdh, distal, paul), modified (mdh, craig, proximal)"
                " or khalil (khalil-kleinfinger).",
            },
            "units": {
                "type": "object",
                "properties": {
                    "angle": {"enum": ["rad", "deg"]},
                    "length": {"enum": ["m", "mm"]},
                },
                "additionalProperties": False,
            },
            "base": _PLACEMENT,
            "tool": _PLACEMENT,
            "values": {
                "type": "object",
                "description": "Numbers for names in the cells, such as L1.",
                "additionalProperties": cell,
            },
            "joints": {"type": "array", "minItems": 1, "items": row},
            "residual": {
                "type": "object",
                "description": "In answers: largest deviation of the table's FK from its source"
                " over random q, m and rad (or deg). Not read.",
            },
            "warnings": {"type": "array", "items": {"type": "string"}},
            "explanation": {"type": "array", "items": {"type": "object"}},
        },
        "additionalProperties": False,
    }
    axis = {
        "type": "object",
        "description": "One joint at q = 0, in base axes.",
        "required": ["type", "point", "direction"],
        "properties": {
            "name": {"type": "string"},
            "type": {"type": "string", "description": "revolute, prismatic or continuous."},
            "point": {"type": "array", "items": cell, "minItems": 3, "maxItems": 3},
            "direction": {"type": "array", "items": cell, "minItems": 3, "maxItems": 3},
            "limits": row["properties"]["limits"],
        },
        "additionalProperties": False,
    }
    axes = {
        "type": "object",
        "description": "Joint axes as measured on a drawing.",
        "required": ["joints"],
        "properties": {
            **{key: table["properties"][key] for key in ("name", "convention", "units")},
            **{key: table["properties"][key] for key in ("title", "description", "source")},
            "joints": {"type": "array", "minItems": 1, "items": axis},
            "tip": _PLACEMENT,
        },
        "additionalProperties": False,
    }
    return {
        "DHCell": {
            "description": 'A number, or a text such as "pi/2", "-90deg", "0,4" or "q2-pi/2".',
            "anyOf": [{"type": "number"}, {"type": "string", "maxLength": 64}],
        },
        "DHTable": table,
        "JointAxes": axes,
        "InlineURDF": {
            "type": "object",
            "required": ["urdf"],
            "properties": {
                "urdf": {"type": "string"},
                "base": {"type": "string"},
                "tip": {"type": "string"},
            },
            "additionalProperties": False,
        },
    }
