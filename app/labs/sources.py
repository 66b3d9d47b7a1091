"""Which lab sheets there are, and where their Markdown lies."""

from __future__ import annotations

from app.exercises.texts import LANGUAGES

SHEETS = (
    "1-sixteen-steps",
    "2-conventions",
    "3-rotations",
    "4-jacobian",
    "5-singularities",
    "6-inverse-model",
    "7-redundancy",
    "8-optimisation",
    "9-datasheet",
    "10-real-arm",
)
"""Names of the sheets, in their order: last part of the address, and name of the file."""
INDEX = "README"


def student_path(language: str, name: str) -> str:
    """Return the file of a sheet, in the repository."""
    return f"labs/{language}/{name}.md"


def teacher_path(language: str, name: str) -> str:
    """Return the file with the solutions of a sheet, in the repository."""
    return f"labs/teacher/{language}/{name}.md"


def student_addresses() -> dict[str, str]:
    """Return the address of each file that students may read, without a slash in front."""
    return {
        student_path(language, name): f"labs/{language}" + ("" if name == INDEX else f"/{name}")
        for language in LANGUAGES
        for name in (INDEX, *SHEETS)
    }


def teacher_addresses() -> dict[str, str]:
    """Return the address of each file of the teacher's edition, likewise."""
    return {
        teacher_path(language, name): f"labs/teacher/{language}"
        + ("" if name == INDEX else f"/{name}")
        for language in LANGUAGES
        for name in (INDEX, *SHEETS)
    }
