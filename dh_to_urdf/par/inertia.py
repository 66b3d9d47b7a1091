"""Mass properties about the centre of mass <-> SYMORO's, about the origin of the frame.

Khalil and Dombre, *Modeling, Identification and Control of Robots*, ch. 9: the standard inertial
parameters of link j are XX … ZZ (inertia tensor about the origin of frame j, its off-diagonal
elements negative products), MX, MY, MZ (first moments) and M.
"""

from __future__ import annotations

import numpy as np

from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Inertial

TENSOR = {"XX": (0, 0), "XY": (0, 1), "XZ": (0, 2), "YY": (1, 1), "YZ": (1, 2), "ZZ": (2, 2)}
MOMENTS = ("MX", "MY", "MZ")
PARAMETERS = (*TENSOR, *MOMENTS, "M")


def to_parameters(inertial: Inertial) -> dict[str, float]:
    """Return the ten parameters of a link, in kg m², kg m and kg, in the axes of its frame."""
    com = np.array(inertial.com)
    J = np.array(inertial.inertia) + inertial.mass * _steiner(com)
    first = inertial.mass * com
    return {
        **{key: float(J[place]) for key, place in TENSOR.items()},
        **{key: float(moment) for key, moment in zip(MOMENTS, first, strict=True)},
        "M": inertial.mass,
    }


def from_parameters(parameters: dict[str, float]) -> Inertial:
    """Return mass (kg), centre of mass (m) and inertia about it (kg m²) of ten parameters.

    Args:
        parameters: The ten parameters; M is not 0.
    """
    mass = parameters["M"]
    com = np.array([parameters[key] for key in MOMENTS]) / mass
    J = np.empty((3, 3))
    for key, (i, j) in TENSOR.items():
        J[i, j] = J[j, i] = parameters[key]
    inertia = J - mass * _steiner(com)
    rows = [tuple(float(value) for value in row) for row in inertia]
    return Inertial(mass, tuple(map(float, com)), tuple(rows))  # type: ignore[arg-type]


def _steiner(com: Matrix) -> Matrix:
    """Return the inertia of a unit mass at ``com`` about the origin."""
    return np.asarray(com @ com * np.eye(3) - np.outer(com, com))
