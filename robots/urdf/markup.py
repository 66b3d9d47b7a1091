"""Text -> XML elements: one strict parse by libxml2, with limits on size and nesting."""

from __future__ import annotations

import re

from lxml import etree

from robots.errors import InvalidURDF, RobotTooLarge
from robots.urdf.limits import MAX_ATTRIBUTES, MAX_ELEMENTS

UNDECLARED = "urn:undeclared:"
"""Namespaces of prefixes that a text does not declare begin so."""
_PREFIXED = re.compile(r"[<\s/]([A-Za-z_][\w.-]{0,31}):[A-Za-z_]")
_ROOT = re.compile(r"<robot(?=[\s>])")
_UNDEFINED_PREFIX = etree.ErrorTypes.NS_ERR_UNDEFINED_NAMESPACE
_REASONS = {
    "ERR_DOCUMENT_EMPTY": "there is no element",
    "ERR_DOCUMENT_END": "something stands after the root element",
    "ERR_TAG_NAME_MISMATCH": "mismatched tag",
    "ERR_TAG_NOT_FINISHED": "a tag is not closed; the text ends too soon",
    "ERR_GT_REQUIRED": "a tag lacks its >",
    "ERR_LTSLASH_REQUIRED": "a tag lacks its </",
    "ERR_NAME_REQUIRED": "a name is missing",
    "ERR_SPACE_REQUIRED": "a blank is missing",
    "ERR_ATTRIBUTE_NOT_STARTED": "the value of an attribute has no quotes",
    "ERR_ATTRIBUTE_NOT_FINISHED": "the value of an attribute is not closed",
    "ERR_ATTRIBUTE_WITHOUT_VALUE": "an attribute has no value",
    "ERR_ATTRIBUTE_REDEFINED": "an attribute stands twice in one tag",
    "ERR_LT_IN_ATTRIBUTE": "the value of an attribute holds <; write &lt;",
    "ERR_UNDECLARED_ENTITY": "an entity such as &x; is not declared; write & as &amp;",
    "ERR_ENTITYREF_SEMICOL_MISSING": "an & stands alone; write &amp;",
    "ERR_INVALID_CHARREF": "a character reference such as &#0; is none",
    "ERR_INVALID_CHAR": "a character that XML does not have",
    "ERR_COMMENT_NOT_FINISHED": "a comment is not closed by -->",
    "ERR_HYPHEN_IN_COMMENT": "a comment holds --",
    "ERR_CDATA_NOT_FINISHED": "a CDATA section is not closed by ]]>",
    "ERR_MISPLACED_CDATA_END": "]]> stands outside a CDATA section",
    "ERR_PI_NOT_FINISHED": "a processing instruction is not closed by ?>",
    "ERR_RESERVED_XML_NAME": "<?xml stands elsewhere than at the start",
    "ERR_NAME_TOO_LONG": "a name is too long",
    "ERR_RESOURCE_LIMIT": "it is nested too deeply, or a part of it is too long",
    "NS_ERR_UNDEFINED_NAMESPACE": "the prefix of a name such as xacro: is not declared; expand"
    " xacro files first",
    "NS_ERR_XML_NAMESPACE": "a namespace is not declared as it must be",
    "NS_ERR_QNAME": "a name has two colons",
    "NS_ERR_ATTRIBUTE_REDEFINED": "an attribute stands twice in one tag",
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
            raise InvalidURDF(f"the text is not well-formed XML: {_reason(error)}") from None
        try:
            root = etree.fromstring(declared.encode(), parser)
        except etree.XMLSyntaxError as other:
            raise InvalidURDF(f"the text is not well-formed XML: {_reason(other)}") from None
    if root.getroottree().docinfo.internalDTD is not None:
        raise InvalidURDF("the URDF has a DOCTYPE or entities; remove them")
    elements = root.xpath("count(//*)")
    assert isinstance(elements, float)
    if elements > MAX_ELEMENTS:
        raise RobotTooLarge(
            f"the URDF has {elements:.0f} elements; at most {MAX_ELEMENTS} are read"
        )
    for element in root.iter():
        if len(element.attrib) > MAX_ATTRIBUTES:
            raise RobotTooLarge(
                f"an element <{shown_tag(element)}> has {len(element.attrib)} attributes; at most"
                f" {MAX_ATTRIBUTES} are read"
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
    place = f"line {line}, column {column}: " if line else ""
    return place + _REASON_BY_CODE.get(getattr(error, "code", 0), "a syntax error")


_REASON_BY_CODE = {getattr(etree.ErrorTypes, name): text for name, text in _REASONS.items()}
