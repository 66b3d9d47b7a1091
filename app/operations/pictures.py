"""picture.svg and picture.png: the arm with its frames, without a browser."""

from __future__ import annotations

from typing import Annotated, TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields import texts
from app.fields.field import Field, Parameter, declared
from app.fields.joints import Configuration, is_one
from app.fields.names import one_of
from app.fields.numbers import within_query
from app.http.negotiation import PNG, SVG
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.operation import Answer, Context, Operation, Runs
from app.operations.sizes import ROOM, rows_of
from app.pictures.arm_figure import arm_figure, caption_of, letters_of
from app.pictures.camera import VIEWS
from dh_to_urdf.messages import say
from kinematics.forward import fk
from kinematics.skeleton import skeleton_of
from robots.robot import FloatArray, Robot

MOST_ARMS, MOST_FRAMES = 32, 100
SIZES = (200, 2000)
MOST_VALUES, MOST_LINES = 24, 3
LIGHT_DOF = 10
DRAWN, PIXEL = 3_000, 12
"""Bytes of a drawn frame of an arm, and of a pixel."""


class PictureRequest(msgspec.Struct, kw_only=True):
    """What to draw."""

    q: Configuration
    frames: Annotated[
        list[str] | str | None,
        declared(
            Field(
                (Parameter(texts.names, "Frame names, comma-separated, or all; default the tip."),)
            ),
            'Frames whose axes are drawn: names, "all" or "none"; default the frames of the D-H'
            " table, or base and tip.",
        ),
    ] = None
    view: Annotated[
        str,
        declared(
            Field((Parameter(texts.text, "auto (default), iso, xy, xz or yz."),)),
            "auto (default: the plane in which a planar arm moves, else iso), iso, xy, xz or yz, in"
            " base axes.",
            one_of(VIEWS),
        ),
    ] = "auto"
    labels: Annotated[
        bool,
        declared(
            Field((Parameter(texts.flag, "true (default) or false: names of the axes."),)),
            "Whether the axes have names.",
        ),
    ] = True
    width: Annotated[
        int,
        within_query(
            *SIZES, "Pixels, 200 to 2000.", "Pixels, 200 to 2000; default 640.", texts.integer
        ),
    ] = 640
    height: Annotated[
        int,
        within_query(
            *SIZES, "Pixels, 200 to 2000.", "Pixels, 200 to 2000; default 480.", texts.integer
        ),
    ] = 480


class PictureAnswer(TypedDict):
    """A picture has no JSON form."""


def _draw(robot: Robot, request: PictureRequest, context: Context) -> Answer:
    q = np.atleast_2d(request.q)
    if len(q) > MOST_ARMS:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "q holds {count} rows; give at most {most_arms} to draw",
                count=len(q),
                most_arms=MOST_ARMS,
            ),
            "/q",
        )
    if request.view not in VIEWS:
        raise RequestProblem(
            INVALID_REQUEST,
            say("view is {view!r}; give {views}", view=request.view[:32], views=", ".join(VIEWS)),
            "/view",
        )
    for name in ("width", "height"):
        value = getattr(request, name)
        if not SIZES[0] <= value <= SIZES[1]:
            raise RequestProblem(
                INVALID_REQUEST,
                say(
                    "{name} is {value}; give {size} to {size_2}",
                    name=name,
                    value=value,
                    size=SIZES[0],
                    size_2=SIZES[1],
                ),
                f"/{name}",
            )
    frames = _frames(robot, request.frames)
    svg = arm_figure(
        [skeleton_of(robot, row) for row in q],
        frames,
        title=robot.name[:60],
        caption=_caption(robot, q[-1], context, float(request.width)),
        view=request.view,
        labels=request.labels,
        size=(float(request.width), float(request.height)),
    )
    return Answer({}, picture=lambda: svg)


def _frames(robot: Robot, asked: list[str] | str | None) -> list[str]:
    if asked is None and robot.table is not None:
        asked = [name for name in robot.frames if name != "base_link"]
    elif asked is None:
        asked = [robot.base_frame, robot.tip_frame]
    elif asked == "all":
        asked = list(robot.frames)
    elif asked in ("none", ["none"]) and "none" not in robot.frames:
        asked = []
    names = [asked] if isinstance(asked, str) else list(dict.fromkeys(asked))
    for index, name in enumerate(names):
        robot.frame_id(name, "frames", (index,))
    return names[:MOST_FRAMES]


def _caption(robot: Robot, q: FloatArray, context: Context, width: float) -> list[str]:
    shown = context.units.joints_out(robot, q)
    degrees = context.units.degrees
    values = [
        f"{value:.4g}" + ("°" if degrees and is_revolute else "" if is_revolute else " m")
        for value, is_revolute in zip(shown.tolist(), robot.is_revolute.tolist(), strict=True)
    ]
    tip = fk(robot, q)[robot.tip_frame][:3, 3]
    place = ", ".join(f"{value + 0.0:.4f}" for value in tip.tolist())
    names = [joint.name[:24] for joint in robot.joints]
    few = robot.dof <= MOST_VALUES
    joints = (
        caption_of(names, values, width, MOST_LINES)
        if few
        else [say("{dof} joints", dof=robot.dof)]
    )
    where = say(" at ({place}) m", place=place)
    return [*joints, robot.tip_frame[: min(40, letters_of(width) - len(where))] + where]


def _memory(robot: Robot, request: PictureRequest, context: Context) -> Need:
    arms = min(rows_of(request.q), MOST_ARMS)
    drawn = arms * len(robot.frames) * DRAWN
    if context.form != SVG:
        drawn += PIXEL * request.width * request.height
    return Need(0.0, fixed=ROOM + drawn)


def _attempt(robot: Robot, request: PictureRequest, context: Context) -> Answer | None:
    light = robot.dof <= LIGHT_DOF and is_one(request.q)
    return _draw(robot, request, context) if light else None


def _picture(form: str) -> Operation:
    word = form.partition("/")[2].partition("+")[0]
    in_loop = form == SVG
    return Operation(
        name=f"picture.{word}",
        summary=f"Picture of the arm as {word.upper()}",
        description="The arm as a skeleton with the axes of its frames. Links of a D-H table go"
        " along the common normal and the joint axis, as a and d are measured. Several q are drawn"
        " over each other, the last one solid.",
        request=PictureRequest,
        answer=PictureAnswer,
        memory=_memory,
        run=_draw,
        example={"q": [0.3, -0.6, 0.4, 0.2, 0.5, 0]},
        example_robot="puma560",
        forms=(form,),
        runs=Runs.EVENT_LOOP if in_loop else Runs.THREAD,
        attempt=_attempt if in_loop else None,
    )


PICTURE_SVG, PICTURE_PNG = _picture(SVG), _picture(PNG)
