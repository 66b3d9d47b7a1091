"""The memory that the program of a whole path takes in its process: measured, as a formula."""

from __future__ import annotations

FIXED = 8_000_000
BY_JOINTS = 5_000
"""Bytes of the expressions of second derivatives of the pose, for each pair of joints."""
BY_HESSIAN, BY_JOINT, BY_DISTANCE = 550, 5_500, 2_700
"""Bytes of a sample: for each pair of joints, each joint, each pair of link and obstacle."""
BY_DISTANCE_HESSIAN, BY_EXPRESSION = 700, 200_000
"""Bytes of a pair of link and obstacle, whatever the samples: of the expressions of its second
derivatives, for each pair of joints, and of its distance."""


def program_bytes(samples: int, joints: int, links: int, solids: int) -> int:
    """Return the bytes of a program, of what CasADi derives from it, and of IPOPT's factors.

    Args:
        samples: N.
        joints: K.
        links: Capsules of the arm.
        solids: Obstacles.
    """
    return expression_bytes(joints, links, solids) + samples * sample_bytes(joints, links, solids)


def expression_bytes(joints: int, links: int, solids: int) -> int:
    """Return the part of :func:`program_bytes` that does not grow with the samples."""
    distances = links * solids * (BY_DISTANCE_HESSIAN * joints**2 + BY_EXPRESSION)
    return FIXED + BY_JOINTS * joints**2 + distances


def sample_bytes(joints: int, links: int, solids: int) -> int:
    """Return the part of :func:`program_bytes` of one sample."""
    return BY_HESSIAN * joints**2 + BY_JOINT * joints + BY_DISTANCE * links * solids
