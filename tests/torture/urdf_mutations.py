"""What goes wrong with URDFs: by people, exporters, disks and attackers. Seeded, fast."""

from __future__ import annotations

import copy
import random
import unicodedata
from collections.abc import Callable
from xml.etree import ElementTree as ET

HOSTILE = (
    *("", " ", "nan", "NaN", "inf", "-inf", "1e308", "-1e308", "1e-320", "1e999", "0x10", "1_0"),
    *("1,5", "٣", "１", "- 1", "1e", "--1", "1" * 400, "0." + "1" * 100, "1 2", "1 2 3 4", "0 0 0"),
    *("1e-7 0 0", "1e6 1e6 1e6", "1e7 0 0", "${x}", "pi/2", "true", "None", "0\x000", "0 0\u20030"),
    *("universe", "world", "root_joint", " a", "a ", "a\nb", "a\tb", "\x1b[31m", "\u202egnp", "é"),
    *("e\u0301", "\u200b", "'\"><", "&amp;", "x" * 129, "x" * 5000, "../../etc/passwd", "%s%n"),
    *("file:///etc/passwd", "http://127.0.0.1/", "package://../x", "package://a/b.stl", "\ufeff"),
    *(
        "fixed",
        "revolute",
        "prismatic",
        "continuous",
        "floating",
        "planar",
        "spherical",
        "REVOLUTE",
    ),
)
TAGS = (
    *("robot", "link", "joint", "origin", "axis", "limit", "parent", "child", "mimic", "inertial"),
    *("mass", "inertia", "visual", "collision", "geometry", "box", "mesh", "material", "color"),
    *("gazebo", "transmission", "Joint", "joints", "lnk", "{urn:x}link", "{urn:x}a", "x"),
)
KEYS = ("name", "type", "link", "xyz", "rpy", "lower", "upper", "joint", "multiplier", "value", "x")
SCRAPS = (
    *(b"\x00", b"\xff", b"\xfe\xff", b"\xef\xbb\xbf", b"<", b">", b"&", b"&x;", b"&#0;", b"&#65;"),
    *(b"<!DOCTYPE a>", b"<!--", b"-->", b"<![CDATA[", b"]]>", b"<?x?>", b"<link/>", b"</robot>"),
    *(b"<robot name='b'/>", b'"', b"'", b"/", b"\r", b"\xc3", b"\xed\xa0\x80", b"<x>" * 300),
    b'<!DOCTYPE r [<!ENTITY e SYSTEM "name.txt">]>',
)
ENCODINGS = ("utf-16", "utf-16-le", "utf-32", "latin-1", "utf-7", "cp1252", "cp037", "utf-8-sig")

Tree = ET.Element
Mutation = Callable[[random.Random, Tree], None]


def mutate(rng: random.Random, document: bytes) -> bytes:
    """A document with one to four things wrong, or changed without harm."""
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3))):
        if rng.random() < 0.75:
            document = _mutate_tree(rng, document)
        else:
            document = rng.choice(_BYTES)(rng, document)
    return document


def _mutate_tree(rng: random.Random, document: bytes) -> bytes:
    try:
        root = ET.fromstring(document)
    except (ET.ParseError, ValueError, LookupError):
        return rng.choice(_BYTES)(rng, document)
    rng.choice(_TREES)(rng, root)
    return ET.tostring(root, encoding="unicode").encode("utf-8", "surrogatepass")


def _elements(root: Tree) -> list[Tree]:
    return list(root.iter())


def _inner(rng: random.Random, root: Tree) -> tuple[Tree, int] | None:
    """A parent and the index of one of its children."""
    parents = [element for element in root.iter() if len(element)]
    if not parents:
        return None
    parent = rng.choice(parents)
    return parent, rng.randrange(len(parent))


def _drop(rng: random.Random, root: Tree) -> None:
    found = _inner(rng, root)
    if found:
        del found[0][found[1]]


def _repeat(rng: random.Random, root: Tree) -> None:
    found = _inner(rng, root)
    if found:
        parent, index = found
        parent.insert(rng.randrange(len(parent) + 1), copy.deepcopy(parent[index]))


def _move(rng: random.Random, root: Tree) -> None:
    found = _inner(rng, root)
    if found:
        moved = copy.deepcopy(found[0][found[1]])
        target = rng.choice(_elements(root))
        if rng.random() < 0.5:
            del found[0][found[1]]
        target.append(moved)


def _shuffle(rng: random.Random, root: Tree) -> None:
    found = _inner(rng, root)
    if found:
        children = list(found[0])
        rng.shuffle(children)
        found[0][:] = children


def _wrap(rng: random.Random, root: Tree) -> None:
    found = _inner(rng, root)
    if found:
        parent, index = found
        around = ET.Element(rng.choice(TAGS))
        around.append(parent[index])
        parent[index] = around


def _retag(rng: random.Random, root: Tree) -> None:
    rng.choice(_elements(root)).tag = rng.choice(TAGS)


def _misspell(rng: random.Random, root: Tree) -> None:
    element = rng.choice(_elements(root))
    if len(element.tag) > 1:
        at = rng.randrange(len(element.tag))
        element.tag = element.tag[:at] + rng.choice("abcdefgxyz_") + element.tag[at + 1 :]


def _with_attributes(rng: random.Random, root: Tree) -> Tree | None:
    elements = [element for element in root.iter() if element.attrib]
    return rng.choice(elements) if elements else None


def _set_value(rng: random.Random, root: Tree) -> None:
    element = _with_attributes(rng, root)
    if element is not None:
        element.set(rng.choice(list(element.attrib)), rng.choice(HOSTILE))


