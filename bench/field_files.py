"""URDFs from the field: how many load, what the others are refused for, and how exact the rest is.

    python -m bench.field_files FOLDER [--refusals] [--json report.json]

Every ``*.urdf`` below FOLDER is read by Pinocchio's own reader of texts and by this service's gate.
"Ought to load" are the files that Pinocchio reads, that hold a joint that moves, and whose
revolute and prismatic joints all have limits. Forward kinematics of every link of every file
that both read is compared at random q. Equal files are counted once.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from kinematics.forward import fk
from robots.errors import RobotError
from robots.robot import Robot, robot_from_urdf

_JOINT = re.compile(rb"<joint\b[^>]*?>.*?</joint\s*>", re.DOTALL)
_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_TYPE = re.compile(rb"""\btype\s*=\s*["'](revolute|prismatic|continuous)["']""")
_LIMIT = re.compile(rb"""<limit\b[^>]*>""")
_BOUND = re.compile(rb"""\b(?:lower|upper)\s*=""")
SAMPLES = 3


@dataclass(frozen=True)
class Reading:
    """What became of a file.

    Attributes:
        path: The file.
        pinocchio: Whether Pinocchio's reader takes it.
        moves: Whether it has a joint that moves.
        limited: Whether every revolute and prismatic joint has its limits.
        refusal: Why it is refused here; empty where it is read.
        seconds: CPU seconds of reading it here.
        difference: Largest difference of an element of a pose of a link, m or 1.
        dof: Entries of q.
    """

    path: str
    pinocchio: bool
    moves: bool
    limited: bool
    refusal: str
    seconds: float
    difference: float | None
    dof: int

    @property
    def ought(self) -> bool:
        return self.pinocchio and self.moves and self.limited


@contextmanager
def _silence() -> Iterator[None]:
    """Keep urdfdom's words away, which go to the file descriptors themselves."""
    kept = os.dup(2), os.dup(1)
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)
    os.dup2(null, 1)
    try:
        yield
    finally:
        os.dup2(kept[0], 2)
        os.dup2(kept[1], 1)
        for fd in (*kept, null):
            os.close(fd)


def _by_pinocchio(path: Path) -> Any:
    with _silence():
        try:
            return pin.buildModelFromUrdf(str(path))
        except Exception:  # it raises what boost and urdfdom raise; all mean "not read"
            return None


def _demands(content: bytes) -> tuple[bool, bool]:
    """Return whether a joint moves, and whether all that need limits have them."""
    moves, limited = False, True
    for block in _JOINT.findall(_COMMENT.sub(b"", content)):
        kind = _TYPE.search(block[: block.find(b">")])
        if kind is None:
            continue
        moves = True
        if kind[1] != b"continuous":
            limit = _LIMIT.search(block)
            limited = limited and limit is not None and len(_BOUND.findall(limit[0])) == 2
    return moves, limited


def largest_difference(robot: Robot, model: Any, rng: np.random.Generator) -> float:
    """Return the largest difference of the poses of the links that both know.

    Poses are taken in the axes of the link that the robot stands on.
    """
    data, worst = model.createData(), 0.0
    for _ in range(SAMPLES):
        q = rng.uniform(-1, 1, robot.dof)
        values = dict(zip((j.name for j in robot.moving), robot.joint_values(q), strict=True))
        configuration = pin.neutral(model)
        for joint_id in range(1, model.njoints):
            joint, value = model.joints[joint_id], values.get(model.names[joint_id])
            if value is None:
                continue
            at = joint.idx_q
            if joint.nq == 2:
                configuration[at : at + 2] = np.cos(value), np.sin(value)
            else:
                configuration[at] = value
        pin.framesForwardKinematics(model, data, configuration)
        base = data.oMf[model.getFrameId(robot.base_frame, pin.FrameType.BODY)]
        for name, T in fk(robot, q, robot.frames).items():
            frame_id = model.getFrameId(name, pin.FrameType.BODY)
            if frame_id < model.nframes:
                expected = (base.inverse() * data.oMf[frame_id]).homogeneous
                worst = max(worst, float(np.abs(T - expected).max()))
    return worst


def read(path: Path, rng: np.random.Generator) -> Reading:
    """Read a file by both, and compare."""
    content = path.read_bytes()
    model = _by_pinocchio(path)
    moves, limited = _demands(content)
    started = time.process_time()
    robot, refusal = None, ""
    try:
        robot = robot_from_urdf(content)
    except RobotError as error:
        refusal = str(error)
    seconds = time.process_time() - started
    difference = None
    if robot is not None and model is not None:
        difference = largest_difference(robot, model, rng)
    dof = 0 if robot is None else robot.dof
    return Reading(str(path), model is not None, moves, limited, refusal, seconds, difference, dof)


def _kind(refusal: str) -> str:
    """Return a refusal without its names and numbers, to count it."""
    text = re.sub(r"'[^']*'|\"[^\"]*\"", "…", refusal.splitlines()[0])
    return re.sub(r"[0-9][0-9.e+-]*", "#", text)[:110]


def main() -> int:
    """Read the folder and print the counts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--refusals", action="store_true", help="each refused file that ought to")
    parser.add_argument("--json", type=Path, help="write every reading here")
    options = parser.parse_args()
    rng, seen, found = np.random.default_rng(0), set(), []
    for path in sorted(options.folder.rglob("*")):
        if path.suffix.lower() != ".urdf" or not path.is_file():
            continue
        digest = hashlib.sha256(path.read_bytes()).digest()
        if digest not in seen:
            seen.add(digest)
            found.append(read(path, rng))
    ought = [one for one in found if one.ought]
    loaded = [one for one in ought if not one.refusal]
    compared = [one for one in found if one.difference is not None]
    print(f"files                       {len(found):6}")
    print(f"read by Pinocchio           {sum(one.pinocchio for one in found):6}")
    print(f"read here                   {sum(not one.refusal for one in found):6}")
    share = 100 * len(loaded) / max(1, len(ought))
    print(f"ought to load               {len(ought):6}")
    print(f"  of them read here         {len(loaded):6}  {share:.1f} %")
    if compared:
        worst = max(compared, key=lambda one: one.difference or 0.0)
        print(f"largest difference of FK    {worst.difference:.1e}  {worst.path}")
        slow = max(found, key=lambda one: one.seconds)
        print(f"longest reading             {slow.seconds:.3f} s  {slow.path}")
        print(f"most joints                 {max(one.dof for one in found):6}")
    print("refused here, read by Pinocchio:")
    kinds = Counter(_kind(one.refusal) for one in found if one.refusal and one.pinocchio)
    for kind, count in kinds.most_common():
        print(f"  {count:4}  {kind}")
    if options.refusals:
        print("each that ought to load:")
        for one in ought:
            if one.refusal:
                print(f"  {one.path}\n      {one.refusal}")
    if options.json is not None:
        options.json.write_text(json.dumps([asdict(one) for one in found], indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
