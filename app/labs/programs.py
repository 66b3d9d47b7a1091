"""Statements of a sheet in PowerShell and in Python; both need nothing that has to be installed."""

from __future__ import annotations

from collections.abc import Sequence

from app.labs.commands import SavedFile, SentRequest, Statement


def as_powershell(statements: Sequence[Statement]) -> str:
    """Return statements as PowerShell, 5.1 and newer; ends with a line end."""
    return "".join(_powershell(one) + "\n" for one in statements)


def _powershell(statement: Statement) -> str:
    if isinstance(statement, SavedFile):
        return f"@'\n{statement.text}'@ | Set-Content {statement.name}"
    parts = [f"Invoke-RestMethod {_quoted(statement.url)}"]
    if statement.method != "GET":
        parts.append(f"-Method {statement.method.capitalize()}")
    if statement.content_type:
        parts.append(f"-ContentType {_quoted(statement.content_type)}")
    if statement.body_file is not None:
        parts.append(f"-InFile {statement.body_file}")
    if statement.body is not None:
        parts.append(f"-Body {_quoted(statement.body)}")
    if statement.output is not None:
        parts.append(f"-OutFile {statement.output}")
    return " ".join(parts)


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"


def as_python(statements: Sequence[Statement]) -> str:
    """Return statements as a Python program of the standard library; ends with a line end."""
    lines: list[str] = []
    if any(_needs_path(one) for one in statements):
        lines.append("from pathlib import Path")
    sent = [one for one in statements if isinstance(one, SentRequest)]
    if sent:
        names = "Request, urlopen" if any(_needs_request(one) for one in sent) else "urlopen"
        lines.append(f"from urllib.request import {names}")
    lines.append("")
    for one in statements:
        lines += _python(one)
    return "\n".join(lines) + "\n"


def _needs_path(statement: Statement) -> bool:
    if isinstance(statement, SavedFile):
        return True
    return statement.body_file is not None or statement.output is not None


def _needs_request(request: SentRequest) -> bool:
    return request.method != "GET"


def _python(statement: Statement) -> list[str]:
    if isinstance(statement, SavedFile):
        return [f"Path({_text(statement.name)}).write_text({_text(statement.text)})"]
    lines: list[str] = []
    sent = _text(statement.url)
    if _needs_request(statement):
        arguments = [sent]
        if statement.body is not None:
            lines.append(f"body = {_text(statement.body)}")
            arguments.append("body.encode()")
        elif statement.body_file is not None:
            arguments.append(f"Path({_text(statement.body_file)}).read_bytes()")
        if statement.content_type:
            arguments.append(f'headers={{"Content-Type": {_text(statement.content_type)}}}')
        if statement.method != "POST":
            arguments.append(f"method={_text(statement.method)}")
        lines.append(f"request = Request({', '.join(arguments)})")
        sent = "request"
    answer = f"urlopen({sent}).read()"
    if statement.output is None:
        return [*lines, f"print({answer}.decode())"]
    return [*lines, f"Path({_text(statement.output)}).write_bytes({answer})"]


def _text(text: str) -> str:
    """Return a Python literal, over several lines where the text has several."""
    if "\\" in text or '"""' in text or text.endswith('"'):
        return repr(text)
    if "\n" in text:
        start = "\\\n" if not text.startswith("\n") else ""
        return f'"""{start}{text}"""'
    return f'"{text}"' if '"' not in text else f"'{text}'" if "'" not in text else repr(text)
