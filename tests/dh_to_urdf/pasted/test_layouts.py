"""Pasted layouts from a generator: none is misread, and what is refused says what to write."""

import re

import numpy as np
import pytest

from dh_to_urdf import DHError, JointType, dh_matrices, read_pasted
from tests.dh_to_urdf.conftest import shift, turn
from tests.dh_to_urdf.pasted.layouts import FORMS, layout

COUNT = 300
LEAST_READ = 0.9


def expected(rows, q):
    T, k = np.eye(4), 0
    for type_, alpha, a, d, theta in rows:
        if type_ == "R":
            theta, k = theta + q[k], k + 1
        elif type_ == "P":
            d, k = d + q[k], k + 1
        T = T @ turn("z", theta) @ shift(0, 0, d) @ shift(a, 0, 0) @ turn("x", alpha)
    return T


def read(text, query):
    return read_pasted(
        text,
        query.get("convention"),
        angle=query.get("angle"),
        length=query.get("length"),
        columns=query.get("columns"),
    )


def assert_right(table, found):
    moving = sum(row[0] != "F" for row in found.rows)
    assert sum(row.type is not JointType.FIXED for row in table.rows) == moving, found.text
    for q in np.random.default_rng(0).uniform(-1.5, 1.5, (3, moving)):
        assert np.allclose(dh_matrices(table, q).T, expected(found.rows, q), atol=1e-9), found.text


def followed(message, text, query):
    """Return the request that a refusal asks for, from its words and what a user knows."""
    given = re.search(r"give (convention|angle|length)=(\w+)", message)
    if given:
        return text, {**query, given[1]: given[2]}
    if "columns=theta,d,a,alpha" in message and "hidden columns" in query:
        return text, {**query, "columns": query["hidden columns"]}
    raise AssertionError(f"no remedy to follow: {message}\n{text}")


def test_layouts_are_read_right_or_refused_with_a_remedy_that_works():
    refused = 0
    for seed in range(COUNT):
        found = layout(seed)
        try:
            table = read(found.text, found.query)
        except DHError as error:
            refused += 1
            text, query = followed(str(error), found.text, found.query)
            table = read(text, query)
        assert_right(table, found)
    assert refused <= COUNT * (1 - LEAST_READ)


@pytest.mark.parametrize("kind", sorted(FORMS))
def test_every_form_is_among_the_layouts(kind):
    assert sum(layout(seed).kind == kind for seed in range(COUNT)) >= 5
