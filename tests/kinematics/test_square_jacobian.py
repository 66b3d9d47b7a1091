"""Determinants and inverses of square Jacobians equal those of NumPy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinematics.square_jacobian import square_jacobian

LEAST = 1e-10


@given(st.integers(1, 6), st.integers(0, 5), st.integers(0, 2**32 - 1))
def test_one_and_many(size, count, seed):
    J = np.random.default_rng(seed).normal(size=(count, size, size) if count else (size, size))
    found = square_jacobian(J)
    np.testing.assert_allclose(found.determinant, np.linalg.det(J), rtol=1e-10, atol=1e-12)
    assert found.invertible.all()
    np.testing.assert_allclose(found.inverse @ J, np.broadcast_to(np.eye(size), J.shape), atol=1e-8)


def test_no_inverse_where_the_rank_is_lost():
    J = np.array([[[1.0, 2.0], [2.0, 4.0]], [[1.0, 0.0], [0.0, 2.0]]])
    found = square_jacobian(J)
    assert found.invertible.tolist() == [False, True]
    np.testing.assert_allclose(found.determinant, [0, 2], atol=1e-15)
    assert not found.inverse[0].any()
    np.testing.assert_allclose(found.inverse[1], [[1, 0], [0, 0.5]])
    assert not square_jacobian(np.zeros((3, 3))).invertible


def test_none_where_it_is_not_square():
    assert square_jacobian(np.zeros((2, 3))) is None
