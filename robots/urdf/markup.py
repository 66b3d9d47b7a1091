"""Text -> XML elements: one strict parse by libxml2, with limits on size and nesting."""

from __future__ import annotations

import re

from lxml import etree

from dh_to_urdf.messages import say
from robots.errors import InvalidURDF, RobotTooLarge, URDFFault
from robots.urdf.limits import MAX_ATTRIBUTES, MAX_ELEMENTS
from robots.urdf.notes import Notes

UNDECLARED = "urn:undeclared:"
"""Namespaces of prefixes that a text does not declare begin so."""
_PREFIXED = re.compile(r"[<\s/]([A-Za-z_][\w.-]{0,31}):[A-Za-z_]")
_ROOT = re.compile(r"<robot(?=[\s>])")
_COMMENT = re.compile(
    r"(?P<kept><!\[CDATA\[.*?\]\]>)|<!--(?P<comment>.*?)-->|<!(?![A-Za-z\[-])[^<>]*>|<!-(?!-)[^<>]*>",
    re.DOTALL,
)
MAX_PREFIXES = 16
"""Prefixes without a declaration that are mended."""
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
    "NS_ERR_UNDEFINED_NAMESPACE": say("the prefix of a name is not declared"),
    "NS_ERR_XML_NAMESPACE": say("a namespace is not declared as it must be"),
    "NS_ERR_QNAME": say("a name has two colons"),
    "NS_ERR_ATTRIBUTE_REDEFINED": say("an attribute stands twice in one tag"),
}


def parse(text: str, notes: Notes) -> etree._Element:
    """Parse a text and return its root element.

    What other readers pass over (odd comments, prefixes without a declaration) is mended
    where the strict parse fails, and noted.

    Args:
        text: The text, without XML declaration and DOCTYPE.
        notes: Takes what is mended.

    Raises:
        InvalidURDF: Not well-formed; the message has line and column.
        RobotTooLarge: More elements, or attributes of one element, than any robot needs.
    """
    root = _parsed(text, notes)
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


def _parsed(text: str, notes: Notes) -> etree._Element:
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
    for mend in (_without_comments, _with_prefixes):
        try:
            return etree.fromstring(text.encode(), parser)
        except etree.XMLSyntaxError:
            text = mend(text, notes)
    try:
        return etree.fromstring(text.encode(), parser)
    except etree.XMLSyntaxError as error:
        line = error.position[0] or None
        message = say("the text is not well-formed XML: {error}", error=_reason(error))
        raise InvalidURDF.of([URDFFault(message, line)]) from None


def _without_comments(text: str, notes: Notes) -> str:
    """Remove comments, and what begins like one: ``<!- … ->``; CDATA stays.

    XML does not allow -- in comments, and readers of URDF take them.
    """
    odd = False

    def blank(found: re.Match[str]) -> str:
        nonlocal odd
        if found["kept"] is not None:
            return found[0]
        inner = found["comment"]
        odd = odd or inner is None or "--" in inner or inner.endswith("-")
        return "\n" * found[0].count("\n")

    mended = _COMMENT.sub(blank, text)
    if not odd:
        return text
    notes.add(say("comments that XML does not allow (with -- inside, or <! alone) are left out"))
    return mended


def _with_prefixes(text: str, notes: Notes) -> str:
    """Declare prefixes such as ``drake:`` that a text uses without."""
    root = _ROOT.search(text)
    if root is None:
        return text
    tag = text[root.start() : text.find(">", root.end())]
    found = dict.fromkeys(_PREFIXED.findall(text))
    names = [n for n in found if n not in ("xml", "xmlns") and f"xmlns:{n}" not in tag]
    if not names or len(names) > MAX_PREFIXES:
        return text
    shown = ", ".join(f"{name}:" for name in names[:4])
    notes.add(
        say("the prefix {shown} is not declared; kinematics needs nothing that has it", shown=shown)
    )
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
