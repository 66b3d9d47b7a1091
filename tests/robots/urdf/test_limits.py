"""What passes the caps needs no killable child: little time, little memory, a small stack."""

import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from kinematics.forward import fk
from robots.errors import RobotTooLarge
from robots.robot import robot_from_urdf
from robots.urdf import MAX_BYTES, MAX_ELEMENTS
from tests.cost import within
from tests.torture import large_urdfs as large

ROOT = Path(__file__).parents[3]
SMALL_STACK = 128 * 1024
"""What a thread has on the leanest of common systems (musl)."""


LARGEST, TOO_LARGE = large.largest(), large.too_large()


def in_small_thread(call):
    """Result or exception of a call in a thread of little stack, and its seconds of CPU."""
    found = []

    def run():
        started = time.thread_time()
        try:
            found.append(call())
        except Exception as error:
            found.append(error)
        found.append(time.thread_time() - started)

    before = threading.stack_size(SMALL_STACK)
    try:
        thread = threading.Thread(target=run)
        thread.start()
    finally:
        threading.stack_size(before)
    thread.join()
    return found


@pytest.mark.parametrize("name", LARGEST)
def test_the_largest_documents_are_read_in_a_second_on_a_small_stack(name):
    def upload():
        robot = robot_from_urdf(LARGEST[name])
        fk(robot, np.zeros(robot.dof))
        return robot, robot_from_urdf(robot.urdf, base=robot.base_frame, tip=robot.tip_frame)

    (robot, again), seconds = in_small_thread(upload)
    assert (robot.dof, len(robot.frames)) == (200 if name == "hand" else 64, 300)
    assert again.revision == robot.revision
    assert within(seconds, 1)


@pytest.mark.parametrize("name", TOO_LARGE)
def test_what_is_too_large_is_refused_before_much_is_done(name):
    document, words = TOO_LARGE[name]
    error, seconds = in_small_thread(lambda: robot_from_urdf(document))
    assert isinstance(error, RobotTooLarge)
    assert words in str(error)
    assert len(str(error)) < 200
    assert within(seconds, 0.5)


def test_bytes_and_elements_are_counted_exactly():
    document = large.filled(large.chain(3), "\n")
    assert len(document) == MAX_BYTES
    assert robot_from_urdf(document).dof == 2
    with pytest.raises(RobotTooLarge, match="2000001 bytes"):
        robot_from_urdf(document + "\n")
    room = MAX_ELEMENTS - large.chain(3).count("<") + large.chain(3).count("</")
    assert robot_from_urdf(large.chain(3, beside="<gazebo/>" * room)).dof == 2
    with pytest.raises(RobotTooLarge, match="20001 elements"):
        robot_from_urdf(large.chain(3, beside="<gazebo/>" * (room + 1)))


MEMORY = """
import resource
import numpy as np
from kinematics.forward import fk
from robots.errors import RobotTooLarge
from robots.robot import robot_from_urdf
from tests.torture import large_urdfs as large

documents = [*large.largest().values(), *(text for text, _ in large.too_large().values())]
robot = robot_from_urdf(large.chain(3))
fk(robot, np.zeros(robot.dof))
started = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
for document in documents:
    try:
        robot = robot_from_urdf(document)
        fk(robot, np.zeros(robot.dof))
    except RobotTooLarge:
        pass
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - started)
"""


def test_no_document_takes_much_memory():
    command = [sys.executable, "-c", MEMORY]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert int(done.stdout) < 200_000
