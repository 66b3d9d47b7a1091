"""Settings from the environment, prefix ``DENAVIT_``; nothing is read at import."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Literal

from pydantic import Field, SecretStr
from pydantic_settings import BaseSettings, SettingsConfigDict

from app.admission.machine import request_bytes, worker_bytes


def listed(text: str) -> list[str]:
    """Return the entries of a setting that is a list, with commas or blanks between them."""
    return [one for one in re.split(r"[,\s]+", text) if one]


def default_data_dir() -> Path:
    """``$XDG_DATA_HOME/denavit``, else ``~/.local/share/denavit``."""
    return Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share") / "denavit"


class Settings(BaseSettings):
    """What a deployment may choose."""

    model_config = SettingsConfigDict(env_prefix="DENAVIT_", frozen=True, extra="ignore")

    host: str = Field(default="127.0.0.1", description="Address to listen on.")
    port: int = Field(default=8000, ge=0, le=65535, description="Port to listen on.")
    workers: int = Field(default=1, ge=1, le=256, description="Worker processes.")
    data_dir: Path = Field(
        default_factory=default_data_dir, description="Where uploaded robots are kept."
    )
    preload: bool = Field(
        default=True, description="Load the whole library before the first request, 2 s."
    )
    max_document_bytes: int = Field(
        default=2_000_000, ge=1000, description="Largest robot document (table or URDF)."
    )
    max_mesh_bytes: int = Field(
        default=30_000_000, ge=1000, description="Largest mesh file, alone or in an archive."
    )
    max_archive_bytes: int = Field(
        default=60_000_000, ge=1000, description="Largest zip of a URDF and its meshes."
    )
    max_compute_bytes: int = Field(
        default=64_000_000, ge=1000, description="Largest body of a computation, batches included."
    )
    max_robots: int = Field(default=10_000, ge=0, description="Most uploaded robots.")
    max_stored_bytes: int = Field(
        default=1_000_000_000, ge=0, description="Most bytes in the files of uploaded robots."
    )
    max_namespace_robots: int = Field(
        default=300, ge=0, description="Most uploaded robots of one namespace."
    )
    max_namespace_bytes: int = Field(
        default=30_000_000, ge=0, description="Most bytes in the files of one namespace."
    )
    max_batch: int = Field(default=200_000, ge=1, description="Most configurations in one request.")
    max_ik_batch: int = Field(default=10_000, ge=1, description="Most IK targets in one request.")
    max_request_seconds: float = Field(
        default=60.0, gt=0, description="Longest computation of one request."
    )
    max_waiting: int = Field(
        default=64, ge=0, description="Requests that wait for a thread; more get 503."
    )
    max_wait_seconds: float = Field(
        default=10.0, gt=0, description="Longest that a request waits for a thread."
    )
    max_worker_bytes: int | None = Field(
        default=None,
        ge=100_000_000,
        description="Memory of a worker; large requests wait, or get 503 or 413. Default: what the"
        " container allows, or the machine has, divided by the workers.",
    )
    max_connections: int = Field(
        default=1000, ge=1, description="Connections at a time; beyond, idle and slow ones close."
    )
    head_seconds: float = Field(
        default=10.0, gt=0, description="Longest that the head of a request takes to arrive."
    )
    body_seconds: float = Field(
        default=20.0, gt=0, description="The same of a body, and a second more for each 10 kB."
    )
    write_seconds: float = Field(
        default=20.0, gt=0, description="Longest that nobody reads an answer, likewise."
    )
    compute_threads: int = Field(
        default_factory=lambda: os.cpu_count() or 1,
        ge=1,
        description="Threads for batches and for inverse kinematics.",
    )
    api_keys: SecretStr = Field(
        default=SecretStr(""), description="Hash lines of API keys, as `denavit key` prints them."
    )
    api_keys_file: Path | None = Field(default=None, description="A file of such lines, besides.")
    namespaces: bool = Field(
        default=False, description="Each key sees and changes robots of its own; needs keys."
    )
    rate_limit: str = Field(
        default="", description="Requests of one key or address, such as 10/second;600/minute."
    )
    allowed_hosts: str = Field(
        default="",
        description="Names by which the service may be called, such as robots.example.org"
        " *.lab.example.org; * for all. Default: localhost, 127.0.0.1 and [::1] where it listens"
        " there only, else all.",
    )
    trusted_proxies: str = Field(
        default="",
        description="Addresses of reverse proxies whose X-Forwarded-For is believed.",
    )
    cors_origins: str = Field(
        default="", description="Origins whose web pages may use the API, or *."
    )
    symbolic_workers: int = Field(
        default=1, ge=1, le=16, description="Processes for symbolic kinematics at a time."
    )
    root_path: str = Field(
        default="",
        pattern=r"^(/[A-Za-z0-9._~-]+)*$",
        description="Path prefix under which a reverse proxy shows the service.",
    )
    shutdown_seconds: float = Field(
        default=25.0, ge=0, description="How long requests in flight may go on when stopping."
    )
    drain_seconds: float = Field(
        default=0.0, ge=0, description="How long a stopping service still accepts, unready."
    )
    check_reveal: bool = Field(
        default=True, description="Answers of `check` may show what is right (`reveal`)."
    )
    teacher_edition: bool = Field(
        default=False,
        description="Serve the solutions of the lab sheets, where keys are needed to those of scope"
        " share.",
    )
    log_format: Literal["auto", "json", "text"] = Field(
        default="auto", description="Form of log lines; auto is text on a terminal, else JSON."
    )
    log_level: Literal["debug", "info", "warning", "error", "critical"] = Field(
        default="info", description="The least level that is logged."
    )
    access_log: bool = Field(default=True, description="A log line for each request.")
    log_clients: bool = Field(default=False, description="Log lines name the client's address.")
    metrics: bool = Field(default=True, description="Serve /metrics for Prometheus.")

    @property
    def request_bytes(self) -> int:
        """Memory of a worker for requests."""
        return request_bytes(self.max_worker_bytes or worker_bytes(self.workers))