def _set_number(rng: random.Random, root: Tree) -> None:
    element = _with_attributes(rng, root)
    if element is not None:
        key = rng.choice(list(element.attrib))
        words = element.get(key, "").split() or [""]
        words[rng.randrange(len(words))] = rng.choice(HOSTILE)
        element.set(key, " ".join(words))


def _nudge_number(rng: random.Random, root: Tree) -> None:
    element = _with_attributes(rng, root)
    if element is not None:
        key = rng.choice(list(element.attrib))
        words = element.get(key, "").split() or ["0"]
        words[rng.randrange(len(words))] = repr(rng.uniform(-1, 1) * 10.0 ** rng.randint(-12, 7))
        element.set(key, " ".join(words))


def _drop_attribute(rng: random.Random, root: Tree) -> None:
    element = _with_attributes(rng, root)
    if element is not None:
        del element.attrib[rng.choice(list(element.attrib))]


def _rename_attribute(rng: random.Random, root: Tree) -> None:
    element = _with_attributes(rng, root)
    if element is not None:
        key = rng.choice(list(element.attrib))
        value = element.attrib.pop(key)
        element.set(rng.choice((*KEYS, key[::-1], key.upper(), f"{{urn:x}}{key}")), value)


def _swap_values(rng: random.Random, root: Tree) -> None:
    """Links that lead elsewhere: cycles, two parents, two roots, loops to oneself."""
    elements = [e for e in root.iter() if e.tag in ("parent", "child", "link", "joint", "mimic")]
    if elements:
        one, other = rng.choice(elements), rng.choice(elements)
        for key in ("link", "name", "joint"):
            if key in one.attrib:
                values = [other.get(k) for k in ("link", "name", "joint") if k in other.attrib]
                if values:
                    one.set(key, values[0] or "")


def _rename(rng: random.Random, root: Tree) -> None:
    """A name in another case or another Unicode form, everywhere or in one place."""
    element = _with_attributes(rng, root)
    if element is not None:
        key = rng.choice(list(element.attrib))
        value = element.get(key, "")
        element.set(
            key,
            rng.choice(
                (
                    value.upper(),
                    value + " ",
                    unicodedata.normalize("NFD", value),
                    value + "\u200d",
                    value.replace("a", "а"),
                )
            ),
        )


def _add_mimic(rng: random.Random, root: Tree) -> None:
    joints = root.findall("joint")
    if joints:
        mimic = ET.SubElement(rng.choice(joints), "mimic")
        mimic.set("joint", rng.choice([*(j.get("name", "") for j in joints), "nil"]))
        for key in ("multiplier", "offset"):
            if rng.random() < 0.6:
                mimic.set(key, rng.choice(("0", "1", "-1", "2.5", "-0.5", "1e-3", *HOSTILE[:8])))


def _add_element(rng: random.Random, root: Tree) -> None:
    element = ET.SubElement(rng.choice(_elements(root)), rng.choice(TAGS))
    for _ in range(rng.randrange(3)):
        element.set(rng.choice(KEYS), rng.choice(HOSTILE))


def _add_text(rng: random.Random, root: Tree) -> None:
    element = rng.choice(_elements(root))
    if rng.random() < 0.5:
        element.text = rng.choice(HOSTILE)
    else:
        element.tail = rng.choice(HOSTILE)


def _retype(rng: random.Random, root: Tree) -> None:
    joints = root.findall("joint")
    if joints:
        kinds = ("revolute", "prismatic", "continuous", "fixed", "floating", "planar")
        rng.choice(joints).set("type", rng.choice(kinds))


def _many(rng: random.Random, root: Tree) -> None:
    """A hundred of one thing."""
    found = _inner(rng, root)
    if found:
        parent, index = found
        child = parent[index]
        if len(list(child.iter())) < 20:
            parent.extend(copy.deepcopy(child) for _ in range(100))


def _crowd(rng: random.Random, root: Tree) -> None:
    element = rng.choice(_elements(root))
    for k in range(rng.choice((5, 40, 500))):
        element.set(f"a{k}", "1")


_TREES: tuple[Mutation, ...] = (
    *(_drop, _repeat, _move, _shuffle, _wrap, _retag, _misspell, _set_value, _set_number),
    *(_nudge_number, _nudge_number, _drop_attribute, _rename_attribute, _swap_values, _swap_values),
    *(_rename, _add_mimic, _add_mimic, _add_element, _add_text, _retype, _many, _crowd),
)


def _flip(rng: random.Random, document: bytes) -> bytes:
    if not document:
        return document
    at = rng.randrange(len(document))
    return document[:at] + bytes([document[at] ^ (1 << rng.randrange(8))]) + document[at + 1 :]


def _cut(rng: random.Random, document: bytes) -> bytes:
    return document[: rng.randrange(len(document) + 1)]


def _hole(rng: random.Random, document: bytes) -> bytes:
    start = rng.randrange(len(document) + 1)
    return document[:start] + document[start + rng.choice((1, 2, 10, 200)) :]


def _stutter(rng: random.Random, document: bytes) -> bytes:
    start = rng.randrange(len(document) + 1)
    end = start + rng.choice((1, 20, 500))
    return document[:end] + document[start:]


def _insert(rng: random.Random, document: bytes) -> bytes:
    at = rng.choice((0, len(document), rng.randrange(len(document) + 1)))
    return document[:at] + rng.choice(SCRAPS) + document[at:]


def _recode(rng: random.Random, document: bytes) -> bytes:
    encoding = rng.choice(ENCODINGS)
    text = document.decode("utf-8", "replace")
    if rng.random() < 0.5 and not text.startswith("<?xml"):
        text = f'<?xml version="1.0" encoding="{rng.choice(ENCODINGS)}"?>' + text
    return text.encode(encoding, "replace")


_BYTES = (_flip, _flip, _cut, _hole, _stutter, _insert, _insert, _recode)
