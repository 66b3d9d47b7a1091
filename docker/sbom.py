"""Writes down what the image carries, and refuses a package whose licence is not permissive.

``python docker/sbom.py FOLDER`` in the image: ``licences.txt`` for people, ``sbom.cdx.json``
(CycloneDX) for scanners, with Python and the packages of the Debian system besides.
"""

from __future__ import annotations

import json
import platform
import sys
from pathlib import Path
from typing import Any

from app.licences import cyclonedx, installed

DPKG = Path("/var/lib/dpkg/status")


def main() -> None:
    """Checks, then writes."""
    packages = installed()
    refused = [f"{one.name} ({one.licence or 'unknown'})" for one in packages if not one.permissive]
    if refused:
        sys.exit(f"not permissive, or unknown: {', '.join(refused)}")
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True)
    lines = [f"{one.name:28} {one.version:14} {one.licence}\n" for one in packages]
    lines += ["\nPython: PSF-2.0. Debian's packages: /usr/share/doc/*/copyright.\n"]
    (folder / "licences.txt").write_text("".join(lines), encoding="utf-8")
    bill = cyclonedx(packages)
    bill["components"] += [python(), *debian()]
    (folder / "sbom.cdx.json").write_text(json.dumps(bill, indent=1), encoding="utf-8")


def python() -> dict[str, Any]:
    """The interpreter."""
    version = platform.python_version()
    return {
        "type": "platform",
        "bom-ref": f"pkg:generic/python@{version}",
        "name": "python",
        "version": version,
        "purl": f"pkg:generic/python@{version}",
        "licenses": [{"license": {"id": "PSF-2.0"}}],
    }


def debian() -> list[dict[str, Any]]:
    """The packages of the system."""
    found = []
    for entry in DPKG.read_text(encoding="utf-8").split("\n\n"):
        fields = dict(line.split(": ", 1) for line in entry.splitlines() if ": " in line[:40])
        if fields.get("Status") != "install ok installed":
            continue
        name, version = fields["Package"], fields["Version"]
        reference = f"pkg:deb/debian/{name}@{version}?arch={fields['Architecture']}"
        found.append(
            {
                "type": "library",
                "bom-ref": reference,
                "name": name,
                "version": version,
                "purl": reference,
            }
        )
    return found


if __name__ == "__main__":
    main()
