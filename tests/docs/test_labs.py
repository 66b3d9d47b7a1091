"""The lab sheets: both languages alike, in three programming languages, solutions right."""

import contextlib
import io
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from app.labs.commands import SavedFile, SentRequest, read_commands
from app.labs.programs import as_powershell, as_python
from app.labs.sources import INDEX, SHEETS, student_path, teacher_path
from kinematics.checking import slips
from tests.docs.blocks import LABS, OUTPUT, ROOT, blocks_of, run, runs_of

ENGLISH = [path("en", name) for name in (INDEX, *SHEETS) for path in (student_path, teacher_path)]
STUDENTS = [student_path("en", name) for name in (INDEX, *SHEETS)]
LANGUAGE = re.compile(r"lang=\w\w&")
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?")
PROSE = re.compile(r"^```.*?^```$|`[^`]*`|\]\([^)]*\)|<http[^>]*>", re.MULTILINE | re.DOTALL)
FORMULA = re.compile(r"\$\$.*?\$\$|\$[^$]+\$", re.DOTALL)
TIMES = re.compile(r"(?:elapsed_ms|ms_per_point).*")
REFUSED = re.compile(r"^4\d\d [A-Z][a-z]* [a-z]|/problems/", re.MULTILINE)
PARTS = {
    "en": ("Aims", "Theory", "On the page", "Questions to think about", "Is my answer right?"),
    "fr": (
        "Objectifs",
        "Théorie",
        "Sur la page",
        "Questions de réflexion",
        "Ma réponse est-elle juste\u202f?",
    ),
}
POWERSHELL = re.compile(
    r"@'\n(?P<text>.*?)'@ \| Set-Content (?P<name>\S+)\n"
    r"|Invoke-RestMethod '(?P<url>[^']*)'(?P<options>(?: -\w+ (?:'(?:[^']|'')*'|[\w.-]+))*)\n",
    re.DOTALL,
)
OPTION = re.compile(r" -(\w+) (?:'((?:[^']|'')*)'|([\w.-]+))")


def text_of(name):
    return (ROOT / name).read_text()


def in_french(name):
    return name.replace("/en/", "/fr/")


def from_powershell(program):
    """The statements of a program, read by the quoting of PowerShell."""
    found, end = [], 0
    for match in POWERSHELL.finditer(program):
        assert match.start() == end, program[end : match.start()]
        end = match.end()
        if match["name"]:
            found.append(SavedFile(match["name"], match["text"]))
            continue
        options = {
            name: (quoted.replace("''", "'") or plain)
            for name, quoted, plain in OPTION.findall(match["options"])
        }
        found.append(
            SentRequest(
                options.get("Method", "Get").upper(),
                match["url"],
                options.get("ContentType", ""),
                options.get("Body"),
                options.get("InFile"),
                options.get("OutFile"),
            )
        )
    assert end == len(program), program[end:]
    return tuple(found)


@pytest.mark.parametrize("name", ENGLISH)
def test_both_languages_have_the_same_commands(name):
    """And the same numbers in their outputs, which the French ones ask for in French."""
    english, french = (blocks_of(text_of(one)) for one in (name, in_french(name)))
    assert [one.language for one in english] == [one.language for one in french]
    for one, other in zip(english, french, strict=True):
        if one.language in OUTPUT:
            assert NUMBER.findall(one.text) == NUMBER.findall(other.text)
        else:
            assert LANGUAGE.sub("", one.text) == LANGUAGE.sub("", other.text)
            asked = re.findall(r"localhost:8000\S*format=text", other.text)
            assert [url for url in asked if "lang=fr" not in url] == []


@pytest.mark.parametrize("name", ENGLISH)
def test_both_languages_have_the_same_numbers(name):
    def numbers(text, comma):
        prose = PROSE.sub(" ", text)
        if comma:
            prose = re.sub(r"(\d)(?:,|\{,\})(\d)", r"\1.\2", prose)
        return Counter(NUMBER.findall(prose))

    english, french = text_of(name), text_of(in_french(name))
    assert numbers(english, comma=False) == numbers(french, comma=True)
    assert len(FORMULA.findall(PROSE.sub("", english))) == len(
        FORMULA.findall(PROSE.sub("", french))
    )


@pytest.mark.parametrize("name", [one for one in LABS if "/fr/" in one])
def test_french_is_set_as_french(name):
    prose = FORMULA.sub("x", PROSE.sub("x", text_of(name)))
    assert re.findall(r".*\w'\w.*|.*“.*|.*\w ?\".*", prose) == []
    assert re.findall(r".* [;:?!»](?:\s|$).*|.*« .*", prose) == []
    assert re.findall(r".*\d\.\d.*", prose) == []
    assert re.findall(r".*\b(?:joint|pose|frame|link)s?\b.*", prose, re.IGNORECASE) == list(
        re.findall(r".*\*Pose\*.*", prose)
    )


