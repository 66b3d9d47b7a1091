"""Licences of what is installed: known and, for the default install, permissive."""

import json
import re
from importlib.metadata import distribution

import pytest
from click.testing import CliRunner
from packaging.requirements import Requirement

from app.cli import main
from app.licences import Package, cyclonedx, installed

NOT_LOADED = {"jrl-cmakemodules"}
"""CMake files under the LGPL that example-robot-data names; nothing loads them, and the image has
none of them."""


def normalised(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def closure(name, extras=frozenset()):
    """All that an installed distribution needs, by name."""
    found, waiting = set(), [(name, frozenset(extras))]
    while waiting:
        name, extras = waiting.pop()
        if (name, extras) in found:
            continue
        found.add((name, extras))
        for text in distribution(name).requires or ():
            one = Requirement(text)
            wanted = (
                [one.marker.evaluate({"extra": e}) for e in ("", *extras)] if one.marker else [1]
            )
            if any(wanted):
                waiting.append((normalised(one.name), frozenset(one.extras)))
    return {name for name, _ in found}


@pytest.mark.parametrize("extras", [(), ("symbolic",), ("telemetry",)])
def test_the_default_install_is_permissive(extras):
    needed = closure("denavit", extras)
    assert len(needed) > 20
    packages = [one for one in installed() if normalised(one.name) in needed]
    assert {normalised(one.name) for one in packages} == needed
    assert {one.name for one in packages if not one.permissive} <= NOT_LOADED


@pytest.mark.parametrize(
    ("licence", "permissive"),
    [
        ("MIT", True),
        ("BSD-2-Clause AND Apache-2.0 WITH LLVM-exception", True),
        ("GPL-3.0-or-later", False),
        ("GNU Lesser General Public License v3 or later (LGPLv3+)", False),
        ("GNU Affero General Public License v3", False),
        ("MIT OR GPL-2.0-only", True),
        ("MIT AND GPL-2.0-only", False),
        ("GPL-3.0-or-later WITH GCC-exception-3.1", True),
        ("CC-BY-NC-4.0", False),
        ("Free for non-commercial use", False),
        ("", False),
    ],
)
def test_what_is_permissive(licence, permissive):
    assert Package("x", "1", licence, ()).permissive is permissive


def test_the_command_lists_and_checks():
    runner = CliRunner()
    listed = runner.invoke(main, ["licences"]).output
    assert re.search(r"^fastapi +\d[\d.]+ +MIT$", listed, re.MULTILINE)
    bill = json.loads(runner.invoke(main, ["licences", "--sbom"]).output)
    assert bill["bomFormat"] == "CycloneDX"
    references = [one["bom-ref"] for one in bill["components"]]
    assert len(references) == len(set(references)) > 20
    assert any(re.fullmatch(r"pkg:pypi/ruamel-yaml@[\d.]+", one) for one in references)
    checked = runner.invoke(main, ["licences", "--check"])  # with the developers' tools
    refused = [one.name for one in installed() if not one.permissive]
    assert checked.exit_code == (1 if refused else 0)
    assert all(name in checked.output for name in refused)


def test_a_bill_has_no_licence_where_none_is_known():
    bill = cyclonedx([Package("A.b", "1", "", ())])
    assert bill["components"] == [
        {
            "type": "library",
            "bom-ref": "pkg:pypi/a-b@1",
            "name": "A.b",
            "version": "1",
            "purl": "pkg:pypi/a-b@1",
        }
    ]
