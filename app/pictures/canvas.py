"""A drawing as SVG text."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from numpy.typing import ArrayLike

from robots.robot import FloatArray

FONT = "Helvetica, Arial, sans-serif"
INK, GRID = "#222222", "#dddddd"
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#000000")
"""The palette of Okabe and Ito, told apart by colour-blind eyes as well."""
GLYPH = 0.62
"""Width of a letter, on average, as a part of the size of the text."""


class Canvas:
    """Elements in the order in which they are drawn; y points down."""

    def __init__(self, width: float, height: float, title: str) -> None:
        self.width, self.height, self.title = width, height, title
        self.elements: list[str] = []

    def line(
        self,
        points: ArrayLike,
        color: str = INK,
        width: float = 1.0,
        *,
        dash: str | None = None,
        offset: float = 0.0,
        opacity: float = 1.0,
        closed: bool = False,
        fill: str = "none",
    ) -> None:
        """A polyline or polygon through points of shape (n, 2)."""
        rows = np.asarray(points, dtype=np.float64)
        path = " ".join(f"{x:.2f},{y:.2f}" for x, y in rows.tolist())
        name = "polygon" if closed else "polyline"
        attributes = {
            "points": path,
            "fill": fill,
            "stroke": color,
            "stroke-width": f"{width:g}",
            "stroke-linejoin": "round",
            "stroke-linecap": "round",
        }
        if dash:
            attributes["stroke-dasharray"] = dash
            attributes["stroke-linecap"] = "butt"
        if dash and offset:
            attributes["stroke-dashoffset"] = f"{offset:g}"
        if opacity < 1.0:
            attributes["opacity"] = f"{opacity:.2f}"
        self._add(name, attributes)

    def circle(
        self,
        center: Sequence[float] | FloatArray,
        radius: float,
        fill: str = "none",
        color: str = INK,
        width: float = 1.0,
        *,
        opacity: float = 1.0,
    ) -> None:
        """A circle."""
        self._add(
            "circle",
            {
                "cx": f"{center[0]:.2f}",
                "cy": f"{center[1]:.2f}",
                "r": f"{radius:.2f}",
                "fill": fill,
                "stroke": color,
                "stroke-width": f"{width:g}",
                "opacity": f"{opacity:.2f}",
            },
        )

    def text(
        self,
        at: Sequence[float],
        text: str,
        size: float = 11.0,
        *,
        anchor: str = "start",
        color: str = INK,
        bold: bool = False,
        turned: bool = False,
        halo: bool = False,
    ) -> None:
        """A line of text.

        ``turned`` by a quarter, to be read from the right; ``halo``: with a white edge, to be
        read over lines.
        """
        x, y = f"{at[0]:.2f}", f"{at[1]:.2f}"
        attributes = {
            "x": x,
            "y": y,
            "font-size": f"{size:g}",
            "text-anchor": anchor,
            "fill": color,
        }
        if bold:
            attributes["font-weight"] = "bold"
        if halo:
            attributes |= {"stroke": "#ffffff", "stroke-width": "3", "paint-order": "stroke"}
        if turned:
            attributes["transform"] = f"rotate(-90 {x} {y})"
        self._add("text", attributes, escape(text))

    def image(self, box: tuple[float, float, float, float], png: bytes) -> None:
        """A raster stretched over a box (x, y, width, height), its pixels as sharp squares."""
        x, y, width, height = (f"{value:.2f}" for value in box)
        data = base64.b64encode(png).decode("ascii")
        self._add(
            "image",
            {
                "x": x,
                "y": y,
                "width": width,
                "height": height,
                "preserveAspectRatio": "none",
                "image-rendering": "pixelated",
                "href": f"data:image/png;base64,{data}",
            },
        )

    def clip(self, name: str, box: tuple[float, float, float, float]) -> None:
        """Begins a group that shows nothing outside a box (x, y, width, height)."""
        x, y, width, height = box
        self.elements.append(
            f'<clipPath id="{name}"><rect x="{x:.2f}" y="{y:.2f}" width="{width:.2f}"'
            f' height="{height:.2f}"/></clipPath><g clip-path="url(#{name})">'
        )

    def end_clip(self) -> None:
        """Ends the group."""
        self.elements.append("</g>")

    def render(self) -> str:
        """The document."""
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width:g} {self.height:g}"'
            f' width="{self.width:g}" height="{self.height:g}" font-family="{FONT}" role="img">'
            f"<title>{escape(self.title)}</title>"
            f'<rect width="100%" height="100%" fill="#ffffff"/>{"".join(self.elements)}</svg>\n'
        )

    def _add(self, name: str, attributes: dict[str, str], content: str | None = None) -> None:
        told = " ".join(f"{key}={quoteattr(value)}" for key, value in attributes.items())
        self.elements.append(
            f"<{name} {told}/>" if content is None else f"<{name} {told}>{content}</{name}>"
        )
