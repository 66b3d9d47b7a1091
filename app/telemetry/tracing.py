"""OpenTelemetry, where the environment's standard variables ask for it (extra ``telemetry``).

FastAPI makes the spans and the exporters; here is decided whether, and what spans leave out.
"""

from __future__ import annotations

import logging
import os
from collections.abc import MutableMapping
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from opentelemetry import trace

if TYPE_CHECKING:
    from fastapi.telemetry import TelemetryConfig
    from opentelemetry.sdk.trace import TracerProvider

_ENDPOINTS = (
    "OTEL_EXPORTER_OTLP_ENDPOINT",
    "OTEL_EXPORTER_OTLP_TRACES_ENDPOINT",
    "OTEL_EXPORTER_OTLP_METRICS_ENDPOINT",
)
_PACKAGES = ("opentelemetry.sdk", "opentelemetry.exporter.otlp.proto.http")
_PROBES = frozenset(("/health/live", "/health/ready", "/metrics"))


class TracingUnavailable(Exception):
    """Telemetry is asked for, and its packages are not installed."""


def asked_for() -> bool:
    """Whether the environment names a place to send spans or metrics to."""
    disabled = os.environ.get("OTEL_SDK_DISABLED", "").lower() == "true"
    return not disabled and any(os.environ.get(name) for name in _ENDPOINTS)


def require_exporters() -> None:
    """Checks that what is asked for can be had.

    Raises:
        TracingUnavailable: It cannot; the message says what to install.
    """
    if asked_for() and not all(_installed(name) for name in _PACKAGES):
        raise TracingUnavailable(
            "OTEL_EXPORTER_OTLP_… asks for OpenTelemetry, which is not installed here:"
            " pip install 'denavit[telemetry]', or unset the variable"
        )


def telemetry_config() -> TelemetryConfig:
    """What FastAPI needs to know.

    Raises:
        TracingUnavailable: See :func:`require_exporters`.
    """
    if not asked_for():
        return {"tracing": False, "metrics": False, "logs": False, "auto_configure": False}
    require_exporters()
    return {
        "tracer_provider": _provider(),
        "logs": False,  # log lines go to standard error, with the ids of trace and span
        "auto_configure": True,
        "exclude": _is_probe,
    }


class WithTraceIds(logging.Filter):
    """Adds the ids of trace and span to the lines written within one."""

    def filter(self, record: logging.LogRecord) -> bool:
        """Lets every record pass."""
        context = trace.get_current_span().get_span_context()
        if context.is_valid:
            ids = {
                "trace_id": trace.format_trace_id(context.trace_id),
                "span_id": trace.format_span_id(context.span_id),
            }
            record.fields = {**getattr(record, "fields", {}), **ids}
        return True


def _installed(name: str) -> bool:
    try:
        return find_spec(name) is not None
    except ModuleNotFoundError:
        return False


def _is_probe(scope: MutableMapping[str, Any]) -> bool:
    return str(scope.get("path")).removeprefix(scope.get("root_path", "")) in _PROBES


def _provider() -> TracerProvider:
    from opentelemetry.sdk.resources import Resource
    from opentelemetry.sdk.trace import Span, SpanProcessor, TracerProvider

    class WithoutQuery(SpanProcessor):
        """A span says at what address something was asked for, not what."""

        def on_start(self, span: Span, parent_context: Any = None) -> None:  # noqa: ARG002
            if span.attributes and "url.query" in span.attributes:
                span.set_attribute("url.query", "REDACTED")

    named = {} if os.environ.get("OTEL_SERVICE_NAME") else {"service.name": "denavit"}
    provider = TracerProvider(resource=Resource.create(named), shutdown_on_exit=False)
    provider.add_span_processor(WithoutQuery())
    return provider
