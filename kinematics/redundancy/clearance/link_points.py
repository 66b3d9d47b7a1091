"""Compiled placement of the links of an arm at a configuration.

Links are the rows of :class:`~.links.Links`, capsules whose ends are fixed to joints; carrier K is
the frame, -1 the base. Their ends are written to the last rows of the workspace, which
:func:`kinematics.redundancy.kernel.workspace` makes long enough.
"""

from __future__ import annotations

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.task_error import TaskChain, joint_values
from kinematics.kernels import Array, forward

RADIUS, OFFSET, WHOLE, TURNED = 2, 3, 9, 10
"""Columns of the rows: after the carriers of start and end; see :class:`..links.Links`."""


@inner
def link_points(chain: TaskChain, q: Array, links: Array, W: Array) -> None:
    """Compute the joints' axes and origins, the frame's origin, and the ends of the links.

    Everything in base axes, m. Rows 0 to K - 1 of W get axis and origin (and, where a link needs
    it, the x axis in columns 6 to 8), row K the frame's origin in columns 3 to 5, row K + 1 the
    pose, the last L rows start and end of a link in columns 0 to 5.

    Args:
        chain: The chain.
        q: Unknowns, rad and m, shape (n,).
        links: See :class:`~.links.Links`; shape (L, 11).
        W: Workspace, filled.
    """
    if chain.coupling.shape[1] > 0:
        link_points_at(chain, joint_values(chain, q), links, W)
    else:
        link_points_at(chain, q, links, W)


@inner
def link_points_at(chain: TaskChain, q: Array, links: Array, W: Array) -> None:
    """Compute what :func:`link_points` does, at joint values, rad and m, shape (K,)."""
    K, L = len(q), len(links)
    T = W[K + 1]
    trig = W[K + 2 :].reshape(-1)[: 2 * K]
    forward(chain.C, chain.is_revolute, q, trig, W, T)
    W[K, 3], W[K, 4], W[K, 5] = T[3], T[7], T[11]
    turned = False
    for k in range(L):
        turned = turned or links[k, TURNED] != 0.0
    if turned:
        _first_axes(chain, trig, W)
    P = W[len(W) - L :]
    for k in range(L):
        for end in range(2):
            row = int(links[k, end])
            if row < 0:
                for i in range(3):
                    P[k, 3 * end + i] = links[k, OFFSET + 3 * end + i]
                continue
            for i in range(3):
                P[k, 3 * end + i] = W[row, 3 + i]
            if links[k, TURNED] != 0.0:
                zx, zy, zz = W[row, 0], W[row, 1], W[row, 2]
                x, y, z = W[row, 6], W[row, 7], W[row, 8]
                a, b, c = links[k, 3 + 3 * end], links[k, 4 + 3 * end], links[k, 5 + 3 * end]
                P[k, 3 * end] += a * x + b * (zy * z - zz * y) + c * zx
                P[k, 3 * end + 1] += a * y + b * (zz * x - zx * z) + c * zy
                P[k, 3 * end + 2] += a * z + b * (zx * y - zy * x) + c * zz


@jit
def link_ends(chain: TaskChain, Q: Array, links: Array, W: Array, out: Array) -> None:
    """Compute start and end of every link at many configurations.

    Args:
        chain: The chain.
        Q: Unknowns, rad and m, one configuration a row.
        links: See :class:`~.links.Links`; shape (L, 11).
        W: Workspace.
        out: Filled, base axes, m, shape (n, L, 6).
    """
    for i in range(len(Q)):
        link_points(chain, Q[i], links, W)
        for k in range(len(links)):
            for j in range(6):
                out[i, k, j] = W[len(W) - len(links) + k, j]


@inner
def _first_axes(chain: TaskChain, trig: Array, W: Array) -> None:
    """Put the x axis of each joint into columns 6 to 8 of its row, after ``forward``."""
    C, is_revolute, K = chain.C, chain.is_revolute, len(chain.is_revolute)
    x, y, z = np.zeros(3), np.zeros(3), np.zeros(3)
    x[0] = y[1] = z[2] = 1.0
    for k in range(K):
        c = C[k]
        cosine, sine = (trig[K + k], trig[k]) if is_revolute[k] else (1.0, 0.0)
        for i in range(3):
            first = x[i] * c[0] + y[i] * c[4] + z[i] * c[8]
            second = x[i] * c[1] + y[i] * c[5] + z[i] * c[9]
            W[k, 6 + i] = cosine * first + sine * second
        for i in range(3):
            x[i], z[i] = W[k, 6 + i], W[k, i]
        y[0] = z[1] * x[2] - z[2] * x[1]
        y[1] = z[2] * x[0] - z[0] * x[2]
        y[2] = z[0] * x[1] - z[1] * x[0]
