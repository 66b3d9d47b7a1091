"""Words around the sheets, in the languages that there are sheets in."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Words:
    """What stands around a sheet.

    Attributes:
        index: Name of the list of sheets.
        sheets: Label of the menu of sheets.
        service: Label of the menu of the service.
        contents: Label of the contents of a page.
        section: Label of a link to a section.
        page: Name of the page at ``/``.
        guide: Name of the guide.
        teacher: Name of the teacher's edition.
        itself: Name of the language, in itself.
    """

    index: str
    sheets: str
    service: str
    contents: str
    section: str
    page: str
    guide: str
    teacher: str
    itself: str


WORDS = {
    "en": Words(
        index="Labs",
        sheets="Lab sheets",
        service="Service",
        contents="On this page",
        section="Link to this section",
        page="The page",
        guide="Guide",
        teacher="Teacher's edition",
        itself="English",
    ),
    "fr": Words(
        index="Travaux pratiques",
        sheets="Sujets de travaux pratiques",
        service="Service",
        contents="Sur cette page",
        section="Lien vers cette section",
        page="La page",
        guide="Guide (en anglais)",
        teacher="Édition de l’enseignant",
        itself="Français",
    ),
}
