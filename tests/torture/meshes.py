"""``python -m tests.torture.meshes --count 200``: mutated meshes and zips against the reader.

Each is refused in a sentence, or what comes of it is held to what was promised: finite numbers, no
triangles that name other vertices, a hull about all vertices, a file that another reader reads, and
nothing of a file outside. No process takes more memory than it may.
"""

from __future__ import annotations

import io
import resource
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import click
import numpy as np
import trimesh

from kinematics.meshes.archived_robot import archived_robot
from kinematics.meshes.preparation import SHOWN_TRIANGLES, MeshReader
from robots.errors import RobotError
from robots.uploaded_mesh import UploadedMesh
from tests.torture.mesh_files import BOX, stl
from tests.torture.mesh_mutations import CANARY, Case, case

MOST = 30_000_000
MEMORY = 400 << 20
"""Bytes that the process for meshes may take in the campaign."""
PROGRAM = 100 << 20
"""Bytes of its programs, which are mapped and not counted by its limit."""
CANARY_SIZE = 7.0


def with_canary(folder: Path) -> Path:
    """Write the file that no upload may reach; its size tells it."""
    path = folder / CANARY
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(stl(BOX / BOX.max() * CANARY_SIZE))
    return path


def judge(one: Case, reader: MeshReader) -> str:
    """Read an upload; return what came of it.

    Raises:
        AssertionError: Something else than what is promised.
    """
    try:
        if one.name:
            found = [reader.mesh(one.name, one.content)]
        else:
            with reader.archive(one.content) as archive:
                robot = archived_robot(archive, None, None, None)
            check_sentences(robot.notes)
            found = [(mesh, robot.files[mesh.name]) for mesh in robot.robot.meshes]
    except RobotError as error:
        check_sentences(map(str, error.args))
        return "refused"
    for mesh, file in found:
        check(mesh, file)
    return "read" if found else "read without meshes"


def check_sentences(sentences) -> None:
    """Sentences for people: short, and nothing of the machine in them."""
    for sentence in map(str, sentences):
        assert sentence
        assert len(sentence) < 2_000
        assert "Traceback" not in sentence
        assert "site-packages" not in sentence


def check(mesh: UploadedMesh, file: bytes) -> None:
    """Hold a mesh to its promises, by another reading of its file."""
    assert mesh.size == len(file)
    scene = trimesh.load_scene(io.BytesIO(file), file_type="glb", process=False)
    parts = list(scene.geometry.values())
    assert sum(len(part.faces) for part in parts) == mesh.shown_triangles
    assert mesh.shown_triangles <= max(SHOWN_TRIANGLES, 4 * 32)
    points = np.concatenate([part.vertices for part in parts])
    assert np.isfinite(points).all()
    lower, upper = np.array(mesh.lower), np.array(mesh.upper)
    assert (upper - lower).max() != CANARY_SIZE, "the file outside was read"
    size = max(float((upper - lower).max()), float(np.abs([lower, upper]).max()), 1e-300)
    hull = mesh.hull.vertices
    assert np.isfinite(hull).all()
    assert (hull.min(axis=0) <= lower + 1e-9 * size).all()
    assert (hull.max(axis=0) >= upper - 1e-9 * size).all()
    if len(mesh.hull.triangles):
        A, B, C = (hull[mesh.hull.triangles[:, k]] for k in range(3))
        normals = np.cross(B - A, C - A)
        heights = np.einsum("ij,ikj->ik", normals, points[None, :, :] - A[:, None, :])
        scale = np.linalg.norm(normals, axis=1)[:, None] * size
        # Simplified vertices may lie a little outside; they are for drawing.
        assert (heights <= 0.2 * scale + 1e-30).all()


def largest_child() -> int:
    """The most memory of any process that was waited for, bytes."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024


@click.command()
@click.option("--count", default=200, show_default=True, help="How many cases.")
@click.option("--seed", default=0, show_default=True)
@click.option("--first", default=0, show_default=True, help="First case.")
@click.option("--save", type=click.Path(path_type=Path), help="Folder for those that fail.")
def main(count: int, seed: int, first: int, save: Path | None) -> None:
    """Judges mutated meshes and archives."""
    outcomes: Counter[tuple[str, str]] = Counter()
    failures, slowest, started = 0, 0.0, time.monotonic()
    reader = MeshReader(MOST, MEMORY, 0)
    with tempfile.TemporaryDirectory() as folder:
        outside = str(with_canary(Path(folder)))
        for number in range(first, first + count):
            one, before = case(seed, number, outside), time.monotonic()
            try:
                outcomes[one.kind, judge(one, reader)] += 1
            except Exception as error:
                failures += 1
                click.echo(f"FAILED {number} ({one.kind}): {type(error).__name__}: {error}")
                if save is not None:
                    save.mkdir(parents=True, exist_ok=True)
                    (save / f"{number}-{one.name or 'a.zip'}").write_bytes(one.content)
            slowest = max(slowest, time.monotonic() - before)
    for (kind, outcome), number in sorted(outcomes.items()):
        click.echo(f"{number:4d} {kind}: {outcome}")
    most = largest_child()
    click.echo(
        f"{count} cases in {time.monotonic() - started:.0f} s, {failures} failures; slowest"
        f" {slowest:.1f} s; largest process {most / 1e6:.0f} MB of {(MEMORY + PROGRAM) / 1e6:.0f}"
    )
    sys.exit(failures > 0 or most > MEMORY + PROGRAM)


if __name__ == "__main__":
    main()
