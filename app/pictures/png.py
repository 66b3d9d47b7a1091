"""SVG -> PNG, by resvg with the fonts of this folder: the same picture on every machine."""

from __future__ import annotations

from importlib.resources import as_file, files

import resvg_py

FAMILY = "DejaVu Sans"


def png_of(svg: str, zoom: float = 1.0) -> bytes:
    """Renders a drawing.

    Args:
        svg: SVG text of this package.
        zoom: Pixels a unit of the drawing.

    Returns:
        A PNG file.
    """
    with as_file(files("app.pictures") / "fonts") as folder:
        return resvg_py.svg_to_bytes(
            svg_string=svg,
            zoom=zoom,
            skip_system_fonts=True,
            font_dirs=[str(folder)],
            font_family=FAMILY,
            sans_serif_family=FAMILY,
        )
