"""Independent reference robots, through HTTP: table in, every frame, tip and Jacobian out."""

import json
from pathlib import Path

import numpy as np
import pytest

FIXTURES = Path(__file__).parents[1] / "fixtures"
NAMES = [
    robot["name"] for robot in json.loads((FIXTURES / "rtb_oracle.json").read_text())["robots"]
]


@pytest.mark.parametrize("name", NAMES)
def test_frames_tip_and_jacobian_equal_the_oracle(client, oracle_documents, name):
    robot, document = next(pair for pair in oracle_documents if pair[0]["name"] == name)
    path = f"/v1/robots/{document['name']}"
    assert client.put(path, json=document).status_code in (200, 201)
    for configuration in robot["configs"]:
        q = configuration["q"]
        fk = client.post(f"{path}/fk", json={"q": q, "frames": "all"}).json()
        tip = np.array(fk["poses"]["tool"]["matrix"])
        np.testing.assert_allclose(tip, configuration["fkine"], atol=1e-12, rtol=0)
        for k, expected in enumerate(configuration["fkine_all"]):
            frame = np.array(fk["poses"][f"frame_{k}"]["matrix"])
            np.testing.assert_allclose(frame, expected, atol=1e-12, rtol=0)
        J = client.post(f"{path}/jacobian", json={"q": q}).json()["jacobian"]
        np.testing.assert_allclose(J, configuration["jacob0"], atol=1e-12, rtol=0)
        T = client.post("/v1/dh-matrices", json={"robot": document, "q": q}).json()["T"]
        np.testing.assert_allclose(T, configuration["fkine"], atol=1e-12, rtol=0)


TYPES = ["revolute", "prismatic", "continuous", "fixed"]


def elementary(axis, angle=0.0, length=0.0):
    """Rotation about and translation along one axis, from the definitions."""
    T = np.eye(4)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    T[i, i] = T[j, j] = np.cos(angle)
    T[j, i], T[i, j] = np.sin(angle), -np.sin(angle)
    T[axis, 3] = length
    return T


def product(document, q):
    """base A_1 … A_n tool by multiplying elementary motions."""
    T, values = np.array(document.get("base", {"matrix": np.eye(4)})["matrix"]), iter(q)
    for row in document["joints"]:
        khalil = document["convention"] == "khalil"
        a, d = (row["d"], row["r"]) if khalil else (row["a"], row["d"])
        theta = row["theta"]
        if row["type"] != "fixed":
            v = row["sign"] * next(values) + row["offset"]
            theta, d = (theta, d + v) if row["type"] == "prismatic" else (theta + v, d)
        motion = elementary(2, theta) @ elementary(2, length=d)
        link = elementary(0, length=a) @ elementary(0, row["alpha"])
        if khalil:
            T = T @ elementary(2, row["gamma"]) @ elementary(2, length=row["b"])
        T = T @ (motion @ link if document["convention"] == "standard" else link @ motion)
    return T @ np.array(document["tool"]["matrix"])


@pytest.mark.parametrize("convention", ["standard", "modified", "khalil"])
@pytest.mark.parametrize("seed", range(8))
def test_random_tables_equal_the_plain_product(client, convention, seed):
    rng = np.random.default_rng(seed)
    document = {"convention": convention, "joints": [], "tool": {"matrix": None}}
    for _ in range(int(rng.integers(1, 10))):
        row = {
            "type": str(rng.choice(TYPES, p=[0.5, 0.25, 0.15, 0.1])),
            "alpha": float(rng.choice([0, np.pi / 2, -np.pi / 2, rng.uniform(-3, 3)])),
            "theta": float(rng.uniform(-3, 3)),
            "d": float(rng.uniform(-1, 1)),
            "offset": float(rng.uniform(-3, 3)),
            "sign": int(rng.choice([-1, 1])),
        }
        length = float(rng.choice([0, rng.uniform(-1, 1)]))
        row |= (
            {"r": length, "gamma": float(rng.uniform(-3, 3)), "b": float(rng.uniform(-1, 1))}
            if convention == "khalil"
            else {"a": length}
        )
        document["joints"].append(row)
    document["joints"][0]["type"] = "revolute"
    tool = elementary(0, 0.3) @ elementary(1, -1.0, 0.2) @ elementary(2, 2.0)
    document["tool"]["matrix"] = tool.tolist()
    document["base"] = {"matrix": (elementary(1, 0.7, 0.1) @ elementary(0, 1.2, -0.4)).tolist()}
    dof = sum(row["type"] != "fixed" for row in document["joints"])
    batch = rng.uniform(-3, 3, (4, dof))
    answer = client.post("/v1/fk", json={"robot": document, "q": batch.tolist()})
    assert answer.status_code == 200, answer.text
    found = np.array(answer.json()["poses"]["tool"]["matrix"])
    for q, T in zip(batch, found, strict=True):
        np.testing.assert_allclose(T, product(document, q), atol=1e-12, rtol=0)
        one = client.post("/v1/fk", json={"robot": document, "q": q.tolist()}).json()
        np.testing.assert_allclose(one["poses"]["tool"]["matrix"], T, atol=1e-12, rtol=0)
