"""Answers in the language that a request asks for."""

from __future__ import annotations

import csv
import io
import json

import pytest

from app.operations.compare import COMPARE
from dh_to_urdf import read_csv
from dh_to_urdf.documents.layouts import document

FRENCH = {"Accept-Language": "fr-CA,fr;q=0.9,en;q=0.5"}
FK = "/v1/robots/puma560/fk"


@pytest.mark.parametrize(
    ("accept", "spoken"),
    [
        (None, "en"),
        ("", "en"),
        ("fr", "fr"),
        ("FR-be", "fr"),
        ("de, fr;q=0.2", "fr"),
        ("de", "en"),
        ("en;q=0.3, fr;q=0.4", "fr"),
        ("fr;q=0", "en"),
        ("*, fr;q=0.5", "en"),
        ("fr;q=x", "en"),
        ("fr," * 500, "fr"),
        ("?;=q,;;", "en"),
    ],
)
def test_the_header_chooses(client, accept, spoken):
    headers = {} if accept is None else {"Accept-Language": accept}
    answer = client.get(FK, params={"q": "0,1"}, headers=headers)
    assert answer.status_code == 422
    assert answer.headers["content-language"] == spoken
    assert "Accept-Language" in answer.headers["vary"]
    shown = {"en": "q does not fit the robot", "fr": "q ne convient pas au robot"}
    assert answer.json()["title"] == shown[spoken]


def test_the_query_goes_before_the_header(client):
    answer = client.get(FK, params={"q": "0,1", "lang": "en"}, headers=FRENCH)
    assert answer.json()["title"] == "q does not fit the robot"
    answer = client.get(FK, params={"q": "0,1", "lang": "fr"})
    assert answer.json()["detail"].startswith("q a 2 valeurs, mais le robot a 6 articulations")


def test_an_unknown_language_is_refused_in_one_that_is_spoken(client):
    answer = client.get(FK, params={"q": "0,0,0,0,0,0", "lang": "xx"}, headers=FRENCH)
    assert answer.status_code == 422
    assert answer.json()["errors"] == [
        {"pointer": "/lang", "message": "lang vaut 'xx'\N{NO-BREAK SPACE}; donnez en, fr"}
    ]


def test_fields_and_codes_are_the_same_in_every_language(client):
    body = {"target": {"position": [9, 0, 0]}, "task": "position"}
    english = client.post("/v1/robots/puma560/ik", json=body).json()
    french = client.post("/v1/robots/puma560/ik", json=body, headers=FRENCH).json()
    assert english.keys() == french.keys()
    assert english["status"] == french["status"] == "unreachable"
    assert english["explanation"] != french["explanation"]
    assert "la cible est à" in french["explanation"][0]


def test_explanations_warnings_and_factors_are_in_french(client):
    query = {"q": "0,0,0,0,0,0", "lang": "fr"}
    found = client.get("/v1/robots/puma560/singularity", params=query).json()
    assert any("articulations j4 et j6 tournent" in one for one in found["explanation"])
    assert any("le repère ne peut pas" in one or "torseur" in one for one in found["explanation"])
    assert "conditionnement" in found["warnings"][0]
    factors = found["factorization"]["factors"]
    assert any("axe" in one["vanishes_where"] for one in factors)
    assert "poignet sphérique" in found["factorization"]["structure"]


def test_text_has_french_headings_and_words(client):
    query = {"q": "0,0,0,0,0,0", "lang": "fr", "format": "text"}
    answer = client.get("/v1/robots/puma560/singularity", params=query)
    assert answer.headers["content-language"] == "fr"
    assert "rang\N{NO-BREAK SPACE}: " in answer.text
    assert "singulière\N{NO-BREAK SPACE}: oui" in answer.text
    assert "valeurs singulières" in answer.text
    refused = client.get(FK, params={"q": "1", "lang": "fr", "format": "text"})
    assert refused.text.startswith("422 q ne convient pas au robot\n  /q: q a 1 valeurs")


