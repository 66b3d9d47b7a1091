"""The computations of the API, one module each: its request, its answer, and the call."""

from app.operations.base import Answer, Operation
from app.operations.compare import COMPARE
from app.operations.derivatives import HESSIAN, JACOBIAN_DERIVATIVE, MANIPULABILITY_GRADIENT
from app.operations.dh import DH_MATRICES
from app.operations.forward import FK
from app.operations.inverse import IK
from app.operations.jacobian import JACOBIAN
from app.operations.maps import MANIPULABILITY_MAP, WORKSPACE
from app.operations.nearest_singularity import NEAREST_SINGULARITY
from app.operations.path import PATH
from app.operations.pictures import PICTURE_PNG, PICTURE_SVG
from app.operations.singularity import SINGULARITY
from app.operations.solutions import SOLUTIONS
from app.operations.statics import JOINT_TORQUES, WRENCH
from app.operations.step import STEP
from app.operations.symbolic import SYMBOLIC
from app.operations.velocity import JOINT_VELOCITIES, TWIST

OPERATIONS: tuple[Operation, ...] = (
    IK,
    FK,
    JACOBIAN,
    SINGULARITY,
    SOLUTIONS,
    DH_MATRICES,
    TWIST,
    JOINT_VELOCITIES,
    JOINT_TORQUES,
    WRENCH,
    JACOBIAN_DERIVATIVE,
    HESSIAN,
    MANIPULABILITY_GRADIENT,
    NEAREST_SINGULARITY,
    SYMBOLIC,
    STEP,
    PATH,
    COMPARE,
    PICTURE_SVG,
    PICTURE_PNG,
    WORKSPACE,
    MANIPULABILITY_MAP,
)

__all__ = ["OPERATIONS", "Answer", "Operation"]