@pytest.mark.parametrize("language", PARTS)
def test_every_sheet_has_its_parts(language):
    for name in SHEETS:
        headings = re.findall(r"^## (.*)$", text_of(student_path(language, name)), re.MULTILINE)
        headings = [one.replace("\u00a0", " ") for one in headings]
        assert [one for one in PARTS[language] if one not in headings] == [], name
        theory = text_of(student_path(language, name)).partition(f"## {PARTS[language][1]}")[2]
        assert "$$" in theory.partition("\n## ")[0], name


@pytest.mark.parametrize("name", ENGLISH)
def test_commands_say_the_same_in_powershell(name):
    for block in blocks_of(text_of(name)):
        if block.language == "bash":
            assert block.text.isascii(), "a terminal's encoding may be another"
            statements = read_commands(block.text)
            assert from_powershell(as_powershell(statements)) == statements


@pytest.mark.parametrize("name", STUDENTS)
def test_commands_do_the_same_in_python(name, server, tmp_path, monkeypatch):
    """And none is refused: what a reader gets is an answer."""
    shell, python = tmp_path / "shell", tmp_path / "python"
    shell.mkdir()
    python.mkdir()
    blocks = [block for block, _ in runs_of(text_of(name))]
    assert {block.language for block in blocks} == {"bash"}
    printed = [run(block, server, shell) for block in blocks]
    monkeypatch.chdir(python)
    for block, one in zip(blocks, printed, strict=True):
        program = as_python(read_commands(block.text)).replace("http://localhost:8000", server)
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            exec(compile(program, name, "exec"), {})
        assert not REFUSED.search(one), one
        answered = output.getvalue().replace(server.removeprefix("http://"), "localhost:8000")
        assert TIMES.sub("", answered).split() == TIMES.sub("", one).split()
    assert sorted(one.name for one in shell.iterdir()) == sorted(
        one.name for one in python.iterdir()
    )
    for one in shell.iterdir():
        assert not REFUSED.search(one.read_text()), one.name


def test_solutions_are_checked_and_right():
    right = 0
    for name in SHEETS:
        blocks = blocks_of(text_of(teacher_path("en", name)))
        shown = [one.text for one in blocks if one.language in OUTPUT]
        right += sum("correct: yes" in one for one in shown)
        wrong = [one for one in shown if "correct: no" in one]
        assert all("explanation" in one for one in wrong), "an example of a slip names it"
        assert not [one for one in shown if REFUSED.search(one)]
    assert right >= 17


def test_students_have_no_solutions():
    for name in (INDEX, *SHEETS):
        sheet = text_of(student_path("en", name))
        outputs = [one.text for one in blocks_of(sheet) if one.language in OUTPUT]
        assert not [one for one in outputs if "correct: yes" in one]
        answers = {
            re.sub(r"\s", "", one.text.partition('"answer":')[2])
            for other in SHEETS
            for one, shown in runs_of(text_of(teacher_path("en", other)))
            if shown is not None and "correct: yes" in shown.text
        }
        given = re.sub(r"\s", "", sheet)
        assert not [one for one in answers if one.partition("'")[0] in given]


def test_mistakes_are_named_as_check_names_them():
    sources = "".join(one.read_text() for one in Path(slips.__file__).parent.glob("*.py"))
    for name in SHEETS:
        table = re.split(r"^## Expected mistakes$", text_of(teacher_path("en", name)), flags=re.M)
        named = re.findall(r"^\| [^|]* \| (.*) \|$", table[1], re.MULTILINE)[2:]
        assert len(named) >= 3, name
        fields = {"link_radius", "limit_margin", "min_clearance_swept"}
        for code in re.findall(r"`(\w+)`", " ".join(named)):
            known = code in fields or f'"{code}"' in sources or code.endswith("_sign")
            assert known, (name, code)


def test_a_sheet_is_known_to_the_shell_of_the_oldest_ubuntu():
    for name in LABS:
        for block in blocks_of(text_of(name)):
            if block.language == "bash":
                subprocess.run(["bash", "-n", "-c", block.text], check=True)


def test_python_of_the_sheets_needs_no_package():
    for name in ENGLISH:
        for block in blocks_of(text_of(name)):
            program = block.text
            if block.language == "bash":
                program = as_python(read_commands(block.text))
            elif block.language != "python":
                continue
            modules = re.findall(r"^(?:from|import) (\w+)", program, re.MULTILINE)
            assert set(modules) <= set(sys.stdlib_module_names)
