"""Requests that take their time, and what is left of processes."""

import json
import threading
from pathlib import Path

import httpx

WILD = {
    "convention": "standard",
    "joints": [
        {"type": "R", "alpha": 0.31 + 0.1 * k, "a": 0.23 + 0.07 * k, "d": 0.11 + 0.13 * k}
        for k in range(7)
    ],
}
HARD = {"position": [0.0, 0.0, 0.0], "rpy": [0, 0, 0]}
"""Not to be reached by talos_arm, which finds out by many restarts."""


class Asked(threading.Thread):
    """A request in a thread; its answer or error."""

    def __init__(self, call):
        super().__init__(daemon=True)
        self.call, self.answer, self.error, self.lines = call, None, None, []
        self.start()

    def run(self):
        try:
            self.answer = self.call()
        except httpx.HTTPError as error:
            self.error = error


def symbolic(address, seconds):
    """A request that works for so long in a process of its own."""
    body = {"robot": WILD, "quantities": ["jacobian", "det_jacobian"]}
    body["time_budget_ms"] = int(seconds * 1e3)
    return Asked(lambda: httpx.post(f"{address}/v1/symbolic", json=body, timeout=120))


def stream(address, targets):
    """A request that computes in a thread and sends lines, some hundreds at a time."""
    body = {"targets": [HARD] * targets, "max_restarts": 300, "time_budget_ms": 60_000}
    headers = {"Accept": "application/x-ndjson"}
    url = f"{address}/v1/robots/talos_arm/ik"

    def read():
        with httpx.stream("POST", url, json=body, headers=headers, timeout=120) as answer:
            for line in answer.iter_lines():
                asked.lines.append(json.loads(line))
        return answer

    asked = Asked(read)
    return asked


def symbolic_processes(children, root):
    """Processes for closed forms, anywhere below a process."""
    found = []
    for pid, command in children(root).items():
        if "kinematics.symbolic.worker" in command:
            found.append(pid)
        found += symbolic_processes(children, pid)
    return found


def gone(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True
