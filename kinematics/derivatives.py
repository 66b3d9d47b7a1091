"""Derivatives of the Jacobian: the kinematic Hessian ∂J/∂q, and dJ/dt along a motion.

Both follow from the Jacobian's own columns ``S_j = [v_j; ω_j]`` (a prismatic joint has ω_j = 0).
With joint k before joint j, or the same, on the way from the base to the frame:

- ``local_world_aligned``: joint k carries axis j and the tip along, ``∂v_j = ω_k × v_j`` and
  ``∂ω_j = ω_k × ω_j``; joint j moves the tip against axis k, ``∂v_k/∂q_j = ω_k × v_j``
  (Hourtash, *The kinematic Hessian and higher derivatives*, 2005; Bruyninckx and De Schutter,
  *Symbolic differentiation of the velocity mapping*, 1996).
- ``world``: ``∂S_j/∂q_k = S_k × S_j``, the Lie bracket of spatial twists; ``∂S_k/∂q_j = 0``.
- ``local``: ``∂S_k/∂q_j = S_k × S_j``, that of body twists; ``∂S_j/∂q_k = 0``
  (Müller, *Screw and Lie group theory in multibody kinematics*, 2018).

Where joints depend on others, these are derivatives by the joint values ``C q + c``, and those by q
follow by C, which is constant.
"""

from __future__ import annotations

import numpy as np

from kinematics.chain import Chain, chain_of
from kinematics.configuration import configuration
from kinematics.deadline import checked
from kinematics.jacobian import ReferenceFrame, jacobian_by_joint
from kinematics.jacobian import peak_bytes as jacobian_bytes
from kinematics.spatial_vectors import check_same_length
from robots.robot import FloatArray, Robot

_NUMBERS_AT_ONCE = 300_000


