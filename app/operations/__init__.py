"""The computations of the API: one module each, with its request, its answer type and its call."""

from app.operations.discovery import OPERATIONS
from app.operations.operation import Answer, Context, Operation

__all__ = ["OPERATIONS", "Answer", "Context", "Operation"]
