"""Legends: below the curves, never over each other, and equal curves told apart.

Widths are those of the font in which PNG is drawn, as fontTools reads it.
"""

from __future__ import annotations

import math
import re
from functools import cache
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from fontTools.ttLib import TTFont
from hypothesis import given
from hypothesis import strategies as st

from app.pictures.canvas import COLORS, Canvas
from app.pictures.chart import Chart, draw_chart
from app.pictures.curves import Curve, Level
from app.pictures.lettering import fitted, width_of

SVG = "{http://www.w3.org/2000/svg}"
X = np.linspace(0, 2, 50)
CHART = (10.0, 20.0, 400.0)


@cache
def font(bold):
    return TTFont(f"app/pictures/fonts/DejaVuSans{'-Bold' if bold else ''}.ttf")


def real_width(text, size, bold=False):
    of = font(bold)
    glyphs, advances = of.getBestCmap(), of["hmtx"]
    units = [advances[glyphs[ord(one)]][0] if ord(one) in glyphs else 2048 for one in text]
    return size * sum(units) / of["head"].unitsPerEm


def box_of(text):
    """x, y, width and height of a text that is not turned."""
    size = float(text.get("font-size"))
    width = real_width(text.text or "", size, text.get("font-weight") == "bold")
    x, y = float(text.get("x")), float(text.get("y"))
    x -= {"start": 0, "middle": width / 2, "end": width}[text.get("text-anchor")]
    return x, y - 0.8 * size, width, size


def overlap(one, other):
    return all(
        one[k] < other[k] + other[k + 2] - 0.01 and other[k] < one[k] + one[k + 2] - 0.01
        for k in (0, 1)
    )


def drawn(curves, levels=(), log=False):
    chart = Chart(curves, "title", "t [s]", log, levels)
    height = chart.height(CHART[2], 200.0)
    canvas = Canvas(420, height + 40, "picture")
    draw_chart(canvas, (*CHART, height), chart)
    return ET.fromstring(canvas.render())


def points(line):
    return np.array([pair.split(",") for pair in line.get("points").split()], dtype=float)


def assert_apart(root):
    """No text lies over another, none of the legend in the chart, all on the picture."""
    texts = [(one.text, box_of(one)) for one in root.iter(f"{SVG}text") if one.text]
    _, _, width, height = map(float, root.get("viewBox").split())
    for k, (text, box) in enumerate(texts):
        assert box[0] >= 0, text
        assert box[0] + box[2] <= width + 0.01, text
        assert box[1] + box[3] <= height, text
        assert not [other for other, place in texts[:k] if overlap(box, place)], text
    frames = [points(one) for one in root.iter(f"{SVG}polygon")]
    inside = [(*p.min(axis=0), *np.ptp(p, axis=0)) for p in frames if len(p) == 4]
    for text, box in texts:
        assert not any(overlap(box, frame) for frame in inside), text
    for line in root.iter(f"{SVG}polyline"):
        p = points(line)
        if len(p) == 2 and line.get("stroke-width") == "2":
            swatch = (*(p.min(axis=0) - [0, 1]), np.ptp(p[:, 0]), 2)
            assert not [text for text, box in texts if overlap(box, swatch)]
            assert not any(overlap(swatch, frame) for frame in inside)


def curve(label, y, k=0):
    return Curve(label, X, np.broadcast_to(np.asarray(y, float), X.shape), COLORS[k % len(COLORS)])