def test_postures_are_codes_in_json_and_words_in_text(client):
    body = {"target": {"position": [0.5, 0.1, 0.4], "rpy": [0, 3.1, 0]}}
    path = "/v1/robots/puma560/ik/solutions"
    found = client.post(path, json=body, headers=FRENCH).json()
    assert set(found["solutions"][0]["posture"]) <= {
        "front",
        "back",
        "up",
        "down",
        "flip",
        "noflip",
    }
    assert found["description"].startswith("poignet sphérique")
    text = client.post(f"{path}?format=text", json=body, headers=FRENCH).text
    assert "avant" in text
    assert "retourné" in text


def test_warnings_of_forms_without_a_place_are_told_in_the_header(client):
    query = {"q": "0,-3,0,0,0,0", "format": "npy", "lang": "fr"}
    answer = client.get(FK, params=query)
    assert "hors de ses but" in answer.headers["x-warnings"]
    assert answer.headers["content-language"] == "fr"


def test_lines_are_in_french(client):
    targets = {"position": [[9, 0, 0], [8, 0, 0]]}
    body = {"targets": targets, "task": "position", "seed": [0, 90, 0, 0, 0, 0]}
    answer = client.post("/v1/robots/puma560/ik?format=ndjson", json=body, headers=FRENCH)
    assert answer.headers["content-language"] == "fr"
    assert "tours" in answer.headers["x-warnings"]
    assert all(json.loads(line)["status"] for line in answer.text.splitlines())


@pytest.mark.parametrize(
    ("method", "path", "body", "word"),
    [
        ("GET", "/nowhere", None, "il n'y a rien à /nowhere"),
        ("DELETE", FK, None, "n'est pas possible"),
        ("GET", "/v1/robots/none-such", None, "il n'y a pas de robot"),
        ("POST", FK, "{", "le corps de la requête n'est pas du JSON"),
        ("POST", FK, '{"q": "x"}', "donnez une liste de nombres"),
        ("POST", FK, '{"q": [0], "z": 1}', "champ inconnu 'z'"),
        ("POST", FK, '{"q": [0,0,0,0,0,0], "frames": 1}', "est attendu"),
        (
            "PUT",
            "/v1/robots/mine",
            '{"convention": "dh", "joints": []}',
            "joints manque ou est vide",
        ),
    ],
)
def test_refusals_are_in_french(client, method, path, body, word):
    headers = {**FRENCH, "Content-Type": "application/json"}
    answer = client.request(method, path, content=body, headers=headers)
    assert answer.status_code >= 400
    assert word in answer.json()["detail"]
    assert answer.headers["content-language"] == "fr"


def test_kinds_of_problems_are_explained_in_french(client):
    answer = client.get("/problems/invalid-q", headers=FRENCH)
    assert answer.json()["title"] == "q ne convient pas au robot"


def test_closed_forms_have_french_notes(client):
    query = {"quantities": "det_jacobian", "lang": "fr", "task": "position"}
    answer = client.get("/v1/robots/planar_2r/symbolic", params=query).json()
    assert any("donnez une tâche de 2 lignes" in one for one in answer["notes"])
    text = client.get("/v1/robots/planar_2r/symbolic", params={**query, "format": "text"}).text
    assert "convention" in text.splitlines()[0]
    assert any("donnez une tâche" in one for one in text.splitlines())


