"""Arrays of numbers as coloured rasters."""

from __future__ import annotations

import io

import numpy as np
import png

from app.pictures.canvas import INK, Canvas
from app.pictures.chart import Box, ticks
from robots.robot import FloatArray

_ANCHORS = np.array(
    [
        (68, 1, 84),
        (71, 44, 122),
        (59, 81, 139),
        (44, 113, 142),
        (33, 144, 141),
        (39, 173, 129),
        (92, 200, 99),
        (170, 220, 50),
        (253, 231, 37),
    ],
    dtype=np.float64,
)
"""Viridis (van der Walt and Smith, public domain) at equal steps: even to the eye, also in grey."""


def colored(values: FloatArray) -> FloatArray:
    """Values from 0 to 1 -> red, green, blue from 0 to 255; shape (...) -> (..., 3)."""
    places = np.linspace(0.0, 1.0, len(_ANCHORS))
    return np.stack([np.interp(values, places, _ANCHORS[:, k]) for k in range(3)], axis=-1)


def raster_png(values: FloatArray, empty: FloatArray | None = None) -> bytes:
    """A PNG file, one pixel a value.

    Args:
        values: Shape (rows, columns), 0 to 1; the first row is the lowest of the picture.
        empty: True where there is nothing: transparent.
    """
    rgb = colored(values[::-1])
    opaque = np.ones(values.shape) if empty is None else 1.0 - empty[::-1]
    rgba = np.concatenate((rgb, 255 * opaque[..., None]), axis=-1).round().astype(np.uint8)
    stream = io.BytesIO()
    writer = png.Writer(values.shape[1], values.shape[0], greyscale=False, alpha=True)
    writer.write(stream, rgba.reshape(len(values), -1))
    return stream.getvalue()


def color_bar(canvas: Canvas, box: Box, low: float, high: float) -> None:
    """The scale of a raster: low below, high above, in a box (x, y, width, height)."""
    x, y, width, height = box
    canvas.image(box, raster_png(np.linspace(0.0, 1.0, 64)[:, None]))
    canvas.line(
        [(x, y), (x + width, y), (x + width, y + height), (x, y + height)], INK, 0.8, closed=True
    )
    for value in ticks(low, high):
        at = y + height - (value - low) / (high - low or 1.0) * height
        canvas.line([(x + width, at), (x + width + 4, at)], INK, 0.8)
        canvas.text((x + width + 7, at + 3.5), f"{value + 0.0:.6g}", 10)
