"""The largest URDFs that are read, from upload to answer over HTTP.

    python -m bench.large_urdf [--server http://localhost:8000]

Robots of 200 joints with as many shapes as are kept, alone and with elements that are left out.
Each is uploaded, converted and computed with in turn; the best of several rounds is printed, beside
the processor time of parsing the same text by lxml alone.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

import httpx
from lxml import etree

from tests.conftest import running_server

JOINTS, CHAIN, VISUALS, LEFT_OUT, ROUNDS = 200, 50, 4, 3500, 7
LIMIT = '<limit lower="-2" upper="2" effort="10" velocity="3"/>'
INERTIAL = (
    '<inertial><mass value="1.5"/><origin xyz="0 0 0.1"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
VISUAL = (
    '<visual name="v{k}"><origin xyz="0.01 0.00{k} 0.3" rpy="0 0.12 0"/><geometry>'
    '<box size="0.1 0.2 0.3"/></geometry><material name="m{k}"><color rgba="0.1 0.2 0.3 1"/>'
    "</material></visual>"
)
GAZEBO = '<gazebo reference="link_1"><material>Gazebo/Grey</material><mu1 value="1"/></gazebo>'


def large_urdf(left_out: int = 0) -> str:
    """Return a robot of 200 joints in chains from one base."""
    shapes = "".join(VISUAL.format(k=k) for k in range(VISUALS))
    links = ["base", *(f"link_{k}" for k in range(JOINTS))]
    parts = [f'<link name="{name}">{INERTIAL}{shapes}</link>' for name in links]
    for k in range(JOINTS):
        parent = "base" if k % CHAIN == 0 else f"link_{k - 1}"
        parts.append(
            f'<joint name="joint_{k}" type="revolute"><parent link="{parent}"/>'
            f'<child link="link_{k}"/><origin xyz="0.1 0.02 0.1" rpy="0.1 0.{k:03} 0"/>'
            f'<axis xyz="0 0.6 0.8"/>{LIMIT}</joint>'
        )
    return "\n".join(['<robot name="large">', *parts, *[GAZEBO] * left_out, "</robot>"])


def main() -> int:
    """Measure, on a server of its own unless one is named."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--server", help="address of a running service")
    options = parser.parse_args()
    with ExitStack() as stack:
        address = options.server
        if address is None:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
            address, _ = stack.enter_context(running_server(folder))
        client = stack.enter_context(httpx.Client(base_url=address, timeout=600))
        for left_out in (0, LEFT_OUT):
            report(client, large_urdf(left_out))
    return 0


def report(client: httpx.Client, text: str) -> None:
    """Print the best times of one robot."""
    headers = {"content-type": "application/xml"}
    body = {"robot": {"urdf": text}, "q": [0.1] * JOINTS}
    best = dict.fromkeys(("lxml", "upload", "urdf-to-dh", "fk"), float("inf"))
    for k in range(ROUNDS):
        # Another text each time, so that nothing is known already.
        content = text.replace("0.12 0", f"0.12 0.{k + 1}")
        body["robot"] = {"urdf": content}
        calls = {
            "lxml": lambda content=content: etree.fromstring(content),
            "upload": lambda content=content: client.put(
                "/v1/robots/large?overwrite=true", content=content, headers=headers
            ),
            "urdf-to-dh": lambda content=content: client.post(
                "/v1/urdf-to-dh?convention=standard", content=content, headers=headers
            ),
            "fk": lambda: client.post("/v1/fk", json=body),
        }
        for name, call in calls.items():
            started = time.perf_counter()
            answer = call()
            best[name] = min(best[name], time.perf_counter() - started)
            if isinstance(answer, httpx.Response):
                answer.raise_for_status()
    shown = ", ".join(f"{name} {1000 * seconds:.0f} ms" for name, seconds in best.items())
    print(f"{len(text) / 1000:.0f} kB, {JOINTS} joints: {shown}")


if __name__ == "__main__":
    sys.exit(main())
