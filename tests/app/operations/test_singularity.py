"""Singularities, explained, over HTTP."""

import re

import numpy as np
import pytest


def get(client, path, **query):
    answer = client.get(path, params=query)
    assert answer.status_code == 200, answer.text
    return answer.json()


@pytest.mark.scene
def test_puma_factors(client, exercises):
    expected = next(e["value"] for key, e in exercises.items() if key.startswith("E15_"))
    report = get(client, "/v1/robots/puma560/singularity", q="20,-30,100,40,50,60", angle="deg")
    named = report["factorization"]
    for factor in named["factors"]:
        assert factor["value"] == pytest.approx(expected[factor["name"]], abs=1e-9)
        assert not factor["vanishes"]
    assert [factor["joints"] for factor in named["factors"]][2] == ["j4", "j5", "j6"]
    assert named["product"] == pytest.approx(expected["det"], abs=1e-12)
    assert named["exact"]
    assert named["of"] == "determinant"


def test_ellipse_of_the_2r(client, exercises):
    expected = next(e["value"] for key, e in exercises.items() if key.startswith("E3_"))
    report = get(client, "/v1/robots/planar_2r/singularity", q="30,45", task="xy", angle="deg")
    ellipse = report["ellipsoids"]["translation"]
    np.testing.assert_allclose(ellipse["velocity_semi_axes"], expected["sigma"], atol=1e-9)
    np.testing.assert_allclose(
        ellipse["force_semi_axes"], 1 / np.array(expected["sigma"]), atol=1e-8
    )
    x, y, z = ellipse["axes"][0]
    angle = np.rad2deg(np.arctan2(y, x)) % 180
    assert angle == pytest.approx(expected["ellipse_axis1_deg"] % 180, abs=1e-6)
    assert z == 0
    assert report["ellipsoids"]["rotation"] is None


def test_a_singular_report_has_no_numbers_that_are_none(client):
    report = get(client, "/v1/robots/planar_2r/singularity", q="30,0", task="xy", angle="deg")
    assert report["ellipsoids"]["translation"]["force_semi_axes"][1] is None
    assert report["dexterity"]["condition_number"] is None
    assert report["dexterity"]["isotropy"] == 0
    assert report["factorization"]["factors"][0]["vanishes"]
    assert any("cannot move along (0.866025, 0.5, 0)" in text for text in report["explanation"])
    assert any("1 : -2.25" in text for text in report["explanation"])
    text = client.get(
        "/v1/robots/planar_2r/singularity", params={"q": "0,0", "task": "xy", "format": "text"}
    ).text
    assert not re.search(r"\b(nan|inf)\b", text)
    batch = client.post(
        "/v1/robots/planar_2r/singularity", json={"q": [[0.1, 0], [0.1, 0.5]], "task": "xy"}
    ).json()
    assert batch["dexterity"]["condition_number"][0] is None
    assert batch["dexterity"]["condition_number"][1] > 1
    assert [len(texts) for texts in batch["explanation"]] == [2, 0]
    assert batch["factorization"]["factors"][0]["vanishes"] == [True, False]


def test_the_characteristic_length_is_said_or_given(client):
    path, q = "/v1/robots/puma560/singularity", "0,0.5,-1.2,0.1,0.6,0"
    own = get(client, path, q=q)["dexterity"]
    assert own["chosen"] == "mean_lever"
    given = get(client, path, q=q, characteristic_length="300mm")["dexterity"]
    assert given["chosen"] == "given"
    assert given["characteristic_length"] == pytest.approx(0.3)
    same = get(client, path, q=q, characteristic_length=own["characteristic_length"])["dexterity"]
    assert same["condition_number"] == pytest.approx(own["condition_number"])
    bad = client.get(path, params={"q": q, "characteristic_length": "0"})
    assert bad.status_code == 422
    assert bad.json()["errors"][0]["pointer"] == "/characteristic_length"


def test_what_has_no_factors_says_so(client):
    named = get(client, "/v1/robots/panda/singularity", q="0,0,0,-1,0,1,0")["factorization"]
    assert named["structure"] is None
    assert named["factors"] == []
    assert "no factors" in named["reason"]


@pytest.mark.scene
def test_nearest_in_degrees(client):
    path = "/v1/robots/puma560/singularity/nearest"
    answer = get(client, path, q="5,30,-70,20,35,10", angle="deg")
    joints = {row["joint"]: row for row in answer["joints"]}
    assert joints["j5"]["value"] == pytest.approx(0, abs=1e-9)
    assert joints["j5"]["distance"] == pytest.approx(35)
    assert joints["j3"]["value"] == pytest.approx(np.rad2deg(np.arctan2(-0.4318, 0.0203)))
    assert joints["j1"]["value"] is None
    nearest = answer["nearest"]
    assert nearest["distance"] <= joints["j3"]["distance"] + 1e-9
    q = ",".join(map(str, nearest["q"]))
    assert get(client, "/v1/robots/puma560/singularity", q=q, angle="deg")["singular"]
    batch = client.post(path, json={"q": [[0] * 6]})
    assert batch.status_code == 422
    assert batch.json()["errors"][0]["pointer"] == "/q"
    text = client.get(path, params={"q": "0,0.5,-1,0,1,0", "format": "text"}).text
    assert "j5" in text
