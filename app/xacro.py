"""Xacro files, expanded on the machine of the user, where the file and its packages are.

Xacro evaluates Python expressions and reads other files. The service never does that; only
``denavit push`` uses this module, on files that the user has.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

SUFFIX = ".xacro"


class XacroError(ValueError):
    """A xacro file that cannot be expanded; the message says why."""


def expanded(path: Path, arguments: Sequence[str], packages: Sequence[Path]) -> str:
    """Return the URDF of a xacro file.

    Args:
        path: The file.
        arguments: Values for its ``<xacro:arg>``, as ``name:=value``.
        packages: Folders in whose packages ``$(find …)`` looks besides those around the file.

    Raises:
        XacroError: xacro is not installed, an argument is no ``name:=value``, or the file fails.
    """
    values = dict(map(_argument, arguments))
    try:
        import xacrodoc
        import xacrodoc.packages
    except ImportError:
        raise XacroError(
            f"{path} is a xacro file, which is expanded here and never by the service:"
            " pip install 'denavit[xacro]'"
        ) from None
    around = _beside(path)
    folders = [*packages, *([around] if around is not None else [])]
    try:
        xacrodoc.packages.reset()
        xacrodoc.packages.walk_up_from(path)
        xacrodoc.packages.look_in([str(one) for one in folders])
        document = xacrodoc.XacroDoc.from_file(str(path), subargs=values, resolve_packages=False)
        return str(document.to_urdf_string(use_protocols=False))
    # Xacro evaluates what the file says: it raises whatever that raises.
    except Exception as error:
        raise XacroError(f"{path}: xacro fails: {error}") from None


def _argument(text: str) -> tuple[str, str]:
    name, sign, value = text.partition(":=")
    if not sign or not name.strip():
        raise XacroError(f"--arg {text}: write name:=value, such as --arg name:=ur5e")
    return name.strip(), value


def _beside(path: Path) -> Path | None:
    """Return the folder of the packages beside that of a file; None where it is in no package."""
    for folder in path.resolve().parents:
        if (folder / "package.xml").is_file():
            return folder.parent
    return None
