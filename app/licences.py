"""The licences of all that is installed beside the service, and a list of it for machines.

Reads what the installed distributions say of themselves. What they carry inside, such as the
compiled libraries of a wheel, is under the licence texts in their ``dist-info`` folders.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.metadata import Distribution, distributions, version
from typing import Any

_COPYLEFT = re.compile(
    r"\b[AL]?GPL|GNU (?:Affero |Lesser |Library )?General Public|\bSSPL|\bBUSL"
    r"|non-?commercial|CC-BY-NC|proprietary",
    re.IGNORECASE,
)
"""Licences that the default install must not have; an exception for linking lifts them."""
_SAID_IN_TEXT = {"cmeel-qhull": "Qhull", "resvg_py": "MIT"}
"""Licences that a package gives only as a text, as SPDX identifiers."""
_ALTERNATIVE = re.compile(r"\s+OR\s+")
_LONGEST = 120
_CLASSIFIER = "License :: "


@dataclass(frozen=True, slots=True)
class Package:
    """An installed distribution.

    Attributes:
        name: Name on the index.
        version: Version.
        licence: An SPDX expression where the package gives one, else what it says; empty where it
            says nothing.
        texts: Names of its licence files.
    """

    name: str
    version: str
    licence: str
    texts: tuple[str, ...]

    @property
    def permissive(self) -> bool:
        """Whether the licence is known and asks for no more than to be named."""
        if not self.licence:
            return False
        options = _ALTERNATIVE.split(self.licence.strip("()"))
        return any(not _COPYLEFT.search(one) or " WITH " in one for one in options)


def installed(among: Iterable[Distribution] | None = None) -> tuple[Package, ...]:
    """All installed distributions, by name."""
    found = distributions() if among is None else among
    packages = {one.name.lower(): _package(one) for one in found if one.name}
    return tuple(packages[name] for name in sorted(packages))


def cyclonedx(packages: Iterable[Package]) -> dict[str, Any]:
    """A software bill of materials: CycloneDX 1.6 as JSON values."""
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {
            "component": {
                "type": "application",
                "name": "denavit",
                "version": version("denavit"),
                "bom-ref": "denavit",
            }
        },
        "components": [_component(one) for one in packages if one.name != "denavit"],
    }


def _component(package: Package) -> dict[str, Any]:
    name = re.sub(r"[-_.]+", "-", package.name).lower()
    reference = f"pkg:pypi/{name}@{package.version}"
    component: dict[str, Any] = {
        "type": "library",
        "bom-ref": reference,
        "name": package.name,
        "version": package.version,
        "purl": reference,
    }
    if package.licence:
        component["licenses"] = [{"license": {"name": package.licence}}]
    return component


def _package(distribution: Distribution) -> Package:
    metadata = distribution.metadata
    texts = tuple(metadata.get_all("License-File") or ())
    return Package(distribution.name, distribution.version, _licence(metadata), texts)


def _licence(metadata: Any) -> str:
    """The expression, else the classifiers, else the first line of the old free text."""
    if expression := metadata.get("License-Expression"):
        return str(expression)
    named = [
        value.rpartition(" :: ")[2]
        for value in metadata.get_all("Classifier") or ()
        if value.startswith(_CLASSIFIER) and value != "License :: OSI Approved"
    ]
    if named:
        return " AND ".join(named)
    text = str(metadata.get("License") or "").strip().partition("\n")[0]
    return text[:_LONGEST] or _SAID_IN_TEXT.get(str(metadata["Name"]), "")
