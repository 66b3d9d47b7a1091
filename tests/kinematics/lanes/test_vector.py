"""Vectors do what floats do, lane by lane; sines, cosines and angles are those of the C library."""

import math

import numba
import numpy as np
import pytest

from kinematics.kernels import sines_and_cosines
from kinematics.lanes.memory import (
    gather,
    lane_memory,
    load,
    past,
    scatter,
    scatter_four,
    spread_out,
    stack_memory,
    start_of,
    store,
)
from kinematics.lanes.trigonometry import angle, angle_over_sine, sine_cosine
from kinematics.lanes.vector import (
    FEW,
    LANES,
    WIDTHS,
    absolute,
    bits,
    eight_lanes,
    first_of,
    floor,
    four_lanes,
    larger,
    mask_of,
    one_lane,
    select,
    smaller,
    splat,
    square_root,
)

jit = numba.njit(error_model="numpy", fastmath={"nsz", "contract"})
SPECIAL = np.array([0.0, 1.0, -1.0, 0.5, -2.5, 1e-300, 1e300, np.inf])
ROWS = 20


@jit
def every_operation(a, b, out, like):
    A, B, O = start_of(a), start_of(b), start_of(out)
    for row in range(a.shape[0]):
        x, y = load(A, row, like), load(B, row, like)
        base = past(O, ROWS * row * out.shape[1])
        store(base, 0, x + y)
        store(base, 1, x - y)
        store(base, 2, x * y)
        store(base, 3, x / y)
        store(base, 4, -x)
        store(base, 5, x + 2.0)
        store(base, 6, 2.0 - x)
        store(base, 7, square_root(absolute(x)))
        store(base, 8, floor(x))
        store(base, 9, larger(x, y))
        store(base, 10, smaller(x, y))
        store(base, 11, select(x < y, x, y))
        store(base, 12, select((x <= y) & (y > 0.0), 1.0, x))
        store(base, 13, select((x >= y) | (x == 0.0), x, -1.0))
        store(base, 14, select(~(x > y), x, splat(7.0, like)))
        store(base, 15, select(mask_of(bits(x < y), like), x, y))
        x += y
        store(base, 16, x)
        x -= 3.0
        store(base, 17, x)
        x *= y
        store(base, 18, x)
        store(base, 19, splat(float(bits(x > 0.0)), like))


def expected(x, y):
    with np.errstate(all="ignore"):
        rows = [
            x + y,
            x - y,
            x * y,
            x / y,
            -x,
            x + 2.0,
            2.0 - x,
            np.sqrt(np.abs(x)),
            np.floor(x),
            np.where(x > y, x, y),
            np.where(x < y, x, y),
            np.where(x < y, x, y),
            np.where((x <= y) & (y > 0.0), 1.0, x),
            np.where((x >= y) | (x == 0.0), x, -1.0),
            np.where(~(x > y), x, 7.0),
            np.where(x < y, x, y),
            x + y,
            (x + y) - 3.0,
            ((x + y) - 3.0) * y,
        ]
        signs = ((x + y - 3.0) * y > 0.0).astype(np.int64)
    width = x.shape[1]
    rows.append(np.repeat((signs << np.arange(width)).sum(axis=1)[:, None], width, 1))
    return np.stack(rows, axis=1).astype(float)


@pytest.mark.parametrize("width", WIDTHS)
def test_every_lane_is_a_float(width):
    rng = np.random.default_rng(0)
    x = rng.normal(size=(400, LANES)) * 10.0 ** rng.integers(-8, 8, (400, LANES))
    x[:16] = rng.choice(SPECIAL, (16, LANES))
    y = np.roll(x, 3, axis=0)
    x, y = x.reshape(-1, width), y.reshape(-1, width)
    out = np.empty((len(x) * ROWS, width))
    {1: on_one, FEW: on_four, LANES: on_eight}[width](x, y, out)
    np.testing.assert_array_equal(out.reshape(len(x), ROWS, width), expected(x, y))


@jit
def on_one(x, y, out):
    every_operation(x, y, out, one_lane())


@jit
def on_four(x, y, out):
    every_operation(x, y, out, four_lanes())


@jit
def on_eight(x, y, out):
    every_operation(x, y, out, eight_lanes())


@jit
def _trigonometry(x, quarters, out, like):
    X, O = start_of(x), start_of(out)
    for row in range(x.shape[0]):
        s, c = sine_cosine(load(X, row, like), quarters)
        base = past(O, 4 * row * out.shape[1])
        store(base, 0, s)
        store(base, 1, c)
        store(base, 2, angle(absolute(s), c))
        store(base, 3, angle_over_sine(absolute(s), c))


@jit
def trigonometry_on_one(x, quarters, out):
    _trigonometry(x, quarters, out, one_lane())


@jit
def trigonometry_on_eight(x, quarters, out):
    _trigonometry(x, quarters, out, eight_lanes())


