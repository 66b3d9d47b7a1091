"""Prints the lines of requirements.lock that one table of pyproject.toml needs.

``locked.py run`` means the service itself with closed forms, ``locked.py build`` the build backend
and Node for the page.
The lock also holds what only developers need, and pip accepts no hashed constraints for what a
requirement depends on; so pip resolves the table against the lock's versions, without installing
anything, and the lock's entries of what it found are printed for ``pip install --require-hashes
--no-deps``.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path


def normalised(name: str) -> str:
    """The name as package indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def needed(wanted: list[str], pins: list[str]) -> set[str]:
    """Names of all distributions that pip would install for the requirements."""
    with tempfile.TemporaryDirectory() as folder:
        constraints, requirements = Path(folder, "constraints"), Path(folder, "requirements")
        constraints.write_text("\n".join(pins), encoding="utf-8")
        requirements.write_text("\n".join(wanted), encoding="utf-8")
        report = Path(folder, "report")
        pip_install = [sys.executable, "-m", "pip", "install", "--quiet", "--only-binary", ":all:"]
        pip_install += ["--dry-run", "--ignore-installed", "--report", str(report)]
        pip_install += ["--constraint", str(constraints), "--requirement", str(requirements)]
        subprocess.run(pip_install, check=True, stdout=sys.stderr)
        found = json.loads(report.read_text(encoding="utf-8"))["install"]
    return {normalised(item["metadata"]["name"]) for item in found}


def main() -> None:
    """Prints the entries for the table that the command line names."""
    project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))
    wanted = {
        "run": project["project"]["dependencies"]
        + project["project"]["optional-dependencies"]["symbolic"],
        "build": project["build-system"]["requires"]
        + project["project"]["optional-dependencies"]["page"],
    }[sys.argv[1]]
    entries = re.split(r"\n(?=\S)", Path("requirements.lock").read_text(encoding="utf-8").strip())
    names = needed(wanted, [entry.partition("\n")[0].rstrip("\\ ") for entry in entries])
    chosen = [e for e in entries if normalised(e.partition("==")[0]) in names]
    missing = names - {normalised(e.partition("==")[0]) for e in chosen}
    if missing:
        sys.exit(f"requirements.lock lacks {', '.join(sorted(missing))}; run: make lock")
    sys.stdout.write("\n".join(chosen) + "\n")


if __name__ == "__main__":
    main()