def test_a_stored_robot_warns_in_both_languages(start_server, tmp_path):
    import httpx

    table = {
        "name": "odd",
        "convention": "standard",
        "joints": [
            {"type": "R", "a": 300, "alpha": 90, "d": 0.1, "theta": 0},
            {"type": "R", "a": 0.2, "alpha": 0, "d": 0, "theta": 0},
        ],
    }
    for _ in range(2):  # after a start, from the file
        with start_server(tmp_path) as (address, _):
            httpx.put(f"{address}/v1/robots/odd", json=table)
            english = httpx.get(f"{address}/v1/robots/odd").json()["warnings"]
            french = httpx.get(f"{address}/v1/robots/odd?lang=fr").json()["warnings"]
        with start_server(tmp_path) as (address, _):
            assert httpx.get(f"{address}/v1/robots/odd").json()["warnings"] == english
            assert httpx.get(f"{address}/v1/robots/odd?lang=fr").json()["warnings"] == french
        assert len(english) == len(french) > 0
        assert not set(english) & set(french)
        assert any("des degrés" in one for one in french)


# A spreadsheet


def rows_of(text: str, delimiter: str) -> list[list[str]]:
    return list(csv.reader(io.StringIO(text), delimiter=delimiter))


COMPARISON = {**COMPARE.example, "methods": ["pseudo_inverse", "qp"]}


def test_csv_has_decimal_commas_on_request(client):
    path = f"/v1/robots/{COMPARE.example_robot}/path/compare"
    plain = client.post(f"{path}?format=csv", json=COMPARISON, headers=FRENCH)
    comma = client.post(f"{path}?format=csv&decimal=comma&lang=fr", json=COMPARISON)
    assert plain.status_code == comma.status_code == 200, plain.text
    english, french = rows_of(plain.text, ","), rows_of(comma.text, ";")
    assert english[0][0] == "name" or "method" in english[0]
    assert "méthode" in french[0] or "nom" in french[0]
    assert len(english[0]) == len(french[0])
    for before, after in zip(english[1:], french[1:], strict=True):
        for name, one, other in zip(english[0], before, after, strict=True):
            if name != "ms_per_point" and "." in one:
                assert other.replace(",", ".") == one
                assert "," in other


@pytest.mark.parametrize(
    ("query", "message"),
    [
        ("format=csv&decimal=x", "decimal is 'x'; give point or comma"),
        ("decimal=comma", "decimal is for format=csv; the other forms have decimal points"),
    ],
)
def test_decimal_is_for_csv(client, query, message):
    answer = client.post(
        f"/v1/robots/{COMPARE.example_robot}/path/compare?{query}", json=COMPARISON
    )
    assert answer.status_code == 422
    assert answer.json()["errors"] == [{"pointer": "/decimal", "message": message}]


@pytest.mark.parametrize("convention", ["standard", "modified", "khalil"])
def test_a_table_goes_to_a_french_spreadsheet_and_back(client, convention):
    query = {"convention": convention, "format": "csv"}
    plain = client.get("/v1/robots/puma560/dh", params=query).text
    french = client.get(
        "/v1/robots/puma560/dh", params={**query, "lang": "fr", "decimal": "comma"}
    ).text
    assert french.startswith("nom;type;")
    assert "rotoïde" in french
    assert "0,4318" in french
    tables = [document(read_csv(text, convention, "x")) for text in (french, plain)]
    assert tables[0] == tables[1]
    url = f"/v1/robots/tableur-{convention}"
    stored = client.put(
        f"{url}?convention={convention}",
        content=french.encode(),
        headers={"Content-Type": "text/csv", **FRENCH},
    )
    assert stored.status_code == 201, stored.text
    poses = [
        client.get(f"{one}/fk", params={"q": "0.1,0.2,0.3,0.4,0.5,0.6"}).json()["poses"]["tool"]
        for one in ("/v1/robots/puma560", url)
    ]
    assert poses[0]["position"] == pytest.approx(poses[1]["position"], abs=1e-12)
    client.delete(url)


def test_a_table_is_explained_in_french(client):
    query = {"convention": "dh", "explain": "true", "lang": "fr", "format": "text", "snap": "0"}
    text = client.get("/v1/robots/ur5/dh", params=query).text
    assert "Comment il a été trouvé" in text
    assert "Le repère 0 est" in text or "le repère 0 est donc un nouveau repère" in text
    assert "résidu" in text