def angles():
    rng = np.random.default_rng(1)
    turns = np.arange(-40, 40) * math.pi / 4
    near = turns[:, None] + np.array([0.0, 1e-12, -1e-9, 1e-5, 1e-16])
    several = [rng.uniform(-s, s, 800) for s in (1e-8, 1.0, 10.0, 1e3, 1e6)]
    return np.concatenate([near.ravel(), *several]).reshape(-1, LANES)


def test_sines_and_cosines_are_exact_and_the_same_in_every_width():
    x = angles()
    eight, one = np.empty((len(x) * 4, LANES)), np.empty((x.size * 4, 1))
    trigonometry_on_eight(x, 0.0, eight)
    trigonometry_on_one(x.reshape(-1, 1), 0.0, one)
    eight = eight.reshape(-1, 4, LANES).transpose(0, 2, 1).reshape(-1, 4)
    np.testing.assert_array_equal(eight, one.reshape(-1, 4))
    np.testing.assert_allclose(eight[:, 0], np.sin(x.ravel()), rtol=0, atol=2.3e-16)
    np.testing.assert_allclose(eight[:, 1], np.cos(x.ravel()), rtol=0, atol=2.3e-16)
    there = np.arctan2(np.abs(eight[:, 0]), eight[:, 1])
    np.testing.assert_allclose(eight[:, 2], there, rtol=4e-16, atol=4e-16)
    s = np.abs(eight[:, 0])
    factor = np.where(s < 1e-9, 1.0, there / np.where(s < 1e-9, 1.0, s))
    np.testing.assert_allclose(eight[:, 3], factor, rtol=8e-16)


def test_they_are_those_of_one_number_bit_for_bit():
    x = angles().ravel()
    trig, out = np.empty(2 * len(x)), np.empty((len(x) * 4, 1))
    sines_and_cosines(x, trig)
    trigonometry_on_one(x.reshape(-1, 1), 0.0, out)
    np.testing.assert_array_equal(out.reshape(-1, 4)[:, :2].T.ravel(), trig)


@pytest.mark.parametrize("quarters", [-3, -1, 1, 2, 3, 6])
def test_quarter_turns_are_exact(quarters):
    x = angles()
    plain, turned = np.empty((len(x) * 4, LANES)), np.empty((len(x) * 4, LANES))
    trigonometry_on_eight(x, 0.0, plain)
    trigonometry_on_eight(x, float(quarters), turned)
    s, c = plain.reshape(-1, 4, LANES)[:, 0], plain.reshape(-1, 4, LANES)[:, 1]
    s, c = ((s, c), (c, -s), (-s, -c), (-c, s))[quarters % 4]
    np.testing.assert_array_equal(turned.reshape(-1, 4, LANES)[:, 0], s)
    np.testing.assert_array_equal(turned.reshape(-1, 4, LANES)[:, 1], c)


@jit
def across(A, out, room):
    like = eight_lanes()
    for k in range(4):
        store(start_of(room), k, gather(A, 2, k, like))
    M = start_of(room)
    x, y, z, w = load(M, 0, like), load(M, 1, like), load(M, 2, like), load(M, 3, like)
    scatter_four(out, 1, 2, x, y, z, w)
    scatter(out, 1, 0, y)


def test_lanes_are_read_and_written_across_rows():
    A = np.random.default_rng(2).normal(size=(11, 5))
    out, room = np.zeros((10, 7)), np.zeros((4, LANES))
    across(A, out, room)
    wanted = np.zeros((10, 7))
    wanted[1:9, 2:6], wanted[1:9, 0] = A[2:10, :4], A[2:10, 1]
    np.testing.assert_array_equal(room, A[2:10, :4].T)
    np.testing.assert_array_equal(out, wanted)


@jit
def spread(x, step, out, like):
    memory, M = stack_memory(), start_of(out)
    for i in range(len(x)):
        memory[i] = x[i]
    found = spread_out(past(memory, 1), step, like)
    store(M, 0, found)
    return first_of(found)


@jit
def spread_over_four(x, step, out):
    return spread(x, step, out, four_lanes())


@jit
def spread_over_eight(x, step, out):
    return spread(x, step, out, eight_lanes())


@pytest.mark.parametrize("step", [1, 2, 5])
def test_numbers_are_read_at_a_distance(step):
    x = np.random.default_rng(3).normal(size=60)
    for read, width in ((spread_over_four, FEW), (spread_over_eight, LANES)):
        out = np.empty((1, width))
        assert read(x, step, out) == x[1]
        np.testing.assert_array_equal(out[0], x[1 : 1 + step * width : step])


@jit
def address_of_memory(rows):
    memory = lane_memory(rows, LANES)
    return memory.ctypes.data, memory.shape[0], memory.shape[1]


def test_memory_begins_where_a_cache_line_does():
    for rows in range(1, 9):
        address, *shape = address_of_memory(rows)
        assert address % 64 == 0
        assert shape == [rows, LANES]
