"""A stranger's robot at every door: one refusal, in one shape, whichever way it comes in."""

import unicodedata

import pytest

from tests.torture.large_urdfs import chain, filled, too_large

GOOD = chain(3)
NO_AXIS = GOOD.replace('xyz="0 1 1"', 'xyz="0 0 0"', 1)
TABLE = {"convention": "dh", "joints": [{"type": "R", "alpha": 0, "a": 1, "d": 0}]}
URDFS = {
    "zero axis": (NO_AXIS.encode(), "invalid-urdf", ("joint 'j1'", "axis is zero")),
    "utf-16 doctype": (
        "<!DOCTYPE r>".encode("utf-16") + GOOD.encode("utf-16-le"),
        "invalid-urdf",
        ("DOCTYPE",),
    ),
    "nul": (GOOD.encode() + b"\x00", "invalid-urdf", ("U+0000",)),
    "cut": (GOOD.encode()[:300], "invalid-urdf", ("line 1, column",)),
    "direction": (GOOD.replace("l1", "l\u202e1").encode(), "invalid-urdf", ("cannot be seen",)),
    "attributes": (too_large()["attributes"][0].encode(), "robot-too-large", ("at most 32",)),
    "elements": (filled(GOOD, "<a/>", 1_000_000).encode(), "robot-too-large", ("at most 20000",)),
    "joints": (chain(66, moving=65).encode(), "robot-too-large", ("65 joints; at most 64",)),
}


def check(answer, slug, pointer, words):
    assert answer.status_code == 422, answer.text
    problem = answer.json()
    assert answer.headers["content-type"] == "application/problem+json"
    assert problem["type"] == f"/problems/{slug}"
    assert len(answer.content) <= 4096
    (error,) = problem["errors"]
    assert error["pointer"] == pointer
    assert [word for word in words if word not in error["message"]] == []
    assert not any(unicodedata.category(c) in ("Cc", "Cf") for c in answer.text)


@pytest.mark.parametrize("name", URDFS)
def test_a_bad_urdf_is_refused_at_every_door(client, name):
    body, slug, words = URDFS[name]
    xml = {"headers": {"Content-Type": "application/xml"}, "content": body}
    for answer in (
        client.post("/v1/robots?name=gate", **xml),
        client.put("/v1/robots/gate", **xml),
        client.post("/v1/urdf-to-dh?convention=standard", **xml),
    ):
        check(answer, slug, "", words)
    try:
        text = body.decode()
    except UnicodeDecodeError:
        text = body.decode("utf-16")
    inline = {"urdf": text}
    check(client.post("/v1/fk", json={"robot": inline, "q": [0]}), slug, "/robot/urdf", words)
    diff = client.post("/v1/diff", json={"robot": "ur5", "other": inline})
    check(diff, slug, "/other/urdf", words)
    assert client.get("/v1/robots/gate").status_code == 404


@pytest.mark.parametrize(
    ("robot", "slug", "pointer", "words"),
    [
        ({"urdf": GOOD, "tip": "l9"}, "unknown-frame", "/tip", ("'l9' is unknown",)),
        ({"urdf": GOOD, "base": "b\nc"}, "unknown-frame", "/base", (r"'b\nc' is unknown",)),
        ({"urdf": GOOD, "x" * 500: "1"}, "invalid-table", f"/{'x' * 64}", ("give urdf",)),
        ({**TABLE, "joints": TABLE["joints"] * 65}, "robot-too-large", "", ("65 joints",)),
        (
            {**TABLE, "joints": [{**TABLE["joints"][0], "type": "F", "theta": 0}]},
            "invalid-urdf",
            "/joints",
            ("no joint that moves",),
        ),
        ({**TABLE, "e\u202evil": 1}, "invalid-table", "/e?vil", ("unknown field",)),
    ],
)
def test_a_bad_robot_in_a_body_is_pointed_at(client, robot, slug, pointer, words):
    asked = client.post("/v1/fk", json={"robot": robot, "q": [0]})
    check(asked, slug, f"/robot{pointer}", words)
    other = client.post("/v1/diff", json={"robot": "ur5", "other": robot})
    check(other, slug, f"/other{pointer}", words)


def test_what_is_served_is_the_canonical_text(client):
    mesh = '<visual><geometry><mesh filename="FILE"/></geometry></visual>'
    text = chain(
        3, inside=mesh.replace("FILE", "file:///etc/passwd") + mesh.replace("FILE", "a.stl")
    )
    text = text.replace("</robot>", "<gazebo><plugin filename='evil.so'/></gazebo></robot>")
    answer = client.post(
        "/v1/robots?name=gate-served", content=text, headers={"Content-Type": "application/xml"}
    )
    assert answer.status_code == 201
    assert len(answer.json()["warnings"]) == 2
    served = client.get("/v1/robots/gate-served/urdf").text
    assert 'filename="a.stl"' in served
    assert "passwd" not in served
    assert "evil" not in served
    assert client.delete("/v1/robots/gate-served").status_code == 204
