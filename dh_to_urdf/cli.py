"""``dh-to-urdf table.yaml -o robot.urdf``."""

from __future__ import annotations

from pathlib import Path

import click

from dh_to_urdf.errors import DHError
from dh_to_urdf.readers import read_csv, read_json, read_yaml
from dh_to_urdf.table import DHTable
from dh_to_urdf.writer import table_to_urdf


@click.command()
@click.argument("table", type=click.Path(exists=True, dir_okay=False, allow_dash=True))
@click.option("-o", "--output", type=click.Path(dir_okay=False), help="URDF file; default: print.")
@click.option("--convention", help="standard, modified or khalil; CSV tables need it.")
@click.option("--name", help="Name of the robot, for CSV tables.")
@click.option("--angle", type=click.Choice(["rad", "deg"]), default="rad", help="CSV angle unit.")
@click.option("--length", type=click.Choice(["m", "mm"]), default="m", help="CSV length unit.")
@click.option("--visuals/--no-visuals", default=True, help="Draw cylinders along a and d.")
@click.option("--check", is_flag=True, help="Load the result with yourdfpy (extra: check).")
def main(
    table: str,
    output: str | None,
    convention: str | None,
    name: str | None,
    angle: str,
    length: str,
    visuals: bool,
    check: bool,
) -> None:
    """Turns a Denavit-Hartenberg TABLE (.json, .yaml, .csv, or - for standard input) into URDF."""
    with click.open_file(table, "rb") as stream:
        content = stream.read()
    try:
        parsed = _read(table, content, convention, name, angle, length)
    except DHError as error:
        for problem in error.problems:
            click.echo(f"{problem.pointer or '/'}: {problem.message}", err=True)
        raise SystemExit(1) from None
    for warning in parsed.warnings:
        click.echo(f"warning: {warning}", err=True)
    urdf = table_to_urdf(parsed, visuals=visuals)
    if check:
        _check(urdf)
    if output is None:
        click.echo(urdf)
    else:
        try:
            Path(output).write_text(urdf + "\n", encoding="utf-8")
        except OSError as error:
            raise click.ClickException(f"{output}: {error.strerror}") from None


def _read(
    path: str, content: bytes, convention: str | None, name: str | None, angle: str, length: str
) -> DHTable:
    suffix = Path(path).suffix.lower()
    if suffix in {".csv", ".tsv"} or (suffix == "" and convention is not None):
        return read_csv(content, convention, name, angle, length)
    if suffix == ".json":
        return read_json(content)
    return read_yaml(content)


def _check(urdf: str) -> None:
    """Loads the URDF with an independent reader and lets it complain."""
    try:
        from yourdfpy import URDF
    except ImportError:
        raise click.ClickException("--check needs yourdfpy: pip install 'denavit[check]'") from None
    import io

    robot = URDF.load(io.BytesIO(urdf.encode()), load_meshes=False, build_scene_graph=False)
    if not robot.validate():
        raise click.ClickException(f"yourdfpy finds the URDF invalid: {robot.errors}")
