"""Cells as programs, documents and keyboards spell them -> cells that ``latex`` and ``cells`` read.

``np.pi/2`` and ``M_PI_2`` become ``pi/2``, ``90*deg`` ``90 deg``, ``theta1(t)`` ``theta1``, ``½π``
``(1/2)π``, ``√2`` ``sqrt(2)``, ``3·10⁻¹`` ``3*10^(-1)``.
"""

from __future__ import annotations

import re
import unicodedata

_MODULE = re.compile(
    r"(?<![\w.])(?:np|numpy|jnp|math|cmath|sp|sym|sympy|sm|torch|tf|ca|casadi|mp|mpmath|std|rtb|Math)"
    r"(?:\.|::)(?=[A-Za-z])"
)
_CONSTANTS = {"M_PI_2": "(pi/2)", "M_PI_4": "(pi/4)", "M_PI": "pi", "EIGEN_PI": "pi"}
_CONSTANT = re.compile(r"\b(?:M_PI_2|M_PI_4|M_PI|EIGEN_PI)(?:f|l)?\b")
_DEGREES = "deg|degs|degree|degrees|d2r|deg2rad|deg_to_rad|rad_per_deg"
_TIMES_DEGREES = re.compile(rf"(?<=[\d.)])\s*\*\s*(?:{_DEGREES})\b(?!\s*\()", re.IGNORECASE)
_DEGREES_TIMES = re.compile(
    rf"(?<![\w.])(?:{_DEGREES})\s*\*\s*(\d+(?:\.\d*)?)(?![\w.(])", re.IGNORECASE
)
_TIMES_LENGTH = re.compile(r"(?<=[\d.)])\s*\*\s*(mm|cm|m)\b(?!\s*\()")
_OF_TIME = re.compile(r"((?<![^\W_])\\?(?:theta|th|θ|q|d|r|x)_?(?:\d+|\{\d+\})?)\s*\(\s*t\s*\)")
_INDEXED = re.compile(r"(?<![^\W_])(theta|θ|q|d|r)\s?\[\s?(\d{1,3})\s?\]")
_REMARK = re.compile(
    r"(?<=[\dθqd})])\s*[\[(]?\s*\b(?:variables?|var\.?)\s*[\])]?\s*$", re.IGNORECASE
)
_RADIANS_OF_PI = re.compile(r"^(.*(?:pi|π).*?)\s*(?:radians?|rad)\s*$", re.IGNORECASE)
_EMPHASIS = re.compile(r"^(?:\*{1,3}([^*]+)\*{1,3}|`+([^`]+)`+)$")
_ROOT = re.compile(r"√\s*(\d+(?:[.,]\d+)?|π)")
_FRACTION = re.compile("(\\d*)\\s?([¼½¾⅐-⅞])")
_RAISED = "⁻¹²³⁴⁵⁶⁷⁸⁹"
_POWER_OF_TEN = re.compile(r"(?<=[\d)])\s*[·×⋅∙*x]\s*10([⁺⁻]?[¹²³⁴⁵⁶⁷⁸⁹]|\^)")
_EXPONENT = re.compile(rf"(?<=[\d)])[{_RAISED}][{_RAISED}⁰]*")
_PLAIN = str.maketrans("⁻⁺¹²³⁴⁵⁶⁷⁸⁹⁰", "-+1234567890")
_OPERATES = re.compile(r"[*/+√×·⋅]|sqrt")


def without_program(text: str) -> str:
    """Return a cell without what is of a programming language or a keyboard.

    A raised digit of a lone number stays, as it may be the mark of a footnote.
    """
    if text.isalnum() and text.isascii() and "_" not in text:
        return text
    text = text.strip()
    emphasised = _EMPHASIS.match(text)
    if emphasised and (emphasised[1] or "q").strip():
        text = (emphasised[1] or emphasised[2]).strip()
    text = _MODULE.sub("", text)
    text = _CONSTANT.sub(lambda found: _CONSTANTS[found[0].rstrip("fl")], text)
    text = _DEGREES_TIMES.sub(r"\1 deg", _TIMES_DEGREES.sub(" deg", text))
    text = _TIMES_LENGTH.sub(r" \1", text)
    text = _INDEXED.sub(r"\1\2", _OF_TIME.sub(r"\1", text))
    if text.strip().lower() not in ("var", "var.", "variable", "variables"):
        text = _REMARK.sub("", text)
    if text.isascii():
        return _power_of_ten(_RADIANS_OF_PI.sub(r"\1", text))
    text = _ROOT.sub(r"sqrt(\1)", text)
    text = _FRACTION.sub(_fraction, text).replace("÷", "/")
    text = text.replace("₍", "").replace("₎", "")
    text = _power_of_ten(text)
    if _OPERATES.search(text):
        text = _EXPONENT.sub(lambda found: f"^{found[0].translate(_PLAIN)}", text)
    return _RADIANS_OF_PI.sub(r"\1", text)


def _power_of_ten(text: str) -> str:
    return _POWER_OF_TEN.sub(r"*10\1", text)


def _fraction(found: re.Match[str]) -> str:
    """Write ½ as ``(1/2)``, and 1½ as ``(1+1/2)``."""
    above, _, below = unicodedata.normalize("NFKC", found[2]).partition("⁄")
    part = f"{above}/{below}"
    return f"({found[1]}+{part})" if found[1] else f"({part})"
