"""``denavit serve``, ``denavit robots``, ``denavit fk …``."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TextIO

import click
from pydantic import ValidationError

from app.access.keys import InvalidKeys, Scope, new_key
from app.access.rates import InvalidRate
from app.environment import faults_of, is_service_address
from app.http.problems import RequestProblem
from app.http.query import number
from app.http.text import render_text
from app.http.units import Units
from app.push_command import push
from app.settings import Settings
from dh_to_urdf import DHError, read_json, read_par, read_yaml
from kinematics.errors import KinematicsError
from robots.errors import RobotError, StorageError
from robots.namespaces import Namespaces
from robots.robot import Robot, robot_from_table, robot_from_urdf
from robots.storage.usage_record import Quotas
from robots.store import RobotStore


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="denavit")
def main() -> None:
    """Kinematics over HTTP: D-H tables and URDFs in; FK, Jacobians, singularities and IK out."""


main.add_command(push)


@main.command()
@click.option("--host", help="Address to listen on; default 127.0.0.1.")
@click.option("--port", type=click.IntRange(0, 65535), help="Port to listen on; default 8000.")
@click.option("--workers", type=click.IntRange(1, 256), help="Worker processes; default 1.")
@click.option("--data-dir", type=click.Path(path_type=Path), help="Where uploads are kept.")
@click.option("--log-level", help="debug, info (the default), warning, error or critical.")
def serve(
    host: str | None,
    port: int | None,
    workers: int | None,
    data_dir: Path | None,
    log_level: str | None,
) -> None:
    """Serves the API. Every option is a setting too: DENAVIT_HOST, DENAVIT_PORT, …."""
    given = {"host": host, "port": port, "workers": workers, "data_dir": data_dir}
    given["log_level"] = log_level
    for name in [name for name, value in os.environ.items() if is_service_address(name, value)]:
        del os.environ[name]
    if faults := faults_of(os.environ):
        raise click.ClickException("\n".join(faults))
    for name, value in given.items():
        if value is not None:
            os.environ[f"DENAVIT_{name.upper()}"] = str(value)
    try:
        settings = Settings()
    except ValidationError as error:
        raise click.ClickException(_told(error)) from None
    from app.access.wiring import check_access

    try:
        check_access(settings)
    except (InvalidKeys, InvalidRate) as error:
        raise click.ClickException(str(error)) from None
    from app.serving.service import serve as serve_until_stopped

    sys.exit(serve_until_stopped(settings))


def _told(error: ValidationError) -> str:
    """What is wrong with the settings, a line each."""
    return "\n".join(
        f"DENAVIT_{str(item['loc'][0]).upper()}: {item['msg']}" for item in error.errors()
    )


@main.command("key")
@click.option("--name", required=True, help="Whose key it is.")
@click.option(
    "--scope",
    type=click.Choice([scope.value for scope in Scope]),
    default="read",
    show_default=True,
    help="write also uploads and deletes robots; share does so for all keys.",
)
def make_key(name: str, scope: str) -> None:
    """Makes an API key: shows it once, with the line for DENAVIT_API_KEYS(_FILE)."""
    try:
        secret, key = new_key(name, Scope(scope))
    except InvalidKeys as error:
        raise click.ClickException(str(error)) from None
    click.echo(f"key (keep it, it is not shown again): {secret}")
    click.echo(f"line: {key.line}")


@main.command("robots")
@click.option("--namespace", help="As the key of this name sees them.")
def list_robots(namespace: str | None) -> None:
    """Lists the robots that the service knows."""
    directory = Settings().data_dir
    if namespace is None:
        store = RobotStore(directory)
    else:
        store = Namespaces(directory, Quotas(), Quotas()).of(namespace)
    for robot_id in store.ids():
        try:
            line = store.summary(robot_id)
        except RobotError as error:
            click.echo(str(error), err=True)
            continue
        click.echo(f"{line.id:20} {line.kind:5} {line.dof:3}  {line.title}")


@main.command("licences")
@click.option("--sbom", is_flag=True, help="As CycloneDX JSON.")
@click.option("--check", is_flag=True, help="Fail where a licence is not permissive, or unknown.")
def list_licences(sbom: bool, check: bool) -> None:
    """Lists the licences of all installed packages."""
    from app.licences import cyclonedx, installed

    packages = installed()
    if sbom:
        click.echo(json.dumps(cyclonedx(packages), indent=1))
    else:
        for one in packages:
            click.echo(f"{one.name:28} {one.version:14} {one.licence or 'unknown'}")
    refused = [one.name for one in packages if not one.permissive]
    if check and refused:
        raise click.ClickException(f"not permissive, or unknown: {', '.join(refused)}")


@main.command("fk")
@click.argument("robot")
@click.argument("q")
@click.option("--angle", type=click.Choice(["rad", "deg"]), default="rad", show_default=True)
@click.option("--frame", "frames", multiple=True, help="Frame name; may be repeated.")
@click.option("--euler", help="Also Euler angles, e.g. ZXZ.")
def forward(robot: str, q: str, angle: str, frames: tuple[str, ...], euler: str | None) -> None:
    """Forward kinematics of ROBOT (an id, or a .yaml, .json, .par or .urdf file) at Q.

    Q is comma-separated: denavit fk puma560 0,pi/4,-90deg,0,45deg,0
    """
    from app.fields.doubts import RequestDoubts
    from app.operations.forward import pose_view
    from kinematics.forward import fk

    units = Units(angle == "deg")
    try:
        loaded = _load(robot)
        import numpy as np

        values = np.array([number("q", part, units) for part in q.split(",")])
        doubts = RequestDoubts(loaded, units, loaded.warnings)
        if len(values) == loaded.dof:
            given, values = values, units.joints_in(loaded, values)
            doubts.configuration(given, values, "q")
        poses = fk(loaded, values, frames or None)
        views = {name: pose_view(T, units, euler) for name, T in poses.items()}
    except (DHError, RobotError, StorageError, KinematicsError) as error:
        raise click.ClickException(str(error)) from None
    click.echo(render_text({"units": units.named, **views}), nl=False)
    for warning in doubts.warnings:
        click.echo(f"warning: {warning}", err=True)


def _load(robot: str) -> Robot:
    path = Path(robot)
    if not path.suffix:
        return RobotStore(Settings().data_dir).get(robot).robot
    try:
        content = path.read_bytes()
    except OSError as error:
        raise click.ClickException(f"{robot}: {error.strerror}") from None
    if path.suffix in (".urdf", ".xml"):
        return robot_from_urdf(content)
    if path.suffix == ".par":
        return robot_from_table(read_par(content))
    if path.suffix == ".csv":
        raise click.ClickException("CSV says no convention: convert it with dh-to-urdf first")
    reader = read_json if path.suffix == ".json" else read_yaml
    return robot_from_table(reader(content))


_CLASS = click.argument("students", type=click.Path(path_type=Path, exists=True, dir_okay=False))


@main.command("sheets")
@click.argument("exercise")
@_CLASS
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder to write to.")
@click.option("--lang", type=click.Choice(["en", "fr"]), default="en", show_default=True)
@click.option("--url", default="http://localhost:8000/", show_default=True, help="Of the service.")
def make_sheets(exercise: str, students: Path, out: Path, lang: str, url: str) -> None:
    """Writes a sheet of EXERCISE for each of STUDENTS, a CSV with a column id.

    Each student gets other numbers: denavit sheets planar-2r class.csv --out sheets
    """
    from app.exercises.class_list import ClassListError, read_class_list, write_sheets

    try:
        listed = read_class_list(students)
        written = write_sheets(exercise, listed, out, lang, f"{url.rstrip('/')}/")
    except (ClassListError, RequestProblem) as error:
        raise click.ClickException(str(error)) from None
    except OSError as error:
        raise click.ClickException(f"{out}: {error.strerror}") from None
    click.echo(f"{len(written)} sheets in {out}")


@main.command("marks")
@click.argument("exercise")
@_CLASS
@click.option(
    "--answers",
    type=click.Path(path_type=Path, exists=True, file_okay=False),
    help="Folder with ID.json of each student; default: columns of the list, named as the parts.",
)
@click.option("--out", type=click.File("w", encoding="utf-8"), default="-", help="CSV.")
def make_marks(exercise: str, students: Path, answers: Path | None, out: TextIO) -> None:
    """Marks the answers of STUDENTS, a CSV with a column id, to EXERCISE; writes a CSV of marks.

    denavit marks planar-2r class.csv --answers answers --out marks.csv
    """
    from app.exercises.class_list import ClassListError, marks_table, read_class_list

    try:
        table = marks_table(exercise, read_class_list(students), answers)
    except (ClassListError, RequestProblem) as error:
        raise click.ClickException(str(error)) from None
    out.write(table)
