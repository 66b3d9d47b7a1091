"""Faults that are collected while a URDF is read, so that one answer tells all of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

from lxml import etree

from robots.errors import InvalidURDF, URDFFault
from robots.urdf.markup import shown_tag

Read = TypeVar("Read")
_MOST = 1000
"""Faults that are kept; no answer shows so many."""


class Faults:
    """What is wrong with one document, in the order in which it is found."""

    def __init__(self) -> None:
        self._found: list[URDFFault] = []

    def __bool__(self) -> bool:
        return bool(self._found)

    def add(self, element: etree._Element | None, message: str) -> None:
        """Keep a fault of an element, or of the whole document."""
        if len(self._found) < _MOST:
            self._found.append(fault_at(element, message))

    def read(
        self, element: etree._Element | None, default: Read, reader: Callable[[], Read]
    ) -> Read:
        """Return what a reader of an element returns; where it refuses, keep why.

        Args:
            element: The element that is read.
            default: What stands for the value where it is refused; it is never computed with.
            reader: Reads, and raises ``InvalidURDF``.
        """
        try:
            return reader()
        except InvalidURDF as error:
            self.add(element, error.faults[0].message)
            return default

    def check(self) -> None:
        """Refuse the document if anything is wrong.

        Raises:
            InvalidURDF: With all faults, in the order of the text.
        """
        if self._found:
            self._found.sort(key=lambda fault: math.inf if fault.line is None else fault.line)
            raise InvalidURDF.of(self._found)


def fault_at(element: etree._Element | None, message: str) -> URDFFault:
    """Return a fault with the place of an element."""
    if element is None:
        return URDFFault(message)
    line: object = element.sourceline
    return URDFFault(message, line if isinstance(line, int) else None, xpath_of(element))


def xpath_of(element: etree._Element) -> str:
    """Return the XPath of an element: by name where a name tells it from its siblings."""
    steps: list[str] = []
    at: etree._Element | None = element
    while at is not None:
        parent = at.getparent()
        steps.append(_step(at, parent))
        at = parent
    return "/" + "/".join(reversed(steps))


def _step(element: etree._Element, parent: etree._Element | None) -> str:
    tag = str(element.tag)
    step = f"*[local-name()='{shown_tag(element)}']" if tag.startswith("{") else tag
    if parent is None:
        return step
    alike = [other for other in parent if other.tag == element.tag]
    name = element.get("name")
    is_plain = name is not None and 0 < len(name) <= 64 and name.isprintable()
    is_plain = is_plain and not set(str(name)) & set("'\"[]")
    is_own = sum(other.get("name") == name for other in alike) == 1
    if tag in ("link", "joint") and is_plain and is_own:
        return f"{step}[@name='{name}']"
    return f"{step}[{alike.index(element) + 1}]" if len(alike) > 1 else step
