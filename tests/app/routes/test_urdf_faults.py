"""URDFs from the field over HTTP: forgiven where they only draw, else every fault at once."""

import pytest

from tests.robots.urdf.test_faults import THIRTEEN, TOLD

XML = {"content-type": "application/xml"}
JOINT = (
    '<joint name="j" type="revolute"><parent link="b"/><child link="c"/>'
    '<origin xyz="0 0 1" rpy="0 0 0"/><axis xyz="0 0 1"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
)
PLAIN = f'<?xml version="1.0"?>\n<robot name="r"><link name="b"/><link name="c"/>{JOINT}</robot>'
MATERIALS = "".join(f'<material name="m{k}"><color rgba="{k} 0 0 1"/></material>' for k in (0, 1))


def visual(inside):
    return f'<link name="b"><visual><geometry>{inside}</geometry></visual></link>'


FIELD = {
    "two materials": (
        '<link name="b"/>',
        visual('<box size="1 1 1"/>').replace("</visual>", f"{MATERIALS}</visual>"),
        "2 materials",
    ),
    "plane": ('<link name="b"/>', visual('<plane normal="0 0 1"/>'), "<plane>"),
    "cdf": ('<link name="b"/>', visual('<cdf filename="a"/>'), "<cdf>"),
    "one scale": ('<link name="b"/>', visual('<mesh filename="a.stl" scale="1"/>'), "one scale"),
    "axis with rpy": ("<axis xyz", '<axis rpy="0 0 0" xyz', "'rpy' of <axis>"),
    "stray text": ('<link name="c"/>', '<link name="c"/>\n-\n', "stray text '-'"),
    "mass only": (
        '<link name="b"/>',
        '<link name="b"><inertial><mass value="1"/></inertial></link>',
        "incomplete",
    ),
    "undeclared prefix": ('velocity="1"', 'velocity="1" drake:acceleration="5"', "drake:"),
    "floating root": (
        '<link name="b"/>',
        '<link name="world"/><joint name="root" type="floating"><parent link="world"/>'
        '<child link="b"/></joint><link name="b"/>',
        "link 'b' is taken as the base",
    ),
}


@pytest.mark.parametrize("name", FIELD)
def test_a_fault_that_kinematics_need_not_mind_is_a_warning(client, name):
    old, new, words = FIELD[name]
    body = {"robot": {"urdf": PLAIN.replace(old, new, 1)}, "q": [0.3]}
    answer = client.post("/v1/fk", json=body)
    assert answer.status_code == 200, answer.text
    expected = client.post("/v1/fk", json={"robot": {"urdf": PLAIN}, "q": [0.3]}).json()
    assert answer.json() | {"warnings": []} == expected | {"warnings": []}
    uploaded = client.put("/v1/robots/field", content=PLAIN.replace(old, new, 1), headers=XML)
    try:
        assert uploaded.status_code == 201, uploaded.text
        assert any(words in warning for warning in uploaded.json()["warnings"])
    finally:
        client.delete("/v1/robots/field")
    table = client.post(
        "/v1/urdf-to-dh?convention=standard", content=PLAIN.replace(old, new, 1), headers=XML
    )
    assert table.status_code == 200, table.text
    assert any(words in warning for warning in table.json()["warnings"])


def test_tables_of_a_urdf_tell_what_is_doubtful_in_it(client):
    """In the forms that hold no warnings they are in a header."""
    text = PLAIN.replace('rpy="0 0 0"', 'rpy="90 0 0"')
    words = "roll of joint 'j' is 90 rad, which is 14 turns"
    given = client.post("/v1/urdf-to-dh?convention=standard", content=text, headers=XML)
    assert [one for one in given.json()["warnings"] if words in one]
    csv = client.post("/v1/urdf-to-dh?convention=standard&format=csv", content=text, headers=XML)
    assert words in csv.headers["x-warnings"]
    client.put("/v1/robots/field", content=text, headers=XML)
    try:
        stored = client.get("/v1/robots/field/dh?convention=standard").json()["warnings"]
        assert [one for one in stored if words in one]
    finally:
        client.delete("/v1/robots/field")


def test_one_answer_tells_every_fault_with_line_and_element(client):
    answer = client.post("/v1/robots", content=THIRTEEN, headers=XML)
    problem = answer.json()
    assert answer.status_code == 422
    assert problem["type"].endswith("/invalid-urdf")
    shown = [(one["line"], one["xpath"]) for one in problem["errors"]]
    assert shown == [(line, xpath) for line, xpath, _ in TOLD[:10]]
    assert all(one["pointer"] == "" for one in problem["errors"])
    assert problem["more_errors"] == len(TOLD) - 10
    assert problem["detail"].endswith("(and 11 more)")
    assert len(answer.content) <= 4096


def test_faults_of_a_urdf_in_a_body_are_told_likewise(client):
    answer = client.post("/v1/fk", json={"robot": {"urdf": THIRTEEN}, "q": [0]})
    (first, *rest) = answer.json()["errors"]
    assert first["pointer"] == "/robot/urdf"
    assert (first["line"], first["xpath"]) == TOLD[0][:2]
    assert len(rest) == 9


def test_as_text_every_fault_is_a_line(client):
    answer = client.post("/v1/robots", content=THIRTEEN, headers=XML | {"accept": "text/plain"})
    lines = answer.text.splitlines()
    assert lines[0].startswith("422 ")
    assert lines[1].startswith("  line 6: joint 'j1': its axis is zero")
    assert lines[11:12] == ["  … +2"]


def test_xacro_is_never_evaluated_and_said_so(client):
    text = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arm prefix="${p}"/>'
    for xacro in (f"{text}</robot>", f"{text.replace(' xmlns:xacro=', ' x=')}</robot>"):
        answer = client.post("/v1/robots", content=xacro, headers=XML)
        assert answer.status_code == 422
        (error,) = answer.json()["errors"]
        assert "xacro is never evaluated by the service" in error["message"]
        assert "on your machine" in error["message"]
        assert "denavit push" in error["message"]


def test_limits_of_acceleration_time_a_path(client):
    text = PLAIN.replace('velocity="1"', 'velocity="1" acceleration="5" jerk="9"')
    uploaded = client.put("/v1/robots/field", content=text, headers=XML)
    try:
        (joint,) = uploaded.json()["joints"]
        assert (joint["acceleration"], joint["jerk"]) == (5.0, 9.0)
        degrees = client.get("/v1/robots/field?angle=deg").json()["joints"][0]
        assert degrees["acceleration"] == pytest.approx(286.478897565412)
    finally:
        client.delete("/v1/robots/field")
