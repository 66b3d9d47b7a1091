"""``dh-to-urdf table.yaml -o robot.urdf``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from dh_to_urdf.cells.values import split_values
from dh_to_urdf.documents.readers import read_csv, read_json, read_yaml
from dh_to_urdf.errors import DHError
from dh_to_urdf.languages import codes, language
from dh_to_urdf.messages import say
from dh_to_urdf.par.reader import read_par
from dh_to_urdf.pasted.reader import read_pasted
from dh_to_urdf.pasted.writer import TABLE_TEXTS
from dh_to_urdf.table import DHTable
from dh_to_urdf.writer import table_to_urdf

PASTED = (".tex", ".md", ".tsv", ".m", ".py", ".txt")


@dataclass(frozen=True)
class _Options:
    """What a file does not say itself."""

    convention: str | None
    name: str | None
    angle: str | None
    length: str
    values: str | None
    columns: str | None
    cut_loops: bool


@click.command()
@click.argument("table", type=click.Path(exists=True, dir_okay=False, allow_dash=True))
@click.option("-o", "--output", type=click.Path(dir_okay=False), help="URDF file; default: print.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["urdf", *TABLE_TEXTS]),
    default="urdf",
    help="What to write; default: urdf.",
)
@click.option("--convention", help="standard, modified or khalil; CSV and pasted text need it.")
@click.option("--name", help="Name of the robot, for CSV, .par and pasted text.")
@click.option("--angle", type=click.Choice(["rad", "deg"]), help="Angle unit of CSV, pasted text.")
@click.option("--length", type=click.Choice(["m", "mm"]), default="m", help="Their length unit.")
@click.option("--values", help="Numbers for names in the cells: D3:0.45,RL4:450mm.")
@click.option("--columns", help="Columns of pasted text without a heading: theta,d,a,alpha.")
@click.option("--cut-loops", is_flag=True, help="Read the spanning tree of a .par with loops.")
@click.option("--visuals/--no-visuals", default=True, help="Draw cylinders along a and d.")
@click.option("--lang", type=click.Choice(codes()), default="en", help="Language of messages.")
@click.option("--check", is_flag=True, help="Load the result with yourdfpy (extra: check).")
def main(
    table: str,
    output: str | None,
    form: str,
    convention: str | None,
    name: str | None,
    angle: str | None,
    length: str,
    values: str | None,
    columns: str | None,
    cut_loops: bool,
    visuals: bool,
    lang: str,
    check: bool,
) -> None:
    """Convert a Denavit-Hartenberg TABLE to URDF.

    TABLE is .json, .yaml, .csv, .par (SYMORO), or text with a table in it: .tex, .md, .tsv, .txt,
    .m or .py; - is standard input.
    """
    with click.open_file(table, "rb") as stream:
        content = stream.read()
    spoken = language(lang)
    options = _Options(convention, name, angle, length, values, columns, cut_loops)
    try:
        parsed = _read(table, content, options)
        text = None if form == "urdf" else TABLE_TEXTS[form].write(parsed)
    except DHError as error:
        for fault in error.faults:
            click.echo(spoken.text(str(fault)), err=True)
        raise SystemExit(1) from None
    for warning in parsed.warnings:
        click.echo(spoken.text(say("warning: {warning}", warning=warning)), err=True)
    if text is None:
        text = table_to_urdf(parsed, visuals=visuals) + "\n"
        if check:
            _check(text)
    if output is None:
        click.echo(text, nl=False)
    else:
        try:
            Path(output).write_text(text, encoding="utf-8")
        except OSError as error:
            raise click.ClickException(f"{output}: {error.strerror}") from None


def _read(path: str, content: bytes, options: _Options) -> DHTable:
    suffix, given = Path(path).suffix.lower(), options
    values = None if given.values is None else split_values(given.values)
    if suffix == ".par":
        return read_par(content, given.name, values, cut_loops=given.cut_loops)
    if suffix in PASTED:
        return read_pasted(
            content,
            given.convention,
            given.name,
            given.angle,
            given.length,
            values,
            given.columns,
        )
    if suffix == ".csv" or (suffix == "" and given.convention is not None):
        angle = given.angle or "rad"
        return read_csv(content, given.convention, given.name, angle, given.length, values)
    if values is not None:
        raise click.UsageError("--values is for text; a JSON or YAML table has a field values")
    if suffix == ".json":
        return read_json(content)
    return read_yaml(content)


def _check(urdf: str) -> None:
    """Load the URDF with an independent reader and fail where it complains."""
    try:
        from yourdfpy import URDF
    except ImportError:
        raise click.ClickException("--check needs yourdfpy: pip install 'denavit[check]'") from None
    import io

    robot = URDF.load(io.BytesIO(urdf.encode()), load_meshes=False, build_scene_graph=False)
    if not robot.validate():
        raise click.ClickException(f"yourdfpy finds the URDF invalid: {robot.errors}")