def hessian(
    robot: Robot,
    q: FloatArray,
    frame: str | None = None,
    reference_frame: ReferenceFrame = ReferenceFrame.LOCAL_WORLD_ALIGNED,
) -> FloatArray:
    """Return the kinematic Hessian ``H[:, j, k] = ∂J[:, j]/∂q_k``.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        frame: Frame name; default the tip.
        reference_frame: That of the Jacobian, see :class:`ReferenceFrame`.

    Returns:
        Shape (6, dof, dof) or (n, 6, dof, dof); zero for joints that do not move the frame.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
    """
    frame = frame or robot.tip_frame
    chain = chain_of(robot, frame)
    columns, dof = chain.columns, robot.dof
    S = jacobian_by_joint(robot, q, frame, reference_frame)
    H = np.zeros((*S.shape[:-1], dof, dof))
    if S.ndim == 2:
        H[:, columns[:, None], columns] = _in_q(chain, _pairs(S, reference_frame))
        return H
    step = max(1, _NUMBERS_AT_ONCE // (6 * max(dof, chain.length) ** 2))
    for start in checked(range(0, len(S), step), 1):
        pairs = _pairs(S[start : start + step], reference_frame)
        H[start : start + step, :, columns[:, None], columns] = _in_q(chain, pairs)
    return H


def hessian_bytes(dof: int) -> int:
    """Return the bytes for each q of a batch of Hessians, without what a slice takes."""
    return 8 * 6 * dof**2 + jacobian_bytes(dof)


def jacobian_derivative_bytes(dof: int) -> int:
    """Return the bytes for each q of a batch of derivatives of Jacobians, likewise."""
    return 8 * (6 * dof + 2 * dof) + jacobian_bytes(dof, 1)


def _in_q(chain: Chain, pairs: FloatArray) -> FloatArray:
    """Return second derivatives by entries of q, shapes (..., K, K) -> (..., n, n)."""
    if not chain.is_coupled:
        return pairs
    return np.asarray(chain.coupling.T @ pairs @ chain.coupling)


def jacobian_derivative(
    robot: Robot,
    q: FloatArray,
    qd: FloatArray,
    frame: str | None = None,
    reference_frame: ReferenceFrame = ReferenceFrame.LOCAL_WORLD_ALIGNED,
) -> FloatArray:
    """Return the time derivative of the Jacobian, ``dJ/dt = Σ_k ∂J/∂q_k qd_k``.

    ``dJ/dt qd`` is what the joint velocities alone contribute to the derivative of the twist,
    ``d/dt [v; ω] = J qdd + dJ/dt qd``. In ``local_world_aligned`` that derivative is the
    acceleration of the frame's origin; in ``world`` and ``local`` it is the spatial and the body
    acceleration (Featherstone, *Rigid Body Dynamics Algorithms*, 2.11).

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        qd: Joint velocities, rad/s and m/s, shape (dof,) or (n, dof).
        frame: Frame name; default the tip.
        reference_frame: That of the Jacobian, see :class:`ReferenceFrame`.

    Returns:
        Shape (6, dof), or (n, 6, dof) where q or qd is a batch.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q or qd has a wrong shape or is not finite.
        WrongVector: Batches of unequal length.
    """
    frame = frame or robot.tip_frame
    chain = chain_of(robot, frame)
    S = jacobian_by_joint(robot, q, frame, reference_frame)
    qd = configuration(robot, qd, "qd")
    check_same_length(np.asarray(q), qd, "qd")
    columns = chain.columns
    shape = np.broadcast_shapes(S.shape[:-2], qd.shape[:-1])
    result = np.zeros((*shape, 6, robot.dof))
    speeds = qd[..., columns]
    if chain.is_coupled:
        speeds = speeds @ chain.coupling.T
    if not shape:
        result[:, columns] = chain.in_q(_change(S, speeds, reference_frame))
        return result
    S = np.broadcast_to(S, (*shape, 6, chain.length))
    speeds = np.broadcast_to(speeds, (*shape, chain.length))
    step = max(1, _NUMBERS_AT_ONCE // (6 * max(robot.dof, chain.length)))
    for start in checked(range(0, len(result), step), 1):
        part = slice(start, start + step)
        change = _change(S[part], speeds[part], reference_frame)
        result[part, :, columns] = chain.in_q(change)
    return result


def _change(S: FloatArray, qd: FloatArray, reference_frame: ReferenceFrame) -> FloatArray:
    """Return dJ/dt over a chain's columns; shapes (..., 6, K), (..., K) -> (..., 6, K)."""
    T = S * qd[..., None, :]
    before, after = _sum_before(T), _sum_before(T[..., ::-1])[..., ::-1]
    v, w = S[..., :3, :], S[..., 3:, :]
    if reference_frame is ReferenceFrame.LOCAL:
        dv = _cross(w, after[..., :3, :]) + _cross(v, after[..., 3:, :])
        dw = _cross(w, after[..., 3:, :])
    else:
        turn = before[..., 3:, :]
        dw = _cross(turn, w)
        if reference_frame is ReferenceFrame.WORLD:
            dv = _cross(turn, v) + _cross(before[..., :3, :], w)
        else:
            dv = _cross(turn + T[..., 3:, :], v) + _cross(w, after[..., :3, :])
    return np.concatenate((dv, dw), axis=-2)


def _pairs(S: FloatArray, reference_frame: ReferenceFrame) -> FloatArray:
    """Return the Hessian over a chain's columns; shapes (..., 6, K) -> (..., 6, K, K)."""
    K = S.shape[-1]
    v, w = S[..., :3, :], S[..., 3:, :]
    vj, wj, vk, wk = v[..., :, None], w[..., :, None], v[..., None, :], w[..., None, :]
    earlier = np.tri(K, k=-1, dtype=bool)  # [j, k]: joint k before joint j
    if reference_frame is ReferenceFrame.LOCAL:
        linear = np.where(earlier.T, _cross(wj, vk, -3) + _cross(vj, wk, -3), 0.0)
        angular = np.where(earlier.T, _cross(wj, wk, -3), 0.0)
    else:
        angular = np.where(earlier, _cross(wk, wj, -3), 0.0)
        if reference_frame is ReferenceFrame.WORLD:
            linear = np.where(earlier, _cross(wk, vj, -3) + _cross(vk, wj, -3), 0.0)
        else:
            linear = np.where(np.tri(K, dtype=bool), _cross(wk, vj, -3), _cross(wj, vk, -3))
    return np.concatenate((linear, angular), axis=-3)


def _sum_before(T: FloatArray) -> FloatArray:
    """Return the sum of the columns before each column."""
    sums = np.zeros_like(T)
    np.cumsum(T[..., :-1], axis=-1, out=sums[..., 1:])
    return sums


def _cross(a: FloatArray, b: FloatArray, axis: int = -2) -> FloatArray:
    """Return vector products along an axis of length 3."""
    x, y = np.moveaxis(a, axis, 0), np.moveaxis(b, axis, 0)
    parts = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])
    return np.stack(parts, axis=axis)
