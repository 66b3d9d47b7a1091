"""Links of the Robotics Toolbox for MATLAB and for Python, as their constructors make them.

``Link('d', 0.3, 'alpha', pi/2)``, ``Link([theta d a alpha sigma offset])``, ``RevoluteMDH(d=0.3)``:
a parameter that is not given is 0.
"""

from __future__ import annotations

from collections.abc import Sequence

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs.arrays import as_array
from dh_to_urdf.pasted.programs.harmless import LINK_NOTES
from dh_to_urdf.pasted.programs.numbers import as_scalar, real
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import (
    Array,
    Items,
    Link,
    Opaque,
    Placed,
    Scalar,
    Unread,
    Value,
)

CLASSES: dict[str, tuple[str | None, bool | None]] = {
    "Link": (None, None),
    "LinkDH": (None, None),
    "DHLink": ("R", False),
    "Revolute": ("R", False),
    "Prismatic": ("P", False),
    "RevoluteDH": ("R", False),
    "PrismaticDH": ("P", False),
    "RevoluteMDH": ("R", True),
    "PrismaticMDH": ("P", True),
}
"""Type and whether modified, of each class; None where the arguments say it."""
ORDER = ("theta", "d", "a", "alpha", "sigma", "offset")
"""Order of a vector of a link."""
PARAMETERS = ("theta", "d", "a", "alpha", "offset")
_NONE = float("nan")
LEFT_OUT = say("masses, inertias and motors of the links are left out")
KNOWN = say("theta, d, a, alpha, offset, qlim, sigma, flip, modified")
_POSITIONS = {
    "DHLink": ("d", "alpha", "theta", "a", "sigma", "mdh", "offset", "flip", "qlim"),
    **dict.fromkeys(("RevoluteDH", "RevoluteMDH"), ("d", "a", "alpha", "offset", "qlim", "flip")),
    **dict.fromkeys(
        ("PrismaticDH", "PrismaticMDH"), ("theta", "a", "alpha", "offset", "qlim", "flip")
    ),
}
"""Order of arguments without a name, in Python."""
_FLAGS: dict[str, tuple[str, Value]] = {
    "modified": ("mdh", True),
    "mdh": ("mdh", True),
    "standard": ("mdh", False),
    "std": ("mdh", False),
    "revolute": ("jointtype", "R"),
    "prismatic": ("jointtype", "P"),
    "flip": ("flip", True),
}


def make_link(
    name: str,
    line: int,
    arguments: Sequence[Value],
    keywords: dict[str, Value],
    warnings: list[str],
) -> Link:
    """Return the link that a class makes.

    Args:
        name: The class, one of :data:`CLASSES`.
        line: Where it stands.
        arguments: Its arguments; texts name the next one, as in MATLAB.
        keywords: Its named arguments, as in Python.
        warnings: Receives what is left out.

    Raises:
        DHError: An argument that is not read.
    """
    type_, modified = CLASSES[name]
    link = Link(line, type=type_, modified=modified)
    given: set[str] = set()
    vector = bool(arguments) and isinstance(arguments[0], (Array, Items))
    by_position = _POSITIONS.get(name, ())
    waiting = list(arguments[1:] if vector else arguments)
    if vector:
        _fill(link, as_vector(arguments[0], line), warnings)
        given.update(("theta", "d", "a", "alpha"))
    position = 0
    while waiting:
        value = waiting.pop(0)
        if isinstance(value, str):
            flag = value.lower()
            if flag in _FLAGS and not (waiting and isinstance(waiting[0], bool)):
                key, value = _FLAGS[flag]
                _set(link, key, value, line, warnings)
                continue
            if waiting:
                _once(given, value, line)
                _set(link, value, waiting.pop(0), line, warnings)
                continue
        elif not vector and not given and position < len(by_position):
            _set(link, by_position[position], value, line, warnings)
            position += 1
            continue
        raise refused(
            line,
            say(
                "{name} has an argument {value} that is not read; write 'd', 0.3, 'a',"
                " 0, 'alpha', pi/2 or d=0.3, a=0, alpha=pi/2",
                name=name,
                value=shown(value),
            ),
        )
    for key, value in keywords.items():
        if key in by_position[:position]:
            raise refused(line, say("{key} of the link stands twice; keep one", key=key))
        _set(link, key, value, line, warnings)
        given.add(key)
    return _settled(link, vector)


def shown(value: Value) -> str:
    """Return a value for a message."""
    if isinstance(value, Sum):
        return quoted(f"{value.plain + value.angle:g}")
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, Opaque):
        return say("({why}, line {line})", why=value.why, line=value.line)
    return say("of kind {name}", name=type(value).__name__)


def _once(given: set[str], key: str, line: int) -> None:
    if key in given and key.lower() in PARAMETERS:
        raise refused(line, say("{key} of the link stands twice; keep one", key=key))
    given.add(key)


def as_vector(value: Value, line: int) -> tuple[Scalar, ...]:
    """Return the 4 to 6 numbers of a vector of a link.

    Raises:
        DHError: It holds another number of them, or is no vector.
    """
    try:
        array = as_array(value)
    except Unread as error:
        raise refused(line, say("the vector of the link {error}", error=error)) from None
    elements = array.elements
    if not 4 <= len(elements) <= 6 or 1 not in array.shape:
        raise refused(
            line, say("a vector of a link has 4 to 6 numbers: {order}", order=", ".join(ORDER))
        )
    return elements


