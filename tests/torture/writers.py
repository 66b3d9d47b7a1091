"""Writers to kill: ``python -m tests.torture.writers DIRECTORY``.

Reads a line ``SEED NUMBER`` a time and forks as many writers, which write until they are killed;
says before and after each step what it is, in lines that are whole however writers end.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path
from random import Random

from dh_to_urdf import read_mapping
from robots.errors import RevisionMismatch, RobotNotFound
from robots.robot import Robot, robot_from_table
from robots.store import RobotStore

SHARED = "shared"


def robot_of(count: int, dof: int = 1) -> Robot:
    """A robot that carries a number."""
    joints = [{"type": "R", "alpha": 0, "a": 1, "d": 0}] * dof
    tool = {"xyz": [0, 0, count]}
    return robot_from_table(read_mapping({"convention": "dh", "joints": joints, "tool": tool}))


def number_in(robot: Robot) -> int:
    """The number that a robot carries."""
    assert robot.table is not None
    return round(robot.table.tool[2, 3])


def say(*words: object) -> None:
    os.write(1, (" ".join(map(str, words)) + "\n").encode())


def write(store: RobotStore, writer: int, rng: Random) -> None:
    """Robots of its own, put and deleted, and one that all writers count up by its revision."""
    parent, count = os.getppid(), rng.randrange(10**6)
    while os.getppid() == parent:
        count += 1
        name = f"w{writer}-{rng.randrange(3)}"
        chosen = rng.random()
        if chosen < 0.4:
            say("try", name, count)
            store.put(name, robot_of(count, rng.choice((1, 1, 6, 30))))
            say("done", name, count)
        elif chosen < 0.5:
            say("try", name, "none")
            with suppress(RobotNotFound):
                store.delete(name)
            say("done", name, "none")
        else:
            seen = store.get(SHARED).robot
            number = number_in(seen) + 1
            say("try", SHARED, number)
            try:
                store.put(SHARED, robot_of(number), if_match=(seen.revision,))
                say("done", SHARED, number)
            except RevisionMismatch:
                say("refused", SHARED, number)


def main() -> None:
    directory = Path(sys.argv[1])
    # Loads what a first store, robot and search load, once for all writers.
    store = RobotStore(directory)
    store.put(SHARED, robot_of(0))
    store.ids()
    say("ready")
    for line in sys.stdin:
        seed, number = map(int, line.split())
        children = []
        gate, gun = os.pipe()
        for writer in range(number):
            child = os.fork()
            if child == 0:
                os.close(gun)
                os.read(gate, 1)
                write(RobotStore(directory), writer, Random(seed * 1000 + writer))
                os._exit(0)
            children.append(child)
        say("writers", *children)
        os.close(gun)
        os.close(gate)
        for child in children:
            os.waitpid(child, 0)
        say("gone")


if __name__ == "__main__":
    main()
