"""Queries at the edges."""

import pytest

from tests.app.http.requests import FK, check


@pytest.mark.parametrize(
    ("query", "pointer"),
    [
        ("q=0,0&q=0,0", "/q"),
        ("q=0,0&x=1", "/x"),
        ("q=", "/q"),
        ("q=0,", "/q"),
        ("q=%zz,0", "/q"),
        ("q=%00,0", "/q"),
        ("q=%ff,0", "/q"),
        ("q=nan,0", "/q"),
        ("q=1e400,0", "/q"),
        ("q=1_0,0", "/q"),
        ("q=%D9%A3,0", "/q"),
        ("q=%EF%BC%91,0", "/q"),
        ("q=]0,0[", "/q"),
        ("q=1e+1,0", "/q"),
        ("q=" + "0," * 2000 + "0", "/q"),
        ("q=0,0&euler=", "/euler"),
        ("q=0,0&frames=", "/frames"),
        ("q=0,0&frames=tool,,tool", "/frames"),
        ("q=0,0&angle=", "/angle"),
        ("q=0,0&format=", "/format"),
        ("", "/q"),
    ],
)
def test_queries_that_say_something_else(client, query, pointer):
    check(client.get(f"{FK}?{query}"), 422, pointer)


def test_queries_that_are_too_long(client):
    many = "&".join(f"x{k}=1" for k in range(20_000))
    check(client.get(f"{FK}?{many[:60_000]}"), 414, "", "POST")
    check(client.get("/v1/" + "a" * 5000), 414, "")


@pytest.mark.parametrize("size", ["0", "1001", "-1", "1e3", "%D9%A3", "", "1" * 400, "+1"])
def test_page_sizes(client, size):
    check(client.get(f"/v1/robots?page_size={size}"), 422, "/page_size")
