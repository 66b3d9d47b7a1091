"""An arm as a skeleton: bones, joints, D-H frames with their names."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from app.pictures.camera import Camera, camera_for, view_of
from app.pictures.canvas import GLYPH, GRID, Canvas
from app.pictures.chart import Box, ticks
from kinematics.skeleton import Skeleton
from robots.robot import FloatArray

AXIS_COLORS = ("#d62728", "#2ca02c", "#1f5fbf")
BONE, JOINT = "#7a8794", "#2f3b47"
_DIGITS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_HALF = 5.5
"""Half the height of a label, pixels."""
_NUMBERED = re.compile(r"frame_(\d+)")
MARGIN = 34.0
LABEL, CAPTION = 11.0, 11.0
INSET = 14.0


def arm_figure(
    skeletons: Sequence[Skeleton],
    frames: Sequence[str],
    *,
    title: str,
    caption: Sequence[str] = (),
    view: str = "auto",
    labels: bool = True,
    size: tuple[float, float] = (640.0, 480.0),
) -> str:
    """Draws an arm at one q or several; the last is drawn solid, those before fainter.

    Args:
        skeletons: The arm at each q.
        frames: Names of the frames whose axes are drawn.
        title: Of the picture.
        caption: Lines below it.
        view: auto, iso, xy, xz or yz; auto is the plane in which a planar arm moves, else iso.
        labels: Whether the axes have names.
        size: Width and height, pixels.

    Returns:
        SVG text.
    """
    shown = skeletons[-1]
    chosen = view_of(shown.axes, shown.is_revolute) if view == "auto" else view
    points = np.concatenate([one.points for one in skeletons])
    extent = float((points.max(axis=0) - points.min(axis=0)).max())
    arrow = 0.11 * max(extent, 1e-6)
    tips = [
        shown.frames[name][:3, 3] + arrow * shown.frames[name][:3, k]
        for name in frames
        for k in range(3)
    ]
    everything = np.concatenate((points, np.array(tips).reshape(-1, 3), np.zeros((1, 3))))
    foot = 16.0 * len(caption) + 8
    box = (MARGIN, 32.0 + MARGIN / 2, size[0] - 2 * MARGIN, size[1] - 32 - foot - MARGIN)
    camera = camera_for(chosen, everything, box)
    canvas = Canvas(size[0], size[1], title)
    _ground(canvas, camera, chosen, everything)
    for number, one in enumerate(skeletons):
        _arm(canvas, camera, one, 0.3 if number < len(skeletons) - 1 else 1.0)
    room = (2.0, 30.0, size[0] - 2.0, size[1] - foot)
    _frames(canvas, camera, shown, frames, arrow, room if labels else None)
    canvas.text((INSET, 22), title, 15, bold=True)
    for line, text in enumerate(caption):
        canvas.text((INSET, size[1] - foot + 14 + 16 * line), text, CAPTION)
    return canvas.render()


def _ground(canvas: Canvas, camera: Camera, view: str, points: FloatArray) -> None:
    """Grid lines of z = 0, or of the plane that is looked at, through round coordinates."""
    across, up = {"xz": (0, 2), "yz": (1, 2)}.get(view, (0, 1))
    low, high = points.min(axis=0), points.max(axis=0)
    if view == "iso":
        half = 0.5 * float((high - low).max())
        low, high = (low + high) / 2 - half, (low + high) / 2 + half
    for along, other in ((across, up), (up, across)):
        values = ticks(float(low[along]), float(high[along]), 9)
        step = values[1] - values[0] if len(values) > 1 else 0.0
        for value in [values[0] - step, *values, values[-1] + step]:
            ends = np.zeros((2, 3))
            ends[:, along] = value
            ends[:, other] = low[other], high[other]
            canvas.line(camera.place(ends), GRID, 0.7)


def _arm(canvas: Canvas, camera: Camera, skeleton: Skeleton, opacity: float) -> None:
    for bone in sorted(skeleton.bones, key=lambda b: float(camera.depth(b).mean())):
        if np.ptp(bone, axis=0).max() > 1e-9:
            canvas.line(camera.place(bone), BONE, 7.0, opacity=opacity)
    half = 11.0 / camera.scale
    for origin, axis, is_revolute in zip(
        skeleton.origins, skeleton.axes, skeleton.is_revolute.tolist(), strict=True
    ):
        ends = camera.place(np.array([origin - half * axis, origin + half * axis]))
        across = float(np.hypot(*(ends[1] - ends[0])))
        if not is_revolute:
            canvas.line(ends, JOINT, 9.0, opacity=opacity)
            canvas.line(ends, "#ffffff", 5.0, opacity=opacity)
        elif across > 6.0:
            canvas.line(ends, JOINT, 12.0, opacity=opacity)
        else:
            canvas.circle(camera.place(origin), 7.0, "#ffffff", JOINT, 3.0, opacity=opacity)


def _frames(
    canvas: Canvas,
    camera: Camera,
    skeleton: Skeleton,
    names: Sequence[str],
    arrow: float,
    room: Box | None,
) -> None:
    """Axes, and their names where there is room for them."""
    taken: list[Box] = []
    for name in names:
        T = skeleton.frames[name]
        start = camera.place(T[:3, 3])
        for k, letter in enumerate("xyz"):
            end = camera.place(T[:3, 3] + arrow * T[:3, k])
            length = float(np.hypot(*(end - start)))
            if length < 2.0:
                canvas.circle(start, 2.6, AXIS_COLORS[k], AXIS_COLORS[k], 0.5)
            else:
                canvas.line([start, end], AXIS_COLORS[k], 1.6)
                canvas.line(
                    _head(start, end), AXIS_COLORS[k], 1.0, closed=True, fill=AXIS_COLORS[k]
                )
            if room is None or letter not in "xz":
                continue
            beside = end + (end - start) / max(length, 6.0) * 9.0 if length > 2 else end + 8.0
            text = _label(letter, name)
            at = _free(beside, GLYPH * LABEL * len(text) / 2, room, taken)
            if at is not None:
                canvas.text(
                    (at[0], at[1] + 4),
                    text,
                    LABEL,
                    anchor="middle",
                    color=AXIS_COLORS[k],
                    halo=True,
                )


def _head(start: FloatArray, end: FloatArray) -> FloatArray:
    along = (end - start) / np.hypot(*(end - start))
    across = np.array([-along[1], along[0]])
    return np.array([end, end - 6.0 * along + 2.4 * across, end - 6.0 * along - 2.4 * across])


def _label(letter: str, frame: str) -> str:
    numbered = _NUMBERED.fullmatch(frame)
    if numbered:
        return letter + numbered[1].translate(_DIGITS)
    return f"{letter} {frame[:24]}" if letter == "x" or frame == "tool" else letter


def _free(at: FloatArray, half: float, room: Box, taken: list[Box]) -> FloatArray | None:
    """The place, or the nearest one around it where no label stands yet; None for no room.

    Args:
        at: Middle of the label, pixels.
        half: Half its width.
        room: Left, top, right and bottom of where labels may stand.
        taken: x, y, half width and half height of those that stand; the new one is added.
    """
    left, top, right, bottom = room
    low, high = np.array([left + half, top + _HALF]), np.array([right - half, bottom - _HALF])
    start = np.clip(at, low, np.maximum(low, high))
    for ring in range(14):
        for turn in np.arange(8) * (np.pi / 4):
            spot = start + 7.0 * ring * np.array([np.cos(turn), np.sin(turn)])
            inside = bool((spot >= low).all() and (spot <= high).all())
            if inside and all(
                abs(x - spot[0]) >= wide + half or abs(y - spot[1]) >= tall + _HALF
                for x, y, wide, tall in taken
            ):
                taken.append((float(spot[0]), float(spot[1]), half, _HALF))
                return np.asarray(spot)
    return None


def letters_of(width: float) -> int:
    """How many letters of a caption fit into a picture of a width, pixels."""
    return int((width - 2 * INSET) / (GLYPH * CAPTION))


def caption_of(names: Sequence[str], values: Sequence[str], width: float, most: int) -> list[str]:
    """``name = value`` pairs in lines that fit into a picture.

    Args:
        names: Of the joints.
        values: Their values.
        width: Of the picture, pixels.
        most: Lines at most; what is left out shows as an ellipsis.
    """
    letters = letters_of(width)
    lines: list[str] = []
    for name, value in zip(names, values, strict=True):
        pair = f"{name} = {value}"
        if lines and len(lines[-1]) + 3 + len(pair) <= letters:
            lines[-1] += f"   {pair}"
        else:
            lines.append(pair)
    if len(lines) > most:
        return [*lines[: most - 1], f"{lines[most - 1][: letters - 2]} …"]
    return lines
