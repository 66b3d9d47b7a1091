"""``denavit serve``: prepares what all workers share, then serves."""

from __future__ import annotations

import os
import signal
import sys

import click

from app.access.hosts import named_by_address
from app.readiness import written_to
from app.serving.address import CannotListen, bound_sockets, port_of
from app.serving.connections import raise_file_limit
from app.serving.worker import HANGUP
from app.settings import Settings
from app.telemetry.logs import LOG, log_form, log_to_stderr
from app.telemetry.tracing import TracingUnavailable, require_exporters
from kinematics.kernel_cache import is_full
from robots.store import RobotStore

LOADING = "Loading the solvers …"
COMPILING = (
    "Compiling the solvers in the background, once, for about a minute; until then a request that"
    " needs one takes seconds longer"
)


def serve(settings: Settings) -> int:
    """Serves until a signal comes.

    Returns:
        Exit status: 0 after a signal, 1 where the service cannot start; a log line says why.
    """
    log_to_stderr(settings)
    settings = named_by_address(settings)
    # Workers and what else is started import nothing from the current directory.
    os.environ["PYTHONSAFEPATH"] = "1"
    # Until the server takes over, a signal ends the process at once, and with 0.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    if HANGUP is not None:
        signal.signal(HANGUP, signal.SIG_IGN)
    raise_file_limit()
    try:
        require_exporters()
        sockets = bound_sockets(settings.host, settings.port)
        # Once, before the workers start: they share the directory.
        RobotStore(settings.data_dir)
        written_to(settings.data_dir)
    except (CannotListen, TracingUnavailable) as error:
        LOG.critical("cannot start: %s", error)
        return 1
    except OSError as error:
        LOG.critical(
            "cannot start: the data directory %s cannot be used: %s",
            settings.data_dir,
            error.strerror or error,
        )
        return 1
    _say(settings, LOADING if is_full() else COMPILING)
    _say_where(settings, port_of(sockets[0]))
    if settings.workers > 1:
        from app.serving.supervisor import Supervisor

        return Supervisor(settings, sockets).run()
    from app.serving.server import Server, leave, run_server

    leave(run_server(settings, sockets, Server))
    return 0


def _say(settings: Settings, text: str) -> None:
    if log_form(settings) == "text":
        click.echo(text, err=True)
    else:
        LOG.info(text)


def _say_where(settings: Settings, port: int) -> None:
    shown = "localhost" if settings.host in ("127.0.0.1", "0.0.0.0", "::") else settings.host
    address = f"http://{f'[{shown}]' if ':' in shown else shown}:{port}{settings.root_path}"
    command = f"curl '{address}/v1/robots/puma560/fk?q=0,45,-90,0,45,0&angle=deg&format=text'"
    if log_form(settings) == "text":
        click.echo(
            f"Denavit listens on {address}  (docs: /docs, robots: {settings.data_dir})\n"
            f"Try:\n  {command}",
            err=True,
        )
        return
    fields = {"address": address, "robots": str(settings.data_dir), "try": command}
    LOG.info("Denavit listens", extra={"fields": fields})
    sys.stderr.flush()
