"""A wheel has the guide's pages."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

from app.guide.sources import INDEX, PAGES, PICTURES

ROOT = Path(__file__).parents[3]


def test_a_wheel_serves_the_guide(tmp_path):
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        archive.extractall(tmp_path / "installed")
    wanted = (INDEX, *PAGES.values(), *PICTURES.values())
    assert {f"app/guide/sources/{path}" for path in wanted} <= names
    code = (
        "from app.guide import routes, sources;"
        " guide = routes.load_guide(); print(sources.source_root(), len(guide.pages))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "installed")},
        check=True,
        capture_output=True,
        text=True,
    )
    assert done.stdout.split() == [
        str(tmp_path / "installed/app/guide/sources"),
        str(len(PAGES)),
    ]
