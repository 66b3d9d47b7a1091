"""What ``create_app`` adds for protection: middleware, in its order, and what the docs say."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fastapi import FastAPI
from starlette.middleware.cors import CORSMiddleware

from app.access.control import AccessControl
from app.access.headers import SafeHeaders
from app.access.hosts import AllowedHosts, allowed_hosts
from app.access.keys import InvalidKeys, KeySource
from app.access.origins import CrossOrigin
from app.access.rates import RateLimits
from app.access.shared_counters import SharedCounters
from app.admission.memory import BodyBudget
from app.middleware.request_id import RequestId, RequestIds
from app.openapi.problems import PROBLEMS
from app.settings import Settings, listed
from dh_to_urdf.messages import say

READABLE = (
    "ETag",
    "Location",
    "Retry-After",
    "RateLimit-Limit",
    "RateLimit-Remaining",
    "RateLimit-Reset",
    "X-Request-ID",
    "X-Converged",
    "X-Not-Converged",
)
"""Headers that pages of other origins may read."""
SENDABLE = (
    "Authorization",
    "Content-Type",
    "If-Match",
    "If-None-Match",
    "X-API-Key",
    "X-Request-ID",
)
METHODS = ("GET", "HEAD", "POST", "PUT", "DELETE")


def key_source(settings: Settings) -> KeySource:
    """Return the keys that a deployment accepts.

    Raises:
        InvalidKeys: They cannot be read, or there are none and each is to have a namespace.
    """
    keys = KeySource(settings.api_keys.get_secret_value(), settings.api_keys_file)
    if settings.namespaces and not keys.required:
        raise InvalidKeys(
            say(
                "DENAVIT_NAMESPACES gives each key robots of its own, and no keys are"
                " set: make some with denavit key and set DENAVIT_API_KEYS_FILE, or"
                " leave DENAVIT_NAMESPACES out"
            )
        )
    return keys


def check_access(settings: Settings) -> None:
    """Read keys, host names and rate limit as :func:`protect` will, so that a start fails early.

    Raises:
        InvalidHosts: A host name cannot be read.
        InvalidKeys: Keys cannot be read.
        InvalidRate: The rate limit cannot be read.
    """
    key_source(settings)
    allowed_hosts(settings)
    if settings.rate_limit.strip():
        RateLimits(settings.rate_limit)


def protect(
    app: FastAPI, settings: Settings, ids: RequestIds, counters: Path | None = None
) -> KeySource:
    """Add middleware; the last added is the outermost.

    Args:
        app: The application.
        settings: What a deployment chose.
        ids: Those that requests get.
        counters: The file in which all workers of the service count; None: this one is alone.

    Returns:
        The keys that it accepts.

    Raises:
        InvalidHosts: A host name cannot be read.
        InvalidKeys: Keys cannot be read.
        InvalidRate: The rate limit cannot be read.
    """
    keys = key_source(settings)
    rates = None
    if settings.rate_limit.strip():
        storage = SharedCounters(counters) if counters is not None else None
        rates = RateLimits(settings.rate_limit, storage)
    app.add_middleware(BodyBudget)
    if keys.required or rates is not None:
        app.add_middleware(AccessControl, keys=keys, rates=rates)
    origins = listed(settings.cors_origins)
    app.add_middleware(CrossOrigin, origins=origins)
    if origins:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=origins,
            allow_methods=METHODS,
            allow_headers=SENDABLE,
            expose_headers=READABLE,
        )
    app.add_middleware(AllowedHosts, names=allowed_hosts(settings))
    app.add_middleware(RequestId, ids=ids)
    app.add_middleware(SafeHeaders, private=keys.required, embeddable="*" in origins)
    return keys


def is_open(settings: Settings) -> bool:
    """Return whether a request is taken without keys, counting, or pages of other origins."""
    return not (
        key_source(settings).required
        or settings.rate_limit.strip()
        or listed(settings.cors_origins)
    )


def describe(document: dict[str, Any], *, needs_keys: bool) -> None:
    """Add to an OpenAPI document that the service may be busy, and keys where they are needed."""
    paths = {path: item for path, item in document["paths"].items() if "/health/" not in path}
    for item in paths.values():
        for operation in item.values():
            operation.setdefault("responses", {}).setdefault("503", PROBLEMS["4XX"])
    if not needs_keys:
        return
    schemes = document.setdefault("components", {}).setdefault("securitySchemes", {})
    schemes["bearer"] = {"type": "http", "scheme": "bearer"}
    schemes["apiKey"] = {"type": "apiKey", "in": "header", "name": "X-API-Key"}
    for item in paths.values():
        for operation in item.values():
            operation["security"] = [{"bearer": []}, {"apiKey": []}]
