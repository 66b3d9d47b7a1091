"""A serial chain -> its D-H table in any convention, with the error measured on the chain.

The classical construction, at q = 0: joint axes as lines, their common normals as x axes, frames
at their feet (Denavit and Hartenberg 1955; Spong, Hutchinson and Vidyasagar, section 3.2). Fixed
joints are folded in beforehand. ``z_i = +u_i``, so signs are +1 and q keeps its meaning; the angle
or length at q = 0 becomes the offset. Frame 0 is the base frame where its z is axis 1; the tip's z
stands for axis n + 1; base and tool carry what the rows cannot, so that base to tip is the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from dh_to_urdf.cells.expressions import MAX_MAGNITUDE
from dh_to_urdf.documents.checks import NAME
from dh_to_urdf.errors import DHError
from dh_to_urdf.extraction.arrangement import arrange
from dh_to_urdf.extraction.axes import SerialChain
from dh_to_urdf.extraction.construction import ConstructedPair, construct, tidy_placement
from dh_to_urdf.extraction.conversion import to_convention
from dh_to_urdf.extraction.dependences import with_dependences
from dh_to_urdf.matrices import dh_matrices
from dh_to_urdf.messages import say
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHTable, JointType

SNAP = 1e-8
MAX_SNAP = 0.1
CONFIGURATIONS = 100


@dataclass(frozen=True, slots=True)
class Residual:
    """Largest deviation of a table's tool from the chain's tip, over random q.

    Attributes:
        position: m.
        orientation: rad.
        configurations: Number of q that were compared, q = 0 among them.
    """

    position: float
    orientation: float
    configurations: int


@dataclass(frozen=True)
class PairFinding:
    """What was found of two successive axes, besides the construction.

    Attributes:
        pair: The construction.
        snapped: Tilt that was taken for zero, rad; 0 if none.
        bridged: Tilt for which a fixed row stands before the second axis, rad; 0 if none.
    """

    pair: ConstructedPair
    snapped: float
    bridged: float


@dataclass(frozen=True)
class Extraction:
    """A chain as a D-H table.

    Attributes:
        chain: The chain.
        table: The table, ``base`` to ``tool``.
        residual: How far its FK is from the chain's.
        frame_zero: Frame 0 of the construction in base axes, 4x4.
        findings: One for each pair of successive axes; the last one with the tip's z.
        snap: Tilt below which axes were taken as parallel, rad.
    """

    chain: SerialChain
    table: DHTable
    residual: Residual
    frame_zero: Matrix
    findings: tuple[PairFinding, ...]
    snap: float


WIDE = 100.0
"""Sizes of a chain beyond which limits of slides are taken to stand for none."""


def extract(
    chain: SerialChain,
    convention: Convention,
    *,
    snap: float = SNAP,
    positive_a: bool = False,
    bridge: bool = True,
) -> Extraction:
    """Find the D-H table of a chain.

    Args:
        chain: The chain.
        convention: What to write it in.
        snap: Axes tilted by less than this are taken as parallel, rad, 0 to 0.1.
        positive_a: True for no negative a; False for small offsets.
        bridge: Whether to put a fixed row between nearly parallel axes whose normal is far away.

    Raises:
        DHError: ``snap`` is out of range, or lengths would be beyond what a table may hold.
    """
    if not 0.0 <= snap <= MAX_SNAP:
        raise DHError.single(
            ("snap",),
            say(
                "snap is {snap:g}; give an angle from 0 to {max_snap} rad",
                snap=snap,
                max_snap=MAX_SNAP,
            ),
        )
    size = chain.size
    tip = chain.poses(np.zeros(len(chain.joints)))
    arrangement = arrange(chain.lines(), tip, size, snap, bridge=bridge)
    made = construct(
        arrangement,
        tip,
        size,
        last_at_tip=convention is Convention.STANDARD,
        positive_a=positive_a,
    )
    warnings = [*chain.warnings]
    rows = tuple(pair.row for pair in made.pairs)
    standard = DHTable(chain.name, Convention.STANDARD, rows, made.base, made.tool)
    table = _renamed(to_convention(standard, convention), warnings)
    base, tool = (tidy_placement(T, size) for T in (table.base, table.tool))
    table = replace(table, base=base, tool=tool)
    _check_lengths(table)
    residual = measure(chain, table)
    table = with_dependences(table, chain)
    tilts = zip(arrangement.snapped[1:], arrangement.bridged[1:], strict=True)
    findings = tuple(PairFinding(pair, *tilt) for pair, tilt in zip(made.pairs, tilts, strict=True))
    warnings += _warnings(findings, residual)
    table = replace(table, warnings=tuple(warnings))
    return Extraction(chain, table, residual, made.base, findings, snap)


def measure(chain: SerialChain, table: DHTable, configurations: int = CONFIGURATIONS) -> Residual:
    """Compare the FK of a table with that of a chain, at q = 0 and random q within limits.

    Args:
        chain: The chain.
        table: The table; its moving rows are the joints of the chain, all free.
        configurations: Number of q.

    Returns:
        The largest deviations.
    """
    q = random_configurations(chain, configurations)
    return Residual(*deviation(chain.poses(q), dh_matrices(table, q).T), configurations)


def random_configurations(chain: SerialChain, count: int) -> Matrix:
    """Return q = 0 and random q, shape (count, n), within limits, else ±π and ± the size.

    Of limits wider than a turn, or than :data:`WIDE` sizes, a part of that width around 0 or next
    to it is taken: limits of ±999999 stand for none, and the sines of such angles lose digits.
    """
    lower, upper = [], []
    for joint in chain.joints:
        slides = joint.type is JointType.PRISMATIC
        free = chain.size if slides else math.pi
        most = WIDE * free if slides else free
        low, high = joint.limits.lower, joint.limits.upper
        low, high = -free if low is None else low, free if high is None else high
        if high - low > 2 * most:
            middle = min(max(0.0, low + most), high - most)
            low, high = middle - most, middle + most
        lower.append(low)
        upper.append(high)
    q = np.random.default_rng(0).uniform(lower, upper, (count, len(lower)))
    q[0] = 0.0
    return q


def deviation(first: Matrix, second: Matrix) -> tuple[float, float]:
    """Return the largest distance (m) and angle (rad) between poses, shape (..., 4, 4)."""
    position = np.linalg.norm(first[..., :3, 3] - second[..., :3, 3], axis=-1).max()
    chord = np.linalg.norm(first[..., :3, :3] - second[..., :3, :3], axis=(-2, -1)).max()
    return float(position), 2 * math.asin(min(1.0, float(chord) / math.sqrt(8)))


def _warnings(findings: tuple[PairFinding, ...], residual: Residual) -> list[str]:
    found: list[str] = []
    for finding in findings:
        first, second = finding.pair.first.name, finding.pair.second.name
        last = finding is findings[-1]
        if finding.snapped and not last:
            found.append(
                say(
                    "the axes of {first} and {second} are {snapped:.2g} rad from parallel"
                    " and taken as parallel; the table is off by up to {position:.1e} m and"
                    " {orientation:.1e} rad (a smaller snap keeps the tilt)",
                    first=first,
                    second=second,
                    snapped=finding.snapped,
                    position=residual.position,
                    orientation=residual.orientation,
                )
            )
        if finding.bridged:
            found.append(
                say(
                    "the axis of {second} is {bridged:.2g} rad from parallel to the one"
                    " before, so that their common normal is far away; the fixed row"
                    " {first} stands between. A snap above {bridged:.2g} takes them as"
                    " parallel instead",
                    second=second,
                    bridged=finding.bridged,
                    first=first,
                )
            )
    return found


def _check_lengths(table: DHTable) -> None:
    lengths = [*table.base[:3, 3], *table.tool[:3, 3]]
    for row in table.rows:
        lengths += [row.a, row.d, 0.0 if row.type.is_revolute else row.offset]
    longest = max(map(abs, lengths))
    if longest > MAX_MAGNITUDE:
        raise DHError.single(
            (),
            say(
                "the table would have a length of {longest:.3g} m; check the unit, lengths are m",
                longest=longest,
            ),
        )


def _renamed(table: DHTable, warnings: list[str]) -> DHTable:
    """Rename joints whose names a table document cannot hold."""
    taken: set[str] = set()
    rows = []
    for row in table.rows:
        name = _fit(row.name, "joint")
        while name in taken:
            name = name[:60] + "_"
        taken.add(name)
        if name != row.name:
            warnings.append(
                say("joint {row!r} is called {name!r} in the table", row=row.name[:64], name=name)
            )
        rows.append(replace(row, name=name))
    return DHTable(_fit(table.name, "robot"), table.convention, tuple(rows), table.base, table.tool)


def _fit(name: str, default: str) -> str:
    if NAME.fullmatch(name):
        return name
    kept = "".join(c if c.isalnum() or c in "_ .:+-" else "_" for c in name)
    kept = kept.lstrip(" .:+-")[:60].rstrip(" :") or default
    return kept if NAME.fullmatch(kept) else default
