"""``denavit push``: files and folders of the user, uploaded one by one."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from http.client import HTTPException
from pathlib import Path
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.parse import quote, urlencode
from urllib.request import Request, urlopen

from app.mesh_bundle import bundled
from app.xacro import SUFFIX as XACRO
from app.xacro import expanded

ZIP = "application/zip"
TYPES = {
    ".urdf": "application/xml",
    ".xml": "application/xml",
    ".json": "application/json",
    ".yaml": "application/yaml",
    ".yml": "application/yaml",
    ".csv": "text/csv",
    ".par": "text/x-symoro",
    ".zip": ZIP,
    **dict.fromkeys((".txt", ".md", ".tsv", ".py", ".m", ".tex"), "text/plain"),
}
"""Content types by the ending of a file."""
_OF_TEXT = ("convention", "angle", "length", "columns", "values")
_OF_URDF = ("base", "tip")
_OF_ZIP = ("base", "tip", "urdf")
_ROBOTS = (".urdf", f".urdf{XACRO}", ".par")
"""Endings that say that a file is a robot."""
_TABLES = (".json", ".yaml", ".yml")
"""Endings of files that are robots where they hold a table."""
_LARGEST = 2_000_000
SECONDS = 120.0


class PushError(ValueError):
    """A file that is not uploaded; the message says why."""


@dataclass(frozen=True)
class Refused(Exception):
    """The service refused a file.

    Attributes:
        problem: Its problem document.
    """

    problem: Mapping[str, Any]

    def lines(self) -> Iterator[str]:
        """Return a line for each fault: where, and what is wrong."""
        errors = self.problem.get("errors") or [{"message": self.problem.get("detail", "")}]
        for error in errors:
            line = error.get("line")
            where = f"line {line}" if line is not None else error.get("pointer", "")
            element = f"  [{error['xpath']}]" if error.get("xpath") else ""
            yield f"{where}: {error['message']}{element}" if where else str(error["message"])
        more = self.problem.get("more_errors", 0)
        if more:
            yield f"and {more} more"


@dataclass(frozen=True)
class Pusher:
    """Uploads robots to one service.

    Attributes:
        url: Address of the service, without a slash at its end.
        key: API key; None for none.
        options: Query parameters of the upload, such as ``base``; those that a kind of document
            does not have are left out for it.
        arguments: Values of ``<xacro:arg>``, as ``name:=value``.
        packages: Folders in whose packages xacro and meshes are looked for besides those around a
            file.
        meshes: Whether the meshes that a URDF names go with it.
    """

    url: str
    key: str | None = None
    options: Mapping[str, str] = field(default_factory=dict)
    arguments: Sequence[str] = ()
    packages: Sequence[Path] = ()
    meshes: bool = True

    def upload(self, path: Path) -> dict[str, Any]:
        """Upload a file and return the record of the robot.

        Raises:
            PushError: The file cannot be read, is of no known kind, or the service is not there.
            XacroError: A xacro file that cannot be expanded here.
            Refused: The service refused it.
        """
        if path.suffix == XACRO:
            content = expanded(path, self.arguments, self.packages).encode()
            kind = "application/xml"
        else:
            content, kind = _content(path), _type_of(path)
        if kind == "application/xml" and self.meshes:
            packed = bundled(path, content, self.packages)
            content, kind = (content, kind) if packed is None else (packed, ZIP)
        allowed = {"name", "overwrite"}
        allowed.update(_OF_ZIP if kind == ZIP else ())
        allowed.update(_OF_URDF if kind == "application/xml" else ())
        allowed.update(_OF_TEXT if kind in ("text/plain", "text/csv") else ())
        query = {key: value for key, value in self.options.items() if key in allowed}
        if "name" not in query and kind in ("text/plain", "text/csv", "text/x-symoro"):
            query["name"] = path.stem
        address = "/v1/robots" + (f"?{urlencode(query)}" if query else "")
        return dict(json.loads(self._send("POST", address, content, kind, "application/json")))

    def first_pose(self, record: Mapping[str, Any]) -> str:
        """Return the pose of the tip at q = 0, as text.

        Raises:
            PushError: The service is not there.
            Refused: It does not compute it.
        """
        zeros = ",".join("0" for _ in range(int(record["dof"])))
        address = f"/v1/robots/{quote(str(record['id']))}/fk?q={zeros}"
        return self._send("GET", address, None, None, "text/plain").decode()

    def _send(
        self, method: str, address: str, body: bytes | None, kind: str | None, accept: str
    ) -> bytes:
        headers = {"Accept": accept}
        headers |= {"Content-Type": kind} if kind else {}
        headers |= {"Authorization": f"Bearer {self.key}"} if self.key else {}
        request = Request(f"{self.url}{address}", body, headers, method=method)
        try:
            with urlopen(request, timeout=SECONDS) as answer:
                return bytes(answer.read())
        except HTTPError as error:
            raise Refused(_problem(error)) from None
        except (URLError, HTTPException, OSError) as error:
            reason = getattr(error, "reason", error)
            raise PushError(
                f"no answer from {self.url} ({reason}); start it: denavit serve"
            ) from None


def robots_in(path: Path) -> list[Path]:
    """Return the files of a path that are robots: itself, or those of a folder, by name.

    In a folder these are URDFs, ``.urdf.xacro`` and ``.par`` files, and JSON and YAML files that
    hold a D-H table; files that xacro includes, settings and meshes are passed over.
    """
    if not path.is_dir():
        return [path]
    found = []
    for one in sorted(path.rglob("*")):
        hidden = any(part.startswith(".") for part in one.relative_to(path).parts)
        if not hidden and one.is_file() and (one.name.endswith(_ROBOTS) or _holds_table(one)):
            found.append(one)
    return found


def _holds_table(path: Path) -> bool:
    if path.suffix not in _TABLES or path.stat().st_size > _LARGEST:
        return False
    text = path.read_bytes()
    return b"joints" in text and b"convention" in text


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise PushError(f"{path}: {error.strerror}") from None


def _type_of(path: Path) -> str:
    try:
        return TYPES[path.suffix.lower()]
    except KeyError:
        known = " ".join((*TYPES, XACRO))
        raise PushError(f"{path}: not known by its ending; known are {known}") from None


def _problem(error: HTTPError) -> dict[str, Any]:
    content = error.read()
    try:
        found = json.loads(content)
    except ValueError:
        found = None
    if isinstance(found, dict):
        return found
    words = content.decode("utf-8", "replace").strip()
    return {"status": error.code, "detail": words[:400] or f"{error.code} {error.reason}"}
