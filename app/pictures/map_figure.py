"""Maps of what an arm can do: where it gets, and where it is dexterous."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.pictures.canvas import Canvas
from app.pictures.plane import draw_axes, draw_border, equal_plane, stretched_plane
from app.pictures.raster import color_bar, raster_png
from app.pictures.scene import PLANES
from robots.robot import FloatArray

SIDE, CELLS = 380.0, 190


def workspace_figure(points: FloatArray, title: str) -> str:
    """How often points fall where, in the planes in which they spread.

    Args:
        points: Shape (n, 3), m.
        title: Of the picture.

    Returns:
        SVG text.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    spread = high - low
    half = 0.53 * max(float(spread.max()), 1e-3)
    middle = (low + high) / 2
    flat = [
        name for name, (a, b) in PLANES.items() if min(spread[a], spread[b]) > 1e-6 * spread.max()
    ]
    names = flat or ["xy"]
    canvas = Canvas(len(names) * SIDE + 20, SIDE + 50, title)
    canvas.text((14, 22), title, 15, bold=True)
    for number, name in enumerate(names):
        a, b = PLANES[name]
        corner, opposite = middle[[a, b]] - half, middle[[a, b]] + half
        plane = equal_plane((10 + number * SIDE, 36, SIDE, SIDE), corner, opposite)
        draw_axes(canvas, plane, f"{name[0]} [m]", f"{name[1]} [m]")
        columns, rows = CELLS, round(CELLS * plane.box[3] / plane.box[2])
        counts, _, _ = np.histogram2d(
            points[:, a],
            points[:, b],
            (columns, rows),
            list(zip(plane.low, plane.high, strict=True)),
        )
        shade = np.log1p(counts.T)
        top = shade.max()
        canvas.image(plane.box, raster_png(shade / top if top else shade, counts.T == 0))
        draw_border(canvas, plane)
    return canvas.render()


def heat_figure(
    x: FloatArray, y: FloatArray, values: FloatArray, labels: Sequence[str], title: str
) -> str:
    """Values over a grid as colours.

    Args:
        x: Places across, shape (n,), evenly spaced.
        y: Places up, shape (m,), evenly spaced.
        values: Shape (m, n), not negative.
        labels: Of the two axes and of the values.
        title: Of the picture.

    Returns:
        SVG text.
    """
    canvas = Canvas(SIDE + 120, SIDE + 50, title)
    canvas.text((14, 22), title, 15, bold=True)
    margin = np.array([x[1] - x[0], y[1] - y[0]]) / 2
    low, high = np.array([x[0], y[0]]) - margin, np.array([x[-1], y[-1]]) + margin
    plane = stretched_plane((20, 36, SIDE, SIDE), low, high)
    draw_axes(canvas, plane, labels[0], labels[1])
    top = float(values.max())
    canvas.image(plane.box, raster_png(values / top if top > 0 else values))
    draw_border(canvas, plane)
    bar = (plane.box[0] + plane.box[2] + 16, plane.box[1], 14.0, plane.box[3])
    color_bar(canvas, bar, 0.0, top or 1.0)
    canvas.text((bar[0], bar[1] - 6), labels[2], 10)
    return canvas.render()