def from_vector(row: Sequence[Scalar], line: int, modified: bool | None) -> Link:
    """Return the link that a row theta, d, a, alpha and perhaps sigma and offset makes."""
    link = Link(line, modified=modified)
    _fill(link, row, [])
    return _settled(link, vector=True)


def _fill(link: Link, row: Sequence[Scalar], warnings: list[str]) -> None:
    for key, element in zip(ORDER, row, strict=False):
        _set(link, key, element, link.line, warnings)
    link.type = link.type or "R"
    # The Toolbox ignores the constant of the variable; a 0 there says nothing.
    own = "theta" if link.type == "R" else "d"
    cell = link.numbers.get(own)
    if cell is not None and isinstance(cell.value, Sum) and cell.value == Sum():
        del link.numbers[own]


def set_link(link: Link, key: str, value: Value, line: int, warnings: list[str]) -> None:
    """Set a property of a link after it was made.

    Raises:
        DHError: A property that is not read.
    """
    _set(link, key, value, line, warnings)
    if key.lower() in ("theta", "d") and isinstance(value, Sum) and value == Sum():
        own = "theta" if link.type == "R" else "d"
        if key.lower() == own:
            del link.numbers[own]


def _set(link: Link, key: str, value: Value, line: int, warnings: list[str]) -> None:
    name = key.lower() if key not in LINK_NOTES else key
    if name in PARAMETERS:
        _set_number(link, name, value, line)
    elif name == "sigma":
        link.type = _sigma(value, line)
    elif name == "qlim":
        link.limits = limits_of(value, line)
    elif name in ("mdh", "modified", "flip"):
        truth = _truth(value, key, line)
        if name == "flip":
            link.flipped = truth
        else:
            link.modified = truth
    elif name == "convention" and isinstance(value, str):
        if value.lower() not in ("standard", "modified"):
            raise refused(line, say("the convention of the link is {value}", value=quoted(value)))
        link.modified = value.lower() == "modified"
    elif name in ("jointtype", "type"):
        if not isinstance(value, str) or value.lower()[:1] not in ("r", "p"):
            raise refused(
                line, say("the type of the link is {value}; write 'R' or 'P'", value=shown(value))
            )
        link.type = value[0].upper()
    elif key in LINK_NOTES:
        if key not in ("name", "number", "parent", "mesh") and LEFT_OUT not in warnings:
            warnings.append(LEFT_OUT)
    else:
        raise refused(
            line,
            say(
                "the link has an unknown parameter {key}; known are {known}",
                key=quoted(key),
                known=KNOWN,
            ),
        )


def _set_number(link: Link, name: str, value: Value, line: int) -> None:
    if isinstance(value, Array) and len(value.elements) == 1:
        value = value.elements[0]
    if isinstance(value, Array) and not value.elements:
        return
    if isinstance(value, Opaque):
        raise refused(
            line,
            say(
                "{name} of the link is not known ({why}, line {line})",
                name=name,
                why=value.why,
                line=value.line,
            ),
        )
    try:
        link.numbers[name] = Placed(as_scalar(value), line)
    except Unread:
        raise refused(
            line, say("{name} of the link is {value}; give a number", name=name, value=shown(value))
        ) from None


def _sigma(value: Value, line: int) -> str:
    if isinstance(value, str) and value.lower()[:1] in ("r", "p"):
        return value[0].upper()
    try:
        found = real(value)
    except Unread:
        found = _NONE
    if found not in (0.0, 1.0):
        raise refused(line, say("sigma is {value}; give 0 (R) or 1 (P)", value=shown(value)))
    return "P" if found else "R"


def _truth(value: Value, key: str, line: int) -> bool:
    if isinstance(value, bool):
        return value
    try:
        found = real(value)
    except Unread:
        found = _NONE
    if found not in (0.0, 1.0):
        raise refused(
            line,
            say("{key} of the link is {value}; give true or false", key=key, value=shown(value)),
        )
    return found == 1.0


def limits_of(value: Value, line: int) -> tuple[Placed, Placed] | None:
    """Return lower and upper bound; None for an empty value.

    Raises:
        DHError: Not two numbers.
    """
    if value is None or (isinstance(value, (Array, Items)) and not as_array(value).elements):
        return None
    if isinstance(value, (Array, Items)):
        elements = as_array(value).elements
        if len(elements) == 2:
            lower, upper = elements
            for element in elements:
                if isinstance(element, Opaque):
                    raise refused(
                        line,
                        say(
                            "qlim is not known ({why}, line {line})",
                            why=element.why,
                            line=element.line,
                        ),
                    )
            return Placed(lower, line), Placed(upper, line)
    raise refused(line, say("qlim is {value}; write [lower upper]", value=shown(value)))


def _settled(link: Link, vector: bool) -> Link:
    """Return the link with the type as the Toolbox finds it: a given theta makes it prismatic."""
    numbers = link.numbers
    if link.type is None and "theta" in numbers and "d" in numbers and not vector:
        raise refused(
            link.line,
            say(
                "the link has theta and d; give the one that is constant, or 'revolute'"
                " or 'prismatic'"
            ),
        )
    if link.type is None:
        link.type = "P" if "theta" in numbers and "d" not in numbers else "R"
    return link
