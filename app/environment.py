"""Environment variables that begin as settings do: which are none, and which are of others."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping

from app.settings import Settings

PREFIX = "DENAVIT_"
BUILD = frozenset({"DENAVIT_PAGE", "DENAVIT_SERVICE"})
"""Read where the page is built and developed."""
_OF_KUBERNETES = re.compile(
    r"DENAVIT_(\w+_)?SERVICE_(HOST|PORT\w*)|DENAVIT_(\w+_)?PORT_\d+_(TCP|UDP|SCTP)\w*"
)
"""Put into every container beside a Service whose name begins with "denavit" (Kubernetes,
"Discovering services", environment variables); so is the next one."""
_ADDRESS = re.compile(r"(tcp|udp|sctp)://\S+")


def faults_of(environment: Mapping[str, str]) -> list[str]:
    """Return a sentence for each variable that looks like a setting and is none."""
    settings = [name.upper() for name in Settings.model_fields]
    known = {PREFIX + name for name in settings}
    faults = []
    for name in sorted(environment):
        upper = name.upper()
        if (
            not upper.startswith(PREFIX)
            or upper in known | BUILD
            or _OF_KUBERNETES.fullmatch(upper)
            or is_service_address(name, environment[name])
        ):
            continue
        near = difflib.get_close_matches(upper.removeprefix(PREFIX), settings, 1, 0.7)
        hint = f"; {PREFIX}{near[0]} is meant?" if near else "; docs/settings.md lists them"
        faults.append(f"{name} is no setting{hint}")
    return faults


def is_service_address(name: str, value: str) -> bool:
    """Return whether a variable is the address that Kubernetes gives of a Service ``denavit``.

    ``DENAVIT_PORT`` is then no port to listen on.
    """
    upper = name.upper()
    return bool(upper.startswith(PREFIX) and upper.endswith("_PORT") and _ADDRESS.fullmatch(value))
