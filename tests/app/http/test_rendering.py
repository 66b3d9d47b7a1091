"""Exceptions as the API tells them: data from below, the remedy in words of the API."""

import pytest

from app.http.rendering import RENDERINGS, rendered
from dh_to_urdf.errors import DHError, DHSyntaxError, Fault
from kinematics.errors import KinematicsError
from robots import errors
from robots.errors import (
    DAMAGED,
    AnothersRobot,
    DamagedRobot,
    InvalidRobotId,
    InvalidURDF,
    MeshNotFound,
    QuotaReached,
    ReadOnlyRobot,
    RevisionMismatch,
    RobotError,
    RobotExists,
    RobotNotFound,
    RobotTooLarge,
    SharedRobot,
    StorageError,
    StorageFull,
    StorageUnavailable,
    UnknownFrame,
)


@pytest.mark.parametrize(
    ("error", "status", "pointer", "message"),
    [
        (InvalidURDF("no joint moves", ("joints",)), 422, "/joints", "no joint moves"),
        (InvalidURDF("no <robot>"), 422, "", "no <robot>"),
        (RobotTooLarge("65 joints", ("robot", "urdf")), 422, "/robot/urdf", "65 joints"),
        (
            UnknownFrame("tol", ("base", "tool")),
            422,
            "/frame",
            "frame 'tol' is unknown; did you mean tool?",
        ),
        (
            UnknownFrame("x", ("base", "tool"), "secondary", (0, "frame")),
            422,
            "/secondary/0/frame",
            "frame 'x' is unknown; known are base, tool",
        ),
        (
            RobotNotFound("probe", ("ur5",), 30),
            404,
            "",
            "there is no robot 'probe'; known are ur5 and 18 more",
        ),
        (
            InvalidRobotId("a b"),
            422,
            "/name",
            "'a b' cannot be a robot's id; use letters, digits and . _ - (at most 64, starting with"
            " a letter or digit)",
        ),
        (
            MeshNotFound("ur5", "base.dae", ()),
            404,
            "",
            "robot 'ur5' has no mesh 'base.dae'; no mesh of it is kept here",
        ),
        (
            RobotExists("probe"),
            409,
            "",
            "robot 'probe' exists already; choose another name, or repeat the request with"
            " ?overwrite=true to replace it",
        ),
        (
            AnothersRobot("probe"),
            428,
            "",
            "the id 'probe' holds another robot, perhaps of somebody else; to replace it, send"
            " If-Match with its ETag (GET /v1/robots/probe), or add ?overwrite=true; else choose"
            " another id",
        ),
        (
            AnothersRobot("probe", "delete"),
            428,
            "",
            "the id 'probe' holds another robot, perhaps of somebody else; to delete it, send"
            " If-Match with its ETag (GET /v1/robots/probe), or add ?overwrite=true",
        ),
        (
            SharedRobot("probe"),
            403,
            "",
            "robot 'probe' is shared by all and not changed by this key; one of scope share changes"
            " it; PUT stores a robot of your own under this id",
        ),
        (
            ReadOnlyRobot("ur5"),
            409,
            "",
            "robot 'ur5' is shipped with the service and read-only; choose another id",
        ),
        (
            RevisionMismatch("probe", "abc"),
            412,
            "",
            "robot 'probe' is at revision abc; read it again and repeat the request",
        ),
        (
            RevisionMismatch("probe", None),
            412,
            "",
            "robot 'probe' does not exist; read it again and repeat the request",
        ),
        (
            RevisionMismatch("probe", DAMAGED),
            412,
            "",
            "robot 'probe' is damaged; upload it without If-Match",
        ),
        (
            DamagedRobot("probe", "was found damaged", moved=True),
            409,
            "",
            "the stored file of robot 'probe' was found damaged; it was moved to quarantine; upload"
            " the robot again (PUT /v1/robots/probe), or delete it",
        ),
        (
            DamagedRobot("probe", "cannot be read", moved=False),
            409,
            "",
            "the stored file of robot 'probe' cannot be read; upload the robot again (PUT"
            " /v1/robots/probe), or delete it",
        ),
        (
            QuotaReached("robots", 50),
            409,
            "",
            "the store takes 50 uploaded robots at most (DENAVIT_MAX_ROBOTS), and this robot would"
            " exceed that; delete robots (DELETE /v1/robots/{id}), or send the robot in the body of"
            " a computation: that stores nothing",
        ),
        (
            QuotaReached("bytes", 1000),
            409,
            "",
            "the store takes 1000 bytes of uploaded robots at most (DENAVIT_MAX_STORED_BYTES), and"
            " this robot would exceed that; delete robots (DELETE /v1/robots/{id}), or send the"
            " robot in the body of a computation: that stores nothing",
        ),
        (
            StorageFull(),
            507,
            "",
            "the disk of the service is full and the robot was not stored; what was stored before"
            " is intact; delete robots, or have the operator make room, then repeat the request",
        ),
        (
            StorageUnavailable("the stored robots cannot be read now"),
            503,
            "",
            "the stored robots cannot be read now; shipped robots and robots in the body of a"
            " request work; repeat the request later",
        ),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, Exception) else "",
)
def test_what_a_client_reads(error, status, pointer, message):
    type_, (entry,), headers = rendered(error)
    assert (type_.status, entry.pointer, entry.message) == (status, pointer, message)
    assert headers == ({"Retry-After": "5"} if isinstance(error, StorageUnavailable) else {})


def test_each_fault_of_a_document_is_an_entry():
    faults = [Fault(("joints", 0, "a"), "a is 'foo'"), Fault((), "no convention")]
    type_, entries, headers = rendered(DHError(faults))
    assert (type_.slug, type_.status, headers) == ("invalid-table", 422, {})
    assert [(entry.pointer, entry.message) for entry in entries] == [
        ("/joints/0/a", "a is 'foo'"),
        ("", "no convention"),
    ]
    assert rendered(DHSyntaxError.single((), "not YAML"))[0].status == 400


def test_every_exception_of_the_packages_below_has_a_rendering():
    roots = (RobotError, StorageError, KinematicsError)
    named = [one for one in vars(errors).values() if isinstance(one, type)]
    leaves = [one for one in named if issubclass(one, roots) and one not in roots]
    assert [one for one in leaves if one not in RENDERINGS] == []
    assert all(issubclass(one, (*roots, DHError)) for one in RENDERINGS)
