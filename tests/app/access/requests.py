"""Requests with a key."""

FK = "/v1/robots/panda/fk?q=0,0,0,0,0,0,0"
TABLE = {"convention": "standard", "joints": [{"type": "R", "a": 1, "alpha": 0, "d": 0}]}


def bearer(secret: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {secret}"}
