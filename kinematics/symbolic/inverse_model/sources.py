"""A derivation in each programming language."""

from __future__ import annotations

from kinematics.symbolic.inverse_model.c import CSource
from kinematics.symbolic.inverse_model.code import Code
from kinematics.symbolic.inverse_model.matlab import Matlab
from kinematics.symbolic.inverse_model.python import Python
from kinematics.symbolic.inverse_model.statements import Derivation
from kinematics.symbolic.request import Notation

_WRITERS: dict[Notation, type[Code]] = {
    Notation.PYTHON: Python,
    Notation.C: CSource,
    Notation.MATLAB: Matlab,
}


def model_source(derivation: Derivation, notation: Notation) -> str:
    """Return a function that finds all solutions of a target, and runs alone."""
    return _WRITERS[notation](derivation).source()
