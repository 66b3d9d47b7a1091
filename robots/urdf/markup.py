"""Text -> XML elements: one strict parse by libxml2, with limits on size and nesting."""

from __future__ import annotations

import re

from lxml import etree

from dh_to_urdf.messages import say
from robots.errors import InvalidURDF, RobotTooLarge
from robots.urdf.limits import MAX_ATTRIBUTES, MAX_ELEMENTS

UNDECLARED = "urn:undeclared:"
"""Namespaces of prefixes that a text does not declare begin so."""
_PREFIXED = re.compile(r"[<\s/]([A-Za-z_][\w.-]{0,31}):[A-Za-z_]")
_ROOT = re.compile(r"<robot(?=[\s>])")
_UNDEFINED_PREFIX = etree.ErrorTypes.NS_ERR_UNDEFINED_NAMESPACE
_REASONS = {
    "ERR_DOCUMENT_EMPTY": say("there is no element"),
    "ERR_DOCUMENT_END": say("something stands after the root element"),
    "ERR_TAG_NAME_MISMATCH": say("mismatched tag"),
    "ERR_TAG_NOT_FINISHED": say("a tag is not closed; the text ends too soon"),
    "ERR_GT_REQUIRED": say("a tag lacks its >"),
    "ERR_LTSLASH_REQUIRED": say("a tag lacks its </"),
    "ERR_NAME_REQUIRED": say("a name is missing"),
    "ERR_SPACE_REQUIRED": say("a blank is missing"),
    "ERR_ATTRIBUTE_NOT_STARTED": say("the value of an attribute has no quotes"),
    "ERR_ATTRIBUTE_NOT_FINISHED": say("the value of an attribute is not closed"),
    "ERR_ATTRIBUTE_WITHOUT_VALUE": say("an attribute has no value"),
    "ERR_ATTRIBUTE_REDEFINED": say("an attribute stands twice in one tag"),
    "ERR_LT_IN_ATTRIBUTE": say("the value of an attribute holds <; write &lt;"),
    "ERR_UNDECLARED_ENTITY": say("an entity such as &x; is not declared; write & as &amp;"),
    "ERR_ENTITYREF_SEMICOL_MISSING": say("an & stands alone; write &amp;"),
    "ERR_INVALID_CHARREF": say("a character reference such as &#0; is none"),
    "ERR_INVALID_CHAR": say("a character that XML does not have"),
    "ERR_COMMENT_NOT_FINISHED": say("a comment is not closed by -->"),
    "ERR_HYPHEN_IN_COMMENT": say("a comment holds --"),
    "ERR_CDATA_NOT_FINISHED": say("a CDATA section is not closed by ]]>"),
    "ERR_MISPLACED_CDATA_END": say("]]> stands outside a CDATA section"),
    "ERR_PI_NOT_FINISHED": say("a processing instruction is not closed by ?>"),
    "ERR_RESERVED_XML_NAME": say("<?xml stands elsewhere than at the start"),
    "ERR_NAME_TOO_LONG": say("a name is too long"),
    "ERR_RESOURCE_LIMIT": say("it is nested too deeply, or a part of it is too long"),
    "NS_ERR_UNDEFINED_NAMESPACE": say(
        "the prefix of a name such as xacro: is not declared; expand xacro files first"
    ),
    "NS_ERR_XML_NAMESPACE": say("a namespace is not declared as it must be"),
    "NS_ERR_QNAME": say("a name has two colons"),
    "NS_ERR_ATTRIBUTE_REDEFINED": say("an attribute stands twice in one tag"),
}


def parse(text: str) -> etree._Element:
    """Parse a text and return its root element.

    Args:
        text: The text, without XML declaration and DOCTYPE.

    Raises:
        InvalidURDF: Not well-formed; the message has line and column.
        RobotTooLarge: More elements, or attributes of one element, than any robot needs.
    """
    parser = etree.XMLParser(
        encoding="utf-8",
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        dtd_validation=False,
        huge_tree=False,
        recover=False,
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(text.encode(), parser)
    except etree.XMLSyntaxError as error:
        declared = _with_prefixes(text) if getattr(error, "code", 0) == _UNDEFINED_PREFIX else None
        if declared is None:
            raise InvalidURDF(
                say("the text is not well-formed XML: {error}", error=_reason(error))
            ) from None
        try:
            root = etree.fromstring(declared.encode(), parser)
        except etree.XMLSyntaxError as other:
            raise InvalidURDF(
                say("the text is not well-formed XML: {other}", other=_reason(other))
            ) from None
    if root.getroottree().docinfo.internalDTD is not None:
        raise InvalidURDF(say("the URDF has a DOCTYPE or entities; remove them"))
    elements = root.xpath("count(//*)")
    assert isinstance(elements, float)
    if elements > MAX_ELEMENTS:
        raise RobotTooLarge(
            say(
                "the URDF has {elements:.0f} elements; at most {max_elements} are read",
                elements=elements,
                max_elements=MAX_ELEMENTS,
            )
        )
    for element in root.iter():
        if len(element.attrib) > MAX_ATTRIBUTES:
            raise RobotTooLarge(
                say(
                    "an element <{element}> has {count} attributes; at most"
                    " {max_attributes} are read",
                    element=shown_tag(element),
                    count=len(element.attrib),
                    max_attributes=MAX_ATTRIBUTES,
                )
            )
    _drop_default_namespace(root)
    return root


def _with_prefixes(text: str) -> str | None:
    """Declare prefixes such as ``drake:`` that a text uses without; None for xacro."""
    found = dict.fromkeys(_PREFIXED.findall(text))
    names = [name for name in found if name not in ("xml", "xmlns") and f"xmlns:{name}" not in text]
    root = _ROOT.search(text)
    if root is None or not names or len(names) > 16 or "xacro" in names:
        return None
    declarations = "".join(f' xmlns:{name}="{UNDECLARED}{name}"' for name in names)
    return text[: root.end()] + declarations + text[root.end() :]


def _drop_default_namespace(root: etree._Element) -> None:
    """Remove the namespace that ``xmlns="…"`` of the root gives to elements.

    URDF has no namespace, and its readers compare names as written.
    """
    default = root.nsmap.get(None)
    if default is not None:
        for element in root.iter():
            if not element.prefix:
                element.tag = str(element.tag).removeprefix(f"{{{default}}}")


def shown_tag(element: etree._Element) -> str:
    """Return the name of an element without its namespace, cleaned and shortened for a message."""
    return re.sub(r"[^\w:./-]", "", str(element.tag).rpartition("}")[2])[:40]


def _reason(error: etree.XMLSyntaxError) -> str:
    """Return line, column and cause in own words; the library's would echo the input."""
    line, column = error.position
    place = say("line {line}, column {column}: ", line=line, column=column) if line else ""
    return place + _REASON_BY_CODE.get(getattr(error, "code", 0), say("a syntax error"))


_REASON_BY_CODE = {getattr(etree.ErrorTypes, name): text for name, text in _REASONS.items()}
