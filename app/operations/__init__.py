"""The computations of the API, one module each: its request, its answer, and the call."""

from app.operations.base import Answer, Operation
from app.operations.compare import COMPARE
from app.operations.dh import DH_MATRICES
from app.operations.forward import FK
from app.operations.inverse import IK
from app.operations.jacobian import JACOBIAN
from app.operations.path import PATH
from app.operations.singularity import SINGULARITY
from app.operations.solutions import SOLUTIONS
from app.operations.step import STEP

OPERATIONS: tuple[Operation, ...] = (
    IK,
    FK,
    JACOBIAN,
    SINGULARITY,
    SOLUTIONS,
    DH_MATRICES,
    STEP,
    PATH,
    COMPARE,
)

__all__ = ["OPERATIONS", "Answer", "Operation"]
