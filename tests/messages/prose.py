"""Texts in the sources that read like parts of sentences and are no messages."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from tests.messages.collect import MAKERS, sources

PROSE = re.compile(
    r"(?:^|[\s(;,])[a-z]{2,},? (?:[a-z]{1,}|[0-9{])|^[a-z]{3,} $|^[,;] [a-z]|^ [a-z]{2,}"
)
NO_ANSWER = {
    *("re.compile", "re.sub", "re.search", "re.fullmatch", "click.option", "click.argument"),
    *("click.ClickException", "click.UsageError", "click.echo", "click.BadParameter"),
    *("TypeError", "AssertionError", "RuntimeError", "NotImplementedError", "SystemExit"),
    *("declared", "within_query", "Parameter", "msgspec.Meta", "Operation", "Field", "_meta"),
    *("optional_configuration", "_text", "TypeVar", "Literal", "frozenset", "cast"),
}
"""Calls whose texts go to developers, operators, the OpenAPI document, or nowhere."""
METHODS = {
    *("info", "error", "warning", "exception", "debug", "get", "split", "startswith", "endswith"),
    *("removeprefix", "removesuffix", "replace", "partition", "strip", "index", "find", "write"),
    *("sub", "search", "fullmatch", "option", "command", "group"),
}
KEYWORDS = {"description", "summary", "help", "example", "media_type", "pattern"}
FILES = {
    "dh_to_urdf/cli.py": "the command line's own help",
    "dh_to_urdf/urdf_cli.py": "the command line's own help",
    "dh_to_urdf/writer.py": "URDF",
    "dh_to_urdf/par/writer.py": "SYMORO's comments",
    "dh_to_urdf/pasted/writer.py": "MATLAB, LaTeX and Markdown",
    "dh_to_urdf/pasted/heading_words.py": "words that are read",
    "dh_to_urdf/pasted/headings.py": "words that are read",
    "dh_to_urdf/pasted/joint_types.py": "words that are read",
    "dh_to_urdf/pasted/programs/attributes.py": "names of functions that are read",
    "dh_to_urdf/pasted/programs/harmless.py": "names of functions that are read",
    "dh_to_urdf/pasted/programs/library.py": "names of functions that are read",
    "kinematics/symbolic/code.py": "Python and C",
    "kinematics/symbolic/views.py": "comments of Python and C",
    "kinematics/symbolic/inverse_model/c.py": "C",
    "kinematics/symbolic/inverse_model/matlab.py": "MATLAB",
    "kinematics/symbolic/inverse_model/python.py": "Python",
    "app/access/keys.py": "told to the operator, at the start",
    "app/access/rates.py": "told to the operator, at the start",
    "app/cli.py": "told to the operator",
    "app/push.py": "told by the command line",
    "app/push_command.py": "told by the command line",
    "app/xacro.py": "told by the command line",
    "app/exercises/class_list.py": "told to a teacher at the command line",
    "kinematics/symbolic/link_matrix.py": "matrices and their sources",
    "app/labs/commands.py": "told to those who write sheets",
    "app/labs/programs.py": "Python and PowerShell",
    "app/labs/words.py": "words of the sheets, in each of their languages",
    "app/docs.py": "the page of the OpenAPI document",
    "app/environment.py": "told to the operator, at the start",
    "app/licences.py": "a list of licences",
    "app/main.py": "the OpenAPI document",
    "app/page.py": "headers",
    "app/settings.py": "told to the operator",
}
"""Files whose other texts are no sentences of answers."""
FOLDERS = {
    "app/guide/": "the pages of the guide",
    "app/openapi/": "the OpenAPI document",
    "app/pictures/": "SVG",
    "app/serving/": "told to the operator; refusals before a request is read",
    "app/telemetry/": "log lines and metrics",
}


TEXTS = {
    "app/access/control.py": (", error=", "key {}"),
    "app/fields/joints.py": ("Joint values", "rad and m", "{}a batch", "{}or an object"),
    "app/fields/names.py": ("pose, position, orientation",),
    "app/http/query.py": ("Language of messages", "CSV: point"),
    "app/operations/inverse.py": ("... {} more: with=status",),
    "app/operations/maps.py": ("Number of samples",),
    "app/operations/operation.py": ("event loop",),
    "app/operations/path_fields.py": ("linear, cubic, quintic",),
    "app/exercises/sheets.py": ("vx v",),
    "kinematics/checking/slips.py": ("all angles",),
    "app/operations/step.py": ("Wanted motion",),
    "app/labs/routes.py": ("private, no-cache",),
    "app/routes/meshes.py": ("public, max-age", "private, no-cache", "The mesh, replaced"),
    "app/routes/robots.py": (
        *("Name of the robot", "CSV and pasted", "Pasted text", "Numbers for names", "SYMORO:"),
        *("URDF: default tip", "URDF: frame in", "zip: the URDF"),
    ),
    "app/routes/tables.py": (
        *("standard, modified or khalil.", "Frame to", "Axes tilted", "true: ", "rad (default)"),
        "json (default)",
    ),
    "dh_to_urdf/messages.py": ("no message",),
    "dh_to_urdf/pasted/programs/python_source.py": ("is not", "not in"),
    "kinematics/kernel_cache.py": ("from kinematics.compiled",),
    "kinematics/processes/process.py": ("import sys",),
    "kinematics/warm.py": ("the cache is not filled",),
    "robots/urdf/markup.py": (" xmlns:",),
}
"""Single texts, by how they begin: descriptions of the OpenAPI document, headers, programs."""


def plain_sentences() -> Iterator[str]:
    """Each place with a text that reads like a sentence, in a file that answers are made in."""
    for path, tree in sources():
        texts: list[ast.AST] = []
        if path.startswith(("dh_to_urdf/", "robots/", "kinematics/")) and path in FILES:
            # What such a file refuses reaches an answer all the same.
            for node in ast.walk(tree):
                if isinstance(node, ast.Raise) and not _is_for_operators(node):
                    _walk(node, texts)
        elif path not in FILES and not path.startswith(tuple(FOLDERS)):
            _walk(tree, texts)
        known = TEXTS.get(path, ())
        texts = [one for one in texts if not _shown(one).startswith(known or "\0")]
        yield from (f"{path}:{one.lineno}: {_shown(one)!r}" for one in texts)  # type: ignore[attr-defined]


def _is_for_operators(node: ast.Raise) -> bool:
    return isinstance(node.exc, ast.Call) and ast.unparse(node.exc.func) in NO_ANSWER


def _walk(node: ast.AST, found: list[ast.AST]) -> None:
    if isinstance(node, ast.JoinedStr) or _is_text(node):
        if PROSE.search(_shown(node)):
            found.append(node)
        return
    for child in _parts(node):
        _walk(child, found)


def _parts(node: ast.AST) -> Iterator[ast.AST]:
    """What of a node can reach an answer."""
    if isinstance(node, ast.Expr) and _is_text(node.value):
        return
    if isinstance(node, (ast.Compare, ast.arg, ast.MatchValue)):
        return
    if isinstance(node, ast.Subscript):
        yield node.value
        return
    if isinstance(node, ast.AnnAssign):
        if node.value is not None:
            yield node.value
        return
    if isinstance(node, ast.Dict):
        pairs = zip(node.keys, node.values, strict=True)
        yield from (v for k, v in pairs if not (_is_text(k) and _shown(k) in KEYWORDS))
        return
    if isinstance(node, ast.Call):
        name = ast.unparse(node.func)
        last = name.rpartition(".")[2]
        if name in MAKERS or name in NO_ANSWER or last in NO_ANSWER:
            yield from (k.value for k in node.keywords if name in MAKERS)
            return
        if last not in METHODS:
            yield from node.args
        yield from (k.value for k in node.keywords if k.arg not in KEYWORDS)
        if not isinstance(node.func, ast.Attribute) or last == "join":
            return
        yield node.func
        return
    if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
        yield from node.body
        return
    yield from ast.iter_child_nodes(node)


def _is_text(node: ast.AST | None) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _shown(node: ast.AST | None) -> str:
    if isinstance(node, ast.JoinedStr):
        return "".join(_shown(one) if _is_text(one) else "{}" for one in node.values)
    return str(node.value) if isinstance(node, ast.Constant) else ""
