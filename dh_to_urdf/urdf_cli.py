"""``urdf-to-dh robot.urdf --convention modified``."""

from __future__ import annotations

import json
from pathlib import Path

import click

from dh_to_urdf.documents.layouts import document, to_csv, to_text, to_yaml
from dh_to_urdf.documents.mapping import CONVENTION_ALIASES
from dh_to_urdf.errors import DHError
from dh_to_urdf.extraction.extract import MAX_SNAP, SNAP, extract
from dh_to_urdf.extraction.urdf_chain import read_chain
from dh_to_urdf.languages import codes, language
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.writer import TABLE_TEXTS

FORMATS = ("text", "yaml", "json", "csv", *TABLE_TEXTS)


@click.command()
@click.argument("urdf", type=click.Path(exists=True, dir_okay=False, allow_dash=True))
@click.option(
    "--convention",
    type=click.Choice(tuple(CONVENTION_ALIASES), case_sensitive=False),
    required=True,
    help="standard, modified or khalil; no default, since courses differ.",
)
@click.option("--base", help="Link to start from; default: the root.")
@click.option("--tip", help="Link to end at; default: the end of the longest chain.")
@click.option(
    "--snap",
    type=click.FloatRange(0.0, MAX_SNAP),
    default=SNAP,
    show_default=True,
    help="Axes tilted by less than this (rad) are taken as parallel.",
)
@click.option("--positive-a", is_flag=True, help="No negative a; offsets may grow.")
@click.option("--format", "form", type=click.Choice(FORMATS), default="text", show_default=True)
@click.option("--angle", type=click.Choice(["rad", "deg"]), default="rad", show_default=True)
@click.option("--explain", is_flag=True, help="Say how each frame was found (text, yaml, json).")
@click.option("--lang", type=click.Choice(codes()), default="en", help="Language of messages.")
@click.option("--decimal", type=click.Choice(["point", "comma"]), default="point", help="In CSV.")
@click.option("-o", "--output", type=click.Path(dir_okay=False), help="File; default: print.")
def main(
    urdf: str,
    convention: str,
    base: str | None,
    tip: str | None,
    snap: float,
    positive_a: bool,
    form: str,
    angle: str,
    explain: bool,
    lang: str,
    decimal: str,
    output: str | None,
) -> None:
    """Find the Denavit-Hartenberg table of a serial chain in a URDF (- for standard input)."""
    spoken = language(lang)
    with click.open_file(urdf, "rb") as stream:
        content = stream.read()
    try:
        chain = read_chain(content, base, tip)
        named = CONVENTION_ALIASES[convention.lower()]
        found = extract(chain, named, snap=snap, positive_a=positive_a)
    except DHError as error:
        for fault in error.faults:
            click.echo(spoken.text(str(fault)), err=True)
        raise SystemExit(1) from None
    degrees = angle == "deg"
    if form == "text":
        text = spoken.text(to_text(found, degrees=degrees, explained=explain))
    elif form == "csv":
        commas = decimal == "comma"
        text = to_csv(found.table, degrees=degrees, language=spoken, commas=commas)
    elif form in TABLE_TEXTS:
        text = TABLE_TEXTS[form].write(found.table)
    else:
        mapping = spoken.told(document(found, degrees=degrees, explained=explain))
        text = to_yaml(mapping) if form == "yaml" else _json(mapping)
    if form != "text":
        for warning in found.table.warnings:
            click.echo(spoken.text(say("warning: {warning}", warning=warning)), err=True)
    if output is None:
        click.echo(text, nl=False)
        return
    try:
        Path(output).write_text(text, encoding="utf-8")
    except OSError as error:
        raise click.ClickException(f"{output}: {error.strerror}") from None


def _json(mapping: dict[str, object]) -> str:
    return json.dumps(mapping, indent=1, ensure_ascii=False) + "\n"
