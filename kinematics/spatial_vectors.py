"""Twists and wrenches as callers give them: conversion to arrays, and checks of batches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from kinematics.bounds import MAX_VALUE
from kinematics.errors import WrongVector
from robots.robot import FloatArray

WRENCH_ROWS = ("fx", "fy", "fz", "mx", "my", "mz")


def spatial_vector(
    values: ArrayLike, rows: Sequence[str], argument: str, index: Location = ()
) -> FloatArray:
    """Check one twist or wrench, or a batch, and return it as an array.

    Args:
        values: Shape (m,) or (n, m).
        rows: Names of the m entries.
        argument: Name of the argument in errors.
        index: Place of the vector within that argument; its last part then names it in errors.

    Returns:
        A float array of the same shape.

    Raises:
        WrongVector: Wrong shape, not finite, or beyond ±1e6.
    """
    name, listed = (argument, *index)[-1], ", ".join(rows)
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise WrongVector(
            say("{name} is no array of numbers; give {listed}", name=name, listed=listed),
            argument=argument,
            index=index,
            rows=tuple(rows),
        ) from None
    if array.ndim not in (1, 2) or array.shape[-1] != len(rows):
        count = array.shape[-1] if array.ndim else 1
        raise WrongVector(
            say(
                "{name} has {count} values; give {count_2}: {listed}, or a list of such lists",
                name=name,
                count=count,
                count_2=len(rows),
                listed=listed,
            ),
            argument=argument,
            index=index,
            rows=tuple(rows),
            expected=len(rows),
        )
    if array.size and not np.abs(array).max() <= MAX_VALUE:
        first = tuple(int(i) for i in np.argwhere(~(np.abs(array) <= MAX_VALUE))[0])
        value = array[first]
        what = (
            say("not a finite number")
            if not np.isfinite(value)
            else say("{value:g}, beyond ±1e6", value=value)
        )
        raise WrongVector(
            say(
                "{row} of {name} is {what}; give a finite value",
                row=rows[first[-1]],
                name=name,
                what=what,
            ),
            argument=argument,
            index=(*index, *first),
            value=float(value),
            lower=-MAX_VALUE,
            upper=MAX_VALUE,
            rows=tuple(rows),
        )
    return array


def check_same_length(q: FloatArray, other: FloatArray, argument: str) -> None:
    """Refuse two batches of unequal length; one vector goes with every entry of a batch.

    Raises:
        WrongVector: Both are batches, of other lengths.
    """
    if q.ndim == other.ndim == 2 and len(q) != len(other):
        raise WrongVector(
            say(
                "{argument} holds {count} rows for {count_2} of q; give as many, or one",
                argument=argument,
                count=len(other),
                count_2=len(q),
            ),
            argument=argument,
            expected=len(q),
        )
