"""Blocks of shell commands, read, and written in PowerShell and in Python."""

import pytest

from app.labs.commands import SavedFile, SentRequest, UnknownCommand, read_commands
from app.labs.programs import as_powershell, as_python

BLOCK = """cat > arm.json <<'END'
{"q": [1,
  2]}
END

curl -s "localhost:8000/v1/robots/a/fk?q=1,2&format=text"
curl -s -H 'Content-Type: application/json' -d '
{"it": "isn'"'"'t",
 "q": [1]}' localhost:8000/v1/fk -o fk.txt
curl -s -T arm.json -H 'Content-Type: application/json' \\
  http://localhost:8000/v1/robots/arm
curl -s -X DELETE localhost:8000/v1/robots/arm
"""


def test_a_block_is_read():
    assert read_commands(BLOCK) == (
        SavedFile("arm.json", '{"q": [1,\n  2]}\n'),
        SentRequest("GET", "http://localhost:8000/v1/robots/a/fk?q=1,2&format=text"),
        SentRequest(
            "POST",
            "http://localhost:8000/v1/fk",
            "application/json",
            '\n{"it": "isn\'t",\n "q": [1]}',
            output="fk.txt",
        ),
        SentRequest(
            "PUT",
            "http://localhost:8000/v1/robots/arm",
            "application/json",
            body_file="arm.json",
        ),
        SentRequest("DELETE", "http://localhost:8000/v1/robots/arm"),
    )


@pytest.mark.parametrize(
    "block",
    [
        "head -3 file",
        "curl -s localhost:8000/v1/robots | head -3",
        "curl -s --compressed localhost:8000/",
        "curl -s -H 'Accept: text/plain' localhost:8000/",
        "curl -s",
        "curl -s 'localhost:8000/",
        "cat > a <<'END'\n1",
    ],
)
def test_what_only_a_shell_can_do_is_refused(block):
    with pytest.raises(UnknownCommand):
        read_commands(block)


def test_powershell():
    assert as_powershell(read_commands(BLOCK)) == (
        "@'\n{\"q\": [1,\n  2]}\n'@ | Set-Content arm.json\n"
        "Invoke-RestMethod 'http://localhost:8000/v1/robots/a/fk?q=1,2&format=text'\n"
        "Invoke-RestMethod 'http://localhost:8000/v1/fk' -Method Post"
        " -ContentType 'application/json' -Body '\n{\"it\": \"isn''t\",\n \"q\": [1]}'"
        " -OutFile fk.txt\n"
        "Invoke-RestMethod 'http://localhost:8000/v1/robots/arm' -Method Put"
        " -ContentType 'application/json' -InFile arm.json\n"
        "Invoke-RestMethod 'http://localhost:8000/v1/robots/arm' -Method Delete\n"
    )


@pytest.mark.parametrize("text", ["a", 'a"b', "a'b\"c", 'a\nb"', "\na", 'a"""\nb', "a\\n\nb"])
def test_python_says_a_text_as_it_is(text):
    program = as_python([SavedFile("name", text)])
    kept = {}

    class Path:
        def __init__(self, name):
            self.name = name

        def write_text(self, text):
            kept[self.name] = text

    exec(program.replace("from pathlib import Path\n", ""), {"Path": Path})
    assert kept == {"name": text}
