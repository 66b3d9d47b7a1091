"""Closed forms: A_k, 0A_k, T, the Jacobian and its determinant in the short names of lectures.

``SymbolicWorkers().run(table, SymbolicRequest(quantities=(Quantity.POSITION,)))`` computes in a
process of its own. It needs SymPy (``pip install 'denavit[symbolic]'``); importing this module does
not.
"""

from kinematics.symbolic.request import Notation, Quantity, SymbolicRequest
from kinematics.symbolic.workers import MEMORY, SymbolicUnavailable, SymbolicWorkers

__all__ = [
    "MEMORY",
    "Notation",
    "Quantity",
    "SymbolicRequest",
    "SymbolicUnavailable",
    "SymbolicWorkers",
]