@given(
    st.lists(
        st.text("abcxyzABCXYZW_0123456789 .:+-éθ关", max_size=64).map(str.strip),
        min_size=1,
        max_size=40,
    ),
    st.integers(0, 3),
    st.booleans(),
)
def test_any_names_stand_apart(names, levels, log):
    curves = [curve(name, np.sin(X + (k // 2)) + 2, k) for k, name in enumerate(names)]
    assert_apart(drawn(curves, [Level(0.5 + k, f"level {k}") for k in range(levels)], log))


def legend(root):
    low = max(points(one)[:, 1].max() for one in root.iter(f"{SVG}polygon"))
    return [
        one.text
        for one in root.iter(f"{SVG}text")
        if one.get("font-size") == "9" and float(one.get("y")) > low
    ]


@pytest.mark.scene
def test_equal_curves_are_named_together_and_both_seen():
    root = drawn([curve("q1", X, 0), curve("q2", X**2, 1), curve("q3", X, 2)])
    assert legend(root) == ["q1 = q3", "q2"]
    lines = [one for one in root.iter(f"{SVG}polyline") if one.get("stroke-width") == "1.5"]
    dashes = {
        one.get("stroke"): (one.get("stroke-dasharray"), float(one.get("stroke-dashoffset", 0)))
        for one in lines
    }
    assert dashes[COLORS[1]] == (None, 0)
    (first, start), (second, later) = dashes[COLORS[0]], dashes[COLORS[2]]
    on, off = map(float, first.split())
    assert (first, off) == (second, on)
    assert {start % (on + off), later % (on + off)} == {0, on}


def test_curves_that_nobody_tells_apart_are_about_equal():
    near = [curve("a", X), curve("b", X + 1e-5, 1), curve("c", X + 0.1, 2)]
    assert legend(drawn(near)) == ["a ≈ b", "c"]


def test_a_group_wider_than_the_chart_goes_on_in_the_next_entry():
    root = drawn([curve(f"a_long_name_of_joint_{k}", X, k) for k in range(6)])
    texts = legend(root)
    assert len(texts) > 1
    assert texts[1].startswith("= ")
    assert " ".join(texts).count("a_long_name_of_joint") == 6
    assert_apart(root)


def test_curves_of_one_colour_have_dashes():
    root = drawn([curve(f"j{k}", np.sin(X + k), k) for k in range(20)])
    styles = [
        (one.get("stroke"), one.get("stroke-dasharray"))
        for one in root.iter(f"{SVG}polyline")
        if one.get("stroke-width") == "1.5"
    ]
    assert len(set(styles)) == 20


@given(st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=80), st.booleans())
def test_widths_are_those_of_the_font(text, bold):
    assert width_of(text, 10, bold=bold) == pytest.approx(real_width(text, 10, bold), abs=0.6)
    assert width_of(fitted(text, 60, 10, bold=bold), 10, bold=bold) <= 60


@pytest.mark.scene
@pytest.mark.parametrize("robot", ["planar_8r", "panda"])
def test_pictures_of_one_path_and_of_many(client, robot):
    dof = 8 if robot == "planar_8r" else 7
    q = [109, -14, -26, -29, -29, -20, 0, 11] if dof == 8 else [17, 23, 0, -92, 0, 109, 34]
    body = {"q": q, "samples": 21, "tolerance": {"position": 1e-3}}
    body |= (
        {"target": {"position": [1.15, -0.15]}, "task": "xy"}
        if dof == 8
        else {"target": {"position": [0.45, 0.3, 0.5], "rpy": [180, 0, 0]}}
    )
    body["obstacles"] = [{"type": "sphere", "center": [0.9, 0.9, 0.4], "radius": 0.05}]
    path = f"/v1/robots/{robot}/path"
    one = client.post(f"{path}?format=svg&angle=deg", json=body)
    label = "the very same program, under a long name that has no room"
    methods = ["qp", {"method": "qp", "label": label}, "damped"]
    many = client.post(f"{path}/compare?format=svg&angle=deg", json={**body, "methods": methods})
    for answer, titles in (
        (one, {"joints [deg]", "clearance [m]", "position error [m]"}),
        (many, {"clearance [m]", "position error [m]", "‖Δq‖ of a sample [deg]"}),
    ):
        assert answer.status_code == 200, answer.text
        root = ET.fromstring(answer.text)
        texts = {text.text for text in root.iter(f"{SVG}text")}
        assert titles <= texts
        assert any(text.startswith("manipulability") for text in texts if text)
        assert ("orientation error [deg]" in texts) == (dof == 7)
        shown = [one for one in root.iter(f"{SVG}text") if one.text and not one.get("transform")]
        boxes = [(one.text, box_of(one)) for one in shown if one.get("font-size") in ("9", "12")]
        for k, (text, box) in enumerate(boxes):
            assert not [other for other, place in boxes[:k] if overlap(box, place)], text
    assert any(text.startswith("qp = ") for text in texts if text)


def test_joints_are_drawn_in_degrees(client):
    """The numbers on the axis are those of degrees."""
    body = {"q": [90, 0, 0], "target": {"position": [0.2, 1]}, "task": "xy", "samples": 11}
    shown = {}
    for angle in ("deg", "rad"):
        q = body["q"] if angle == "deg" else np.radians(body["q"]).tolist()
        url = f"/v1/robots/planar_3r/path?format=svg&angle={angle}"
        root = ET.fromstring(client.post(url, json={**body, "q": q}).text)
        numbers = [t.text for t in root.iter(f"{SVG}text") if t.get("text-anchor") == "end"]
        shown[angle] = max(abs(float(n)) for n in numbers if re.fullmatch(r"-?[\d.]+", n))
    assert shown["deg"] > 20
    assert shown["rad"] < math.pi
