"""Makes the service compile, while the image is built, what it would compile at every start.

Where the image runs, its root file system is read-only: neither bytecode nor compiled kernels could
be kept. Imports every module that the service's source names, so that the build fails if
docker/strip.py removed one; then serves a few requests. Whatever else compiles something when it is
first asked for belongs into ``ask``.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import json
import os
import socket
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any
from urllib.error import URLError
from urllib.request import ProxyHandler, Request, build_opener

PACKAGES = ("app", "kinematics", "robots", "dh_to_urdf")
EXTRAS = ("opentelemetry.sdk",)
"""Modules of extras, in packages of which the service needs another part."""
CLIENT = build_opener(ProxyHandler({}))


def main() -> None:
    """Imports, then serves."""
    for package in PACKAGES:
        for folder in importlib.import_module(package).__path__:
            for path in sorted(Path(folder).rglob("*.py")):
                import_named(path)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = str(probe.getsockname()[1])
    with tempfile.TemporaryDirectory() as data:
        chosen = {"DENAVIT_HOST": "127.0.0.1", "DENAVIT_PORT": port, "DENAVIT_DATA_DIR": data}
        service = subprocess.Popen(["denavit", "serve"], env=os.environ | chosen)
        try:
            url = f"http://127.0.0.1:{port}"
            wait_until_ready(url, service)
            ask(url)
        finally:
            service.terminate()
            service.wait(timeout=30)


def import_named(path: Path) -> None:
    """Imports what a source file names, also in functions, save packages that extras bring."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names = [node.module]
        else:
            continue
        for name in names:
            if not name.startswith(EXTRAS) and importlib.util.find_spec(name.partition(".")[0]):
                module = importlib.import_module(name)
                if isinstance(node, ast.ImportFrom):
                    for alias in node.names:
                        getattr(module, alias.name, None)


def wait_until_ready(url: str, service: subprocess.Popen[bytes]) -> None:
    """Waits, for minutes if need be: compiling kernels takes time."""
    while service.poll() is None:
        try:
            CLIENT.open(f"{url}/health/ready", timeout=60).close()
            return
        except URLError:
            time.sleep(0.1)
    raise SystemExit(f"the service ended with status {service.returncode}")


def ask(url: str) -> None:
    """Asks for each kind of computation."""
    robot = f"{url}/v1/robots/puma560"
    q = [0.1, 0.2, -0.3, 0.4, 0.5, 0.6]
    (pose,) = post(f"{robot}/fk", {"q": q})["poses"].values()
    post(f"{robot}/jacobian", {"q": q})
    post(f"{robot}/singularity", {"q": q})
    post(f"{robot}/ik", {"target": {"matrix": pose["matrix"]}})
    post(f"{robot}/singularity/nearest", {"q": q})
    post(f"{robot}/symbolic", {"quantities": "all"})
    path = {"q": q, "target": {"matrix": pose["matrix"]}, "samples": 5}
    post(f"{robot}/path/compare", {**path, "methods": ["null_space", "sqp", "qp"]})


def post(url: str, body: dict[str, Any]) -> Any:
    """The answer to a request; any but a success raises."""
    data = json.dumps(body).encode()
    request = Request(url, data, {"Content-Type": "application/json"})
    with CLIENT.open(request, timeout=120) as answer:
        return json.load(answer)


if __name__ == "__main__":
    main()
