"""The computations of the API, one module each: its request, its answer, and the call."""

from app.operations.base import Answer, Operation
from app.operations.dh import DH_MATRICES
from app.operations.forward import FK
from app.operations.inverse import IK
from app.operations.jacobian import JACOBIAN
from app.operations.singularity import SINGULARITY
from app.operations.solutions import SOLUTIONS
from app.operations.symbolic import SYMBOLIC

OPERATIONS: tuple[Operation, ...] = (
    IK,
    FK,
    JACOBIAN,
    SINGULARITY,
    SOLUTIONS,
    DH_MATRICES,
    SYMBOLIC,
)

__all__ = ["OPERATIONS", "Answer", "Operation"]
