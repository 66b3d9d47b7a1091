"""Headings in words: ``Link twist αi``, ``Longueur a``, ``Joint No.``, ``Twist angle``."""

from __future__ import annotations

import re

_BY_SYMBOL = {
    **{"alpha": "alpha", "α": "alpha", "a": "a", "d": "d", "r": "r", "theta": "theta"},
    **{"θ": "theta", "th": "theta"},
}
_SYMBOL = re.compile(rf"({'|'.join(_BY_SYMBOL)})_?(?:[ijkn](?:-1)?)?")
_SUBSCRIPT = re.compile(r"_?\(\s*([ijkn](?:-1)?)\s*\)")
_OF_VARIABLE = re.compile(r"(?:d|r|θ|theta)_?[ijkn]?\s+(?:offset|décalage|decalage)")
"""What reads as the offset of a joint, or as the link offset d."""
_WORD = re.compile(r"[^\W\d_]+(?:-1)?|#|n°|№")
_INDEX_TEXT = """
    link links joint joints axis axes frame frames row rows body bodies segment segments element
    liaison liaisons articulation articulations axe corps ligne repère gelenk glied achse lien
    transform transformation eje eslabón articulación
"""
_INDEX = frozenset(_INDEX_TEXT.split())
_NUMBER_TEXT = """
    # no nr n° № n num number numbers numéro numero nummer id i j k index from to idx
"""
_NUMBER = frozenset(_NUMBER_TEXT.split())
_FILLERS = frozenset(
    ("of", "the", "de", "du", "des", "la", "le", "les", "l", "in", "along", "about", "between")
)
_DESCRIPTIONS = {
    "alpha": "twist torsion angle link rotation joint x",
    "a": "length longueur distance link bras segment corps x",
    "d": "offset décalage decalage distance joint link translation extension z length longueur",
    "r": "offset décalage decalage distance joint link translation extension z",
    "theta": "angle joint rotation articulaire articulation link variable z",
}
_OF_SYMBOL = {key: set(words.split()) | _FILLERS for key, words in _DESCRIPTIONS.items()}
_PHRASES = {
    "alpha": ("twist", "link twist", "twist angle", "link twist angle", "angle torsion", "torsion"),
    "a": ("length", "link length", "longueur", "longueur bras", "longueur segment",
          "longueur corps", "common normal"),
    "d": ("link offset", "link offset distance"),
    "theta": ("joint angle", "angle articulaire", "angle articulation"),
    "offset": ("joint offset", "θ offset", "theta offset", "offset θ", "offset theta", "q offset",
               "offset q", "décalage θ", "décalage q", "home offset", "zero offset"),
    "lower": ("min limit", "lower limit", "θ min", "q min", "min θ", "min q", "butée inférieure",
              "limite inférieure", "lower bound", "joint min"),
    "upper": ("max limit", "upper limit", "θ max", "q max", "max θ", "max q", "butée supérieure",
              "limite supérieure", "upper bound", "joint max"),
    "type": ("joint type", "type articulation", "type liaison"),
    "name": ("joint name", "link name", "nom articulation"),
    "ignored": ("comment", "comments", "remark", "remarks", "note", "notes", "description",
                "motor", "actuator", "mass", "range", "joint range", "commentaire", "remarque",
                "masse", "moteur"),
}  # fmt: skip
_KEYS = {frozenset(text.split()): key for key, listed in _PHRASES.items() for text in listed}


def key_of_words(text: str) -> str | None:
    """Return the column that words alone name, None for none.

    ``index`` is a number of joints, ``ignored`` what says nothing of the geometry.

    Args:
        text: The heading in lower case, without its unit.
    """
    words = [word for word in _WORD.findall(text) if word not in _FILLERS]
    found = _KEYS.get(frozenset(words))
    if found is not None:
        return found
    known = [word for word in words if word in _INDEX]
    rest = re.sub(r"[\s().:_/→>-]", "", _WORD.sub("", text))
    if known and not rest and all(word in _INDEX or word in _NUMBER for word in words):
        return "index"
    return None


def symbol_among_words(text: str) -> str | None:
    """Return the symbol of a heading without the words that describe it.

    ``link twist α i-1`` and ``α_(i-1) (link twist)`` are ``αi-1``; None where the words say
    another column, or there are others.

    Args:
        text: The heading in lower case, without its unit.
    """
    text = _SUBSCRIPT.sub(r"\1 ", text)
    if _OF_VARIABLE.fullmatch(text):
        return None
    words = re.split(r"[\s,:()\[\]]+", text.strip(" ()[]"))
    found = [k for k, word in enumerate(words) if _SYMBOL.fullmatch(word)]
    if len(found) != 1:
        return None
    position = found[0]
    symbol, key = words[position], _BY_SYMBOL[_SYMBOL.sub(r"\1", words[position])]
    end = position + 1
    if end < len(words) and words[end] in ("i", "j", "i-1", "j-1"):
        symbol += words[end]
        end += 1
    described = set(words[:position] + words[end:]) - _FILLERS
    return symbol if described and described <= _OF_SYMBOL[key] else None
