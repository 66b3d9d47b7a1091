"""The operations that the modules of this package define."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from app.operations.operation import Operation


def _defined() -> tuple[Operation, ...]:
    """Return each operation of each module of the package, in the order of their names."""
    found: dict[str, Operation] = {}
    for info in iter_modules([str(Path(__file__).parent)], f"{__package__}."):
        if info.name != __name__:
            for value in vars(import_module(info.name)).values():
                if isinstance(value, Operation):
                    found.setdefault(value.name, value)
    return tuple(found[name] for name in sorted(found))


OPERATIONS = _defined()
