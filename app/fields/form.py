"""The forms of a request: JSON, query and npy -> one typed request, from its declaration alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Annotated, Any, Generic, TypeVar, get_args, get_origin, get_type_hints
from weakref import WeakKeyDictionary

import msgspec
from numpy.typing import NDArray

from app.fields.field import KEY, Field, Parameter, Reading
from app.fields.installation import InstallationFields
from app.fields.lengths import in_metres, value_in_metres
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import COMPUTED
from app.http.strict_json import decode_json, validation_problem
from app.http.units import Units
from dh_to_urdf.messages import say
from robots.installation import Installation, installed
from robots.robot import Robot

R = TypeVar("R", bound=msgspec.Struct)
PLAIN = Field()
"""The declaration of a field that only a body gives, as JSON has it."""
_ROBOT = Annotated[
    msgspec.Raw,
    msgspec.Meta(
        description='A D-H table, {"urdf": text, "tip": …}, or the id of a stored robot.',
        extra_json_schema={
            "anyOf": [
                {"type": "string"},
                {"$ref": "#/components/schemas/DHTable"},
                {"$ref": "#/components/schemas/InlineURDF"},
            ]
        },
    ),
]


class _OneQ(msgspec.Struct, forbid_unknown_fields=True):
    """A body that gives one q and nothing else."""

    q: list[float]


_ONE_Q = msgspec.json.Decoder(_OneQ)


class RequestForm(Generic[R]):
    """How a request is given and read.

    Args:
        request: Its type, whose annotations declare the fields.
        installed: Whether base, tool and limits of the robot may be given besides.

    Attributes:
        fields: The declaration of each field.
        wire: What JSON is decoded to.
        inline: The same, with the field ``robot`` besides.
        parameters: Parameters of the GET form by name, each with the field that it belongs to.
    """

    def __init__(self, request: type[R], *, installed: bool = False) -> None:
        self.request = request
        types = get_type_hints(request, include_extras=True)
        told = msgspec.structs.fields(request)
        shared: tuple[str, ...] = ()
        if installed:
            shared = InstallationFields.__struct_fields__
            types |= get_type_hints(InstallationFields, include_extras=True)
            told += msgspec.structs.fields(InstallationFields)
        self.fields = {info.name: declaration(types[info.name]) for info in told}
        self._installation = tuple((name, self.fields[name], (name,)) for name in shared)
        self._wires: dict[str, Any] = {}
        defaults: dict[str, Any] = {}
        for info in told:
            field = self.fields[info.name]
            self._wires[info.name] = _wire_type(types[info.name], field)
            defaults[info.name] = _default_on_wire(info, field)
        self.required = tuple(name for name, one in defaults.items() if one is msgspec.NODEFAULT)
        members = [
            (name, wire) if name in self.required else (name, wire, defaults[name])
            for name, wire in self._wires.items()
        ]
        self.wire = _struct(request.__name__, members, request.__doc__)
        self.inline = _struct(
            f"Inline{request.__name__}", [*members, ("robot", _ROBOT)], request.__doc__
        )
        self.parameters: dict[str, tuple[str, Parameter]] = {
            parameter.name or name: (name, parameter)
            for name, field in self.fields.items()
            for parameter in field.parameters
        }
        self._others: WeakKeyDictionary[Robot, dict[str, Any]] = WeakKeyDictionary()
        # q before other long fields: what does not fit q does not fit the robot.
        own = [(name, self.fields[name]) for name in request.__struct_fields__]
        ordered = sorted(own, key=lambda item: (item[1].late, item[0] != "q"))
        self._in_order = tuple((name, field, (name,)) for name, field in ordered)

    def from_json(self, body: bytes, units: Units) -> msgspec.Struct:
        """Decode a body; its lengths in m.

        Raises:
            RequestProblem: 400 for text that is no JSON, 422 with a pointer for a wrong type.
        """
        scaled = in_metres(body, self.wire) if units.millimetres else body
        decoded: msgspec.Struct = decode_json(scaled, self.wire)
        return decoded

    def from_one_q(self, body: bytes, reading: Reading) -> R | None:
        """Return the request of a body that gives a list of numbers q and nothing else.

        What :meth:`from_json` and :meth:`resolved` make of it, in a third of the time; None for any
        other body, also of a request that has to give more.

        Raises:
            RequestProblem: q cannot be read.
            KinematicsError: It does not fit.
        """
        # Two quotes are those of the one key, so that none is doubled and no value is a text.
        if self.required != ("q",) or body.count(b'"') != 2 or not reading.units.are_si:
            return None
        try:
            values = _ONE_Q.decode(body).q
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
            return None
        others = self._others.get(reading.robot)
        if others is None:
            defaults = self.wire(q=values)
            others = {
                name: field.resolve(getattr(defaults, name), location, reading)
                for name, field, location in self._in_order
                if name != "q"
            }
            self._others[reading.robot] = others
        q = self.fields["q"].resolve(values, ("q",), reading)
        return self.request(q=q, **others)

    def from_query(self, query: Mapping[str, str], reading: Reading) -> msgspec.Struct:
        """Read the parameters of a GET form, whose names have been checked.

        Raises:
            RequestProblem: A value cannot be read, or a field is missing.
        """
        return self._complete(self._values(query, reading))

    def from_npy(
        self, name: str, array: NDArray[Any], query: Mapping[str, str], reading: Reading
    ) -> msgspec.Struct:
        """Take an array as one field, and the others from the query.

        Raises:
            RequestProblem: The query gives that field too, a value cannot be read, or a field is
                missing.
        """
        values = self._values(query, reading)
        if name in values:
            raise RequestProblem(
                INVALID_REQUEST,
                say("{name} is in the npy body and in the query", name=name),
                f"/{name}",
            )
        return self._complete({**values, name: array})

    def resolved(self, decoded: msgspec.Struct, reading: Reading) -> R:
        """Return the request, with every value in the units of ``kinematics``.

        Raises:
            RequestProblem: A value cannot be read.
            KinematicsError: A value does not fit.
        """
        given = reading.given
        for name, field, location in self._in_order:
            given[name] = field.resolve(getattr(decoded, name), location, reading)
        return self.request(**given)

    def installed(self, decoded: msgspec.Struct, reading: Reading) -> Reading:
        """Return what the other fields are read with: the robot as the request has it installed.

        Raises:
            RequestProblem: A placement cannot be read.
            WrongLimits: Limits do not fit the robot.
        """
        if not any(getattr(decoded, name) for name, *_ in self._installation):
            return reading
        found = {
            name: field.resolve(getattr(decoded, name), location, reading)
            for name, field, location in self._installation
        }
        robot, doubts = installed(reading.robot, Installation(**found)), reading.doubts
        doubts.about(robot)
        return replace(reading, robot=robot)

    def _values(self, query: Mapping[str, str], reading: Reading) -> dict[str, Any]:
        read: dict[str, dict[str, Any]] = {}
        for key, text in query.items():
            if key not in COMPUTED:
                name, parameter = self.parameters[key]
                read.setdefault(name, {})[key] = parameter.read(key, text, reading)
        found = {name: self.fields[name].gathered(name, values) for name, values in read.items()}
        if reading.units.millimetres:
            found = {name: value_in_metres(one, self.wire, name) for name, one in found.items()}
        return {name: self._checked(name, value) for name, value in found.items()}

    def _checked(self, name: str, value: Any) -> Any:
        wire = self._wires[name]
        if isinstance(value, msgspec.Struct) or get_args(wire)[:1] == (msgspec.Raw,):
            return value
        try:
            return msgspec.convert(value, wire)
        except msgspec.ValidationError as error:
            raise validation_problem(error, f"/{name}") from None

    def _complete(self, values: dict[str, Any]) -> msgspec.Struct:
        missing = next((name for name in self.required if name not in values), None)
        if missing is not None:
            raise RequestProblem(
                INVALID_REQUEST,
                say("the field {missing!r} is missing; give it", missing=missing),
                f"/{missing}",
            )
        return self.wire(**values)


@cache
def form_of(request: type[R], *, installed: bool = False) -> RequestForm[R]:
    """Return the form of a request type, the same for every computation that takes it.

    Args:
        request: Its type.
        installed: Whether base, tool and limits of the robot may be given besides.
    """
    return RequestForm(request, installed=installed)


def declaration(annotation: Any) -> Field:
    """Return what an annotated type declares; ``PLAIN`` where it declares nothing."""
    if get_origin(annotation) is Annotated:
        for meta in reversed(get_args(annotation)[1:]):
            extra = meta.extra if isinstance(meta, msgspec.Meta) else None
            if extra and KEY in extra:
                found: Field = extra[KEY]
                return found
    return PLAIN


def _wire_type(annotation: Any, field: Field) -> Any:
    if field.wire is None:
        return annotation
    metas = get_args(annotation)[1:] if get_origin(annotation) is Annotated else ()
    wire: Any = field.wire
    for meta in metas:
        wire = Annotated[wire, meta]
    return wire


def _default_on_wire(info: msgspec.structs.FieldInfo, field: Field) -> Any:
    if info.default is not msgspec.NODEFAULT:
        return field.written(info.default)
    if info.default_factory is not msgspec.NODEFAULT:
        return msgspec.field(default_factory=info.default_factory)
    return msgspec.NODEFAULT


def _struct(name: str, members: list[Any], doc: str | None) -> type[msgspec.Struct]:
    return msgspec.defstruct(
        name, members, kw_only=True, forbid_unknown_fields=True, namespace={"__doc__": doc}
    )
