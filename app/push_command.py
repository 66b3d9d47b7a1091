"""The command ``denavit push``."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TextIO

import click

from app.push import Pusher, PushError, Refused, robots_in
from app.xacro import XacroError


@click.command("push")
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path, exists=True))
@click.option("--url", default="http://127.0.0.1:8000", show_default=True, help="Of the service.")
@click.option("--name", help="Name of the robot; of one file only.")
@click.option("--arg", "arguments", multiple=True, help="Of a xacro file, as name:=ur5e.")
@click.option(
    "--packages",
    multiple=True,
    type=click.Path(path_type=Path, exists=True, file_okay=False),
    help="Folder with packages that a xacro file or meshes are in.",
)
@click.option("--base", help="URDF: link that is the base.")
@click.option("--tip", help="URDF: frame to compute for.")
@click.option("--urdf", help="zip: the URDF that is meant, where it has several.")
@click.option("--meshes/--no-meshes", default=True, help="URDF: send the meshes that it names.")
@click.option("--convention", help="Text and CSV: standard, modified or khalil.")
@click.option("--angle", type=click.Choice(["rad", "deg"]), help="Text and CSV: unit of angles.")
@click.option("--length", type=click.Choice(["m", "mm"]), help="Text and CSV: unit of lengths.")
@click.option("--key-file", type=click.File(encoding="utf-8"), help="File with the API key.")
@click.option("--overwrite", is_flag=True, help="Replace a robot of this name.")
def push(
    paths: tuple[Path, ...],
    url: str,
    name: str | None,
    arguments: tuple[str, ...],
    packages: tuple[Path, ...],
    overwrite: bool,
    meshes: bool,
    key_file: TextIO | None,
    **options: str | None,
) -> None:
    """Uploads robots: files (URDF, xacro, zip, tables, scripts), or folders of them.

    Xacro files are expanded here, where their packages are; the service never evaluates them.
    A URDF takes along those of its meshes that are there. Shows all faults of a file at once, and
    the pose at q = 0 of what was read.
    """
    files = [one for path in paths for one in robots_in(path)]
    if not files:
        raise click.ClickException("no robots there: no .urdf, .urdf.xacro or .par, no table")
    if name is not None and len(files) > 1:
        raise click.ClickException(f"--name is for one file; there are {len(files)}")
    given = {**options, "name": name, "overwrite": "true" if overwrite else None}
    query = {key: value for key, value in given.items() if value is not None}
    key = key_file.read().strip() if key_file is not None else None
    pusher = Pusher(url.rstrip("/"), key, query, arguments, packages, meshes)
    failed = sum(not _pushed(pusher, path, k, len(files)) for k, path in enumerate(files, 1))
    if failed:
        raise click.ClickException(f"{failed} of {len(files)} not uploaded")


def _pushed(pusher: Pusher, path: Path, number: int, count: int) -> bool:
    click.echo(f"[{number}/{count}] {path} … ", nl=False)
    started = time.monotonic()
    try:
        record = pusher.upload(path)
        seconds = time.monotonic() - started
        click.echo(f"robot {record['id']}, {record['dof']} joints, {seconds:.2f} s")
        for warning in record["warnings"]:
            click.echo(f"  warning: {warning}")
        for line in pusher.first_pose(record).splitlines():
            click.echo(f"  {line}")
    except Refused as refused:
        click.echo("refused")
        for line in refused.lines():
            click.echo(f"  {line}")
        return False
    except (PushError, XacroError) as error:
        click.echo("failed")
        click.echo(f"  {error}")
        return False
    return True
