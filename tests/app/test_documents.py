"""SYMORO files and pasted tables over HTTP, in and out."""

from pathlib import Path

import numpy as np
import pytest

PAR = (Path(__file__).parents[1] / "fixtures" / "par" / "rx90.par").read_text()
SR400 = (Path(__file__).parents[1] / "fixtures" / "par" / "sr400.par").read_text()
LATEX = r"""\begin{tabular}{ccccc}
$i$ & $\alpha_i$ & $a_i$ & $d_i$ & $\theta_i$ \\ \hline
1 & 90 & 0 & 0{,}4 & $\theta_1$ \\
2 & 0 & $l_2$ & 0 & $\theta_2 - \frac{\pi}{2}$ \\
\end{tabular}"""
SYMORO = {"Content-Type": "text/x-symoro"}
PASTED = {"Content-Type": "text/plain; charset=utf-8"}
Q = [0.1, -0.4, 1.2, 0.3, -0.5, 2.0]


@pytest.fixture
def made(client):
    """Ids of robots to delete afterwards."""
    ids = []
    yield ids
    for robot_id in ids:
        client.delete(f"/v1/robots/{robot_id}")


def tip(client, robot_id, q):
    answer = client.post(f"/v1/robots/{robot_id}/fk", json={"q": q})
    return np.array(answer.json()["poses"]["tool"]["matrix"])


def test_a_par_file_is_a_robot_and_comes_back(client, made):
    answer = client.post("/v1/robots?values=D3:0.45,RL4:450mm", content=PAR, headers=SYMORO)
    assert answer.status_code == 201, answer.text
    made.append(answer.json()["id"])
    assert (answer.json()["id"], answer.json()["convention"]) == ("RX90", "khalil")
    assert np.abs(tip(client, "RX90", Q) - tip(client, "rx90", Q)).max() < 1e-12
    for ask in ({"params": {"format": "par"}}, {"headers": {"Accept": "text/x-symoro"}}):
        written = client.get("/v1/robots/RX90/dh", **ask)
        assert written.headers["content-type"] == "text/x-symoro; charset=utf-8"
        assert "Robotname = 'RX90'" in written.text
    again = client.put("/v1/robots/copy?name=copy", content=written.content, headers=SYMORO)
    made.append("copy")
    assert again.status_code == 201, again.text
    assert np.abs(tip(client, "copy", Q) - tip(client, "rx90", Q)).max() < 1e-12


@pytest.mark.scene
def test_a_pasted_table_is_a_robot_and_comes_back_in_every_form(client, made):
    query = "?convention=standard&name=pasted&angle=deg&values=l2:0.3"
    answer = client.post(f"/v1/robots{query}", content=LATEX.encode(), headers=PASTED)
    assert answer.status_code == 201, answer.text
    made.append("pasted")
    expected = tip(client, "pasted", [0.3, 0.4])
    assert expected[:3, 3] == pytest.approx(
        [0.3 * np.cos(0.3) * np.sin(0.4), 0.3 * np.sin(0.3) * np.sin(0.4), 0.4 - 0.3 * np.cos(0.4)],
        abs=1e-12,
    )
    for form in ("latex", "markdown", "tsv", "matlab"):
        written = client.get(f"/v1/robots/pasted/dh?format={form}")
        kind = written.headers["content-type"]
        query = "?convention=standard&name=pasted"
        again = client.put(
            f"/v1/robots/pasted{query}", content=written.content, headers={"Content-Type": kind}
        )
        assert again.status_code == 200, again.text
        assert np.abs(tip(client, "pasted", [0.3, 0.4]) - expected).max() < 1e-12


@pytest.mark.parametrize(
    ("query", "headers", "body", "status", "words"),
    [
        ("", SYMORO, PAR, 422, ("joint 3: d is 'D3'", "give values D3:0.5")),
        ("?values=D3", SYMORO, PAR, 422, ("write values as D3:0.45",)),
        ("?values=D3:1,RL4:1,X:2", SYMORO, PAR, 422, ("X", "no constant")),
        ("?values=D3:1,D3:2", SYMORO, PAR, 422, ("'D3' twice",)),
        ("?loops=yes", SYMORO, PAR, 422, ("loops is 'yes'", "cut")),
        ("?convention=khalil", SYMORO, PAR, 422, ("'convention' is unknown",)),
        ("", SYMORO, SR400, 422, ("1 closed loop", "loops=cut")),
        ("", SYMORO, "hello", 400, ("line 1", "'hello'")),
        ("?name=a", PASTED, LATEX, 422, ("convention is missing",)),
        ("?convention=dh", PASTED, "|a|alpha|d|theta|\n|0|0|0|q1|", 422, ("name is missing",)),
        ("?convention=dh&name=a", PASTED, LATEX, 422, ("line 3", "$\\alpha_i$", "angle=deg")),
        ("?convention=dh&name=a&angle=grad", PASTED, LATEX, 422, ("grad",)),
        ("?convention=dh&name=a&length=km", PASTED, LATEX, 422, ("km",)),
        ("?convention=dh&name=a&columns=a,b,x", PASTED, "0 0 0", 422, ("columns", "'x'")),
        ("?convention=dh&name=a", PASTED, "(" * 1000, 422, ("names no columns",)),
    ],
)
def test_what_cannot_be_read_is_refused_with_a_remedy(client, query, headers, body, status, words):
    answer = client.post(f"/v1/robots{query}", content=body.encode(), headers=headers)
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert [word for word in words if word not in answer.json()["detail"]] == []


def test_loops_are_cut_on_request(client):
    query = "?loops=cut&values=d2:0.3,d3:0.8,d4:0.14,d8:0.5,RL4:1"
    answer = client.post(f"/v1/dh-to-urdf{query}", content=SR400.encode(), headers=SYMORO)
    assert answer.status_code == 200, answer.text
    assert answer.text.count('type="continuous"') == 8


def test_a_standard_table_says_how_to_get_a_par_file(client):
    answer = client.get("/v1/robots/puma560/dh?format=par")
    assert answer.status_code == 422
    assert "convert it to khalil or modified first" in answer.json()["detail"]


def test_a_robot_that_takes_no_such_form_says_which(client):
    answer = client.get("/v1/robots/puma560/dh?format=npy")
    assert "json, text, yaml, csv, par, latex, markdown, tsv, matlab" in answer.json()["detail"]
    answer = client.get("/v1/robots/puma560?format=par")
    assert answer.status_code == 422
    assert "json, text" in answer.json()["detail"]


def test_inline_tables_have_values_for_names(client):
    table = {
        "convention": "standard",
        "values": {"L1": 0.5, "L2": "2*L1"},
        "joints": [
            {"type": "R", "alpha": 0, "a": "L1", "d": 0},
            {"type": "R", "alpha": 0, "a": "L2", "d": 0},
        ],
    }
    answer = client.post("/v1/fk", json={"robot": table, "q": [0, 0]})
    assert answer.json()["poses"]["tool"]["position"] == [1.5, 0, 0]
    table["values"]["L3"] = 1
    answer = client.post("/v1/fk", json={"robot": table, "q": [0, 0]})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/robot/values/L3"
