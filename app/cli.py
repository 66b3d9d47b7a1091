"""``denavit serve``, ``denavit robots``, ``denavit fk …``."""

from __future__ import annotations

import os
from pathlib import Path

import click
import uvicorn

from app.access.keys import InvalidKeys, Scope, new_key
from app.access.rates import InvalidRate, RateLimits
from app.access.wiring import key_ring
from app.connections import raise_file_limit
from app.query import number
from app.settings import Settings
from app.text import render_text
from app.units import Units
from dh_to_urdf import DHError, read_json, read_par, read_yaml
from kinematics.errors import KinematicsError
from kinematics.warm import warm_up
from robots.errors import RobotError
from robots.robot import Robot, robot_from_table, robot_from_urdf
from robots.store import RobotStore


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="denavit")
def main() -> None:
    """Kinematics over HTTP: D-H tables and URDFs in; FK, Jacobians, singularities and IK out."""


@main.command()
@click.option("--host", help="Address to listen on; default 127.0.0.1.")
@click.option("--port", type=click.IntRange(0, 65535), help="Port to listen on; default 8000.")
@click.option("--workers", type=click.IntRange(1, 256), help="Worker processes; default 1.")
@click.option("--data-dir", type=click.Path(path_type=Path), help="Where uploads are kept.")
@click.option("--log-level", default="info", show_default=True)
def serve(
    host: str | None, port: int | None, workers: int | None, data_dir: Path | None, log_level: str
) -> None:
    """Serves the API. Every option is a setting too: DENAVIT_HOST, DENAVIT_PORT, …."""
    given = {"host": host, "port": port, "workers": workers, "data_dir": data_dir}
    for name, value in given.items():
        if value is not None:
            os.environ[f"DENAVIT_{name.upper()}"] = str(value)
    settings = Settings()
    try:
        key_ring(settings)
        if settings.rate_limit.strip():
            RateLimits(settings.rate_limit)
    except (InvalidKeys, InvalidRate) as error:
        raise click.ClickException(str(error)) from None
    raise_file_limit()
    # Once, before the workers start: they share the directory and the compiled code.
    RobotStore(settings.data_dir)
    click.echo("Loading the solvers (a minute after an update, else a moment) …", err=True)
    warm_up()
    shown = "localhost" if settings.host in ("127.0.0.1", "0.0.0.0", "::") else settings.host
    click.echo(
        f"Denavit listens on http://{shown}:{settings.port}  (docs: /docs, robots:"
        f" {settings.data_dir})\nTry:\n  curl 'http://{shown}:{settings.port}/v1/robots/puma560/fk"
        "?q=0,45,-90,0,45,0&angle=deg&format=text'",
        err=True,
    )
    uvicorn.run(
        "app.main:create_app",
        factory=True,
        host=settings.host,
        port=settings.port,
        workers=settings.workers,
        log_level=log_level,
        access_log=log_level in ("debug", "trace"),
        server_header=False,
        http="app.connections:GuardedProtocol",
        ws="none",
        proxy_headers=bool(settings.trusted_proxies.strip()),
        forwarded_allow_ips=settings.trusted_proxies.strip() or None,
        timeout_graceful_shutdown=30,
    )


@main.command("key")
@click.option("--name", required=True, help="Whose key it is.")
@click.option(
    "--scope", type=click.Choice(["read", "write"]), default="read", show_default=True,
    help="write also uploads and deletes robots.",
)  # fmt: skip
def make_key(name: str, scope: str) -> None:
    """Makes an API key: shows it once, with the line for DENAVIT_API_KEYS(_FILE)."""
    try:
        secret, key = new_key(name, Scope(scope))
    except InvalidKeys as error:
        raise click.ClickException(str(error)) from None
    click.echo(f"key (keep it, it is not shown again): {secret}")
    click.echo(f"line: {key.line}")


@main.command("robots")
def list_robots() -> None:
    """Lists the robots that the service knows."""
    store = RobotStore(Settings().data_dir)
    for robot_id in store.ids():
        line = store.summary(robot_id)
        click.echo(f"{line.id:20} {line.kind:5} {line.dof:3}  {line.title}")


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
    from app.operations.forward import pose_view
    from kinematics.forward import fk

    units = Units(angle == "deg")
    try:
        loaded = _load(robot)
        import numpy as np

        values = np.array([number("q", part, units) for part in q.split(",")])
        if len(values) == loaded.dof:
            values = units.joints_in(loaded, values)
        poses = fk(loaded, values, frames or None)
        views = {name: pose_view(T, units, euler) for name, T in poses.items()}
    except (DHError, RobotError, KinematicsError) as error:
        raise click.ClickException(str(error)) from None
    click.echo(render_text({"units": units.named, **views}), nl=False)


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
