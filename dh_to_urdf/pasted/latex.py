r"""Typeset cells -> cells that ``expressions`` reads.

``-\frac{\pi}{2}`` becomes ``-(pi/2)``, ``90^\circ`` and ``90º`` become ``90°``, ``$\theta_1^*$``
and ``θ₁`` become ``theta_1`` and ``θ1``. Unknown commands stay; the reader refuses them.
"""

from __future__ import annotations

import re
import unicodedata

from dh_to_urdf.pasted.programmed_cells import without_program

MAX_DEPTH = 20
_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[{}$^_~`]|[^\\{}$^_~`]", re.DOTALL)
_GREEK = ("alpha", "beta", "gamma", "theta", "sigma", "mu", "pi", "phi", "varphi", "psi", "delta")
_WORDS = {
    **{name: name for name in (*_GREEK, "sin", "cos", "tan")},
    **dict.fromkeys(("circ", "degree", "textdegree"), "°"),
    **dict.fromkeys(("cdot", "times", "star", "ast"), "*"),
    **dict.fromkeys(("metre", "meter", "milli"), "m"),
    "vartheta": "theta",
    "div": "/",
    "radian": "rad",
    "centi": "c",
    "pm": "±",
}
_WRAPPERS = {
    *("text", "mathrm", "mathbf", "mathit", "mathsf", "textbf", "textit", "textrm", "texttt"),
    *("textnormal", "boldsymbol", "bm", "operatorname", "ensuremath", "mbox", "num", "unit", "si"),
    *("underline", "textsc", "emph"),
}
_SPACES = {
    *("left", "right", "displaystyle", "textstyle", "quad", "qquad", "bfseries", "itshape", "big"),
    *("Big", "bigl", "bigr", "small", "centering", "limits", "rm", "bf", "it"),
}
_FRACTIONS = {"frac", "dfrac", "tfrac", "cfrac", "nicefrac", "sfrac"}
_QUANTITIES = {"SI", "qty"}
_MARKS, _THIN = "_%&#*|", ",;:!>/()[]"
"""Characters after a backslash: kept as they are; spacing and marks of mathematics."""
_BARE = re.compile(r"[\w.]+")
_CHARACTERS = {
    **{ord("₀") + n: str(n) for n in range(10)},
    **{ord(c): plain for c, plain in zip("ᵢⱼₖₙ₋", "ijkn-", strict=True)},
    **dict.fromkeys(map(ord, "º˚⁰"), "°"),
    **dict.fromkeys(map(ord, "‐‑‒"), "-"),
    **dict.fromkeys(map(ord, "\u202f\u2009\u00a0"), " "),
    ord("⁄"): "/",
    ord("⍺"): "α",
    ord("∗"): "*",
    ord("π"): "pi",
    **dict.fromkeys(map(ord, "ϑϴΘƟɵӨөѲѳꝊꝋⲐⲑᎾⴱ⊖⊝ØøᶿѺѻ"), "θ"),
    **dict.fromkeys(map(ord, "ɑ∝άὰάᾳⲁ⍶ᵅ"), "α"),
    **{ord(c): plain for c, plain in zip("аԁАᴀ", "adAa", strict=True)},
    ord("√"): "sqrt",
}
_STARRED = re.compile(r"((?:theta|th|θ|q|d|r|t)_?\d*)\s*\*(?=\s*(?:$|[-+−)]))")
_FOOTNOTE = re.compile("(?<=[0-9.])(?=[₀-₉])")
"""Position between a number and a subscript, which is not one of its digits."""
_BOLD = re.compile(r"^\*\*(.*)\*\*$")
_CALLED = re.compile(r"(?<![^\W_])(theta|θ|q)\s?\(\s?(\d{1,3})\s?\)")
_GENERIC = re.compile(r"(?<![^\W_])(?:(theta|θ|q|d|r)_|(θ))[ijk](?!\w)")


def plain_cell(text: str) -> str:
    """Return a typeset cell as plain text, in time linear in its length."""
    text = _FOOTNOTE.sub("_", without_program(text)).translate(_CHARACTERS)
    text = "".join(_plain_letter(c) for c in text)
    converted, _ = _Converter(_TOKEN.findall(text)).group(0)
    converted = _BOLD.sub(r"\1", " ".join(converted.split()))
    converted = _CALLED.sub(r"\1\2", converted)
    return _GENERIC.sub(lambda found: found[1] or found[2], _STARRED.sub(r"\1", converted)).strip()


def _plain_letter(character: str) -> str:
    """Replace 𝜃 and other mathematical alphabets, and wide letters, by plain ones."""
    if 0x1D400 <= ord(character) <= 0x1D7FF or 0xFF01 <= ord(character) <= 0xFF5E:
        return unicodedata.normalize("NFKC", character)
    return character


class _Converter:
    def __init__(self, tokens: list[str]) -> None:
        self.tokens = tokens
        self.depth = 0

    def group(self, position: int) -> tuple[str, int]:
        """Read up to the closing brace of this group; return its text and the next position."""
        parts: list[str] = []
        self.depth += 1
        if self.depth > MAX_DEPTH:
            return "".join(self.tokens[position:]), len(self.tokens)
        while position < len(self.tokens):
            token = self.tokens[position]
            if token == "}" and self.depth > 1:
                position += 1
                break
            part, position = self.item(position)
            parts.append(part)
        self.depth -= 1
        return "".join(parts), position

    def item(self, position: int) -> tuple[str, int]:
        """Read one token with its arguments."""
        token = self.tokens[position]
        position += 1
        if token == "{":
            inner, position = self.group(position)
            return (f"({inner})" if re.search(r".[-+]", inner) else inner), position
        if token in ("$", "`") or token == "~":
            return (" " if token == "~" else ""), position
        if token == "_":
            inner, position = self.argument(position)
            return (f"_{inner}" if not inner or _BARE.fullmatch(inner) else f"_({inner})"), position
        if token == "^":
            inner, position = self.exponent(position)
            mark = inner.strip()
            if mark in ("°", "o"):
                return "°", position
            return ("" if mark in ("*", "'") else f"^({inner})"), position
        if token.startswith("\\") and len(token) > 1:
            return self.command(token[1:], position)
        return token, position

    def command(self, name: str, position: int) -> tuple[str, int]:
        """Read a command with its arguments."""
        if name in _WORDS:
            word = _WORDS[name]
            apart = word.isalpha() and len(word) > 1 and self.follows_letter(position)
            return word + (" " if apart else ""), position
        if name in _FRACTIONS:
            above, position = self.argument(position)
            below, position = self.argument(position)
            above, below = (x if _BARE.fullmatch(x) else f"({x})" for x in (above, below))
            return f"({above}/{below})", position
        if name == "sqrt":
            inner, position = self.argument(position)
            return f"sqrt({inner})", position
        if name == "ang":
            inner, position = self.argument(position)
            return f"{inner}°", position
        if name in _QUANTITIES:
            number, position = self.argument(position)
            unit, position = self.argument(position)
            return f"{number} {unit}", position
        if name in _WRAPPERS:
            return self.argument(position)
        if name in ("phantom", "hphantom", "vphantom"):
            return "", self.argument(position)[1]
        if name in _SPACES:
            return " ", position
        if not name.isalpha():
            kept = name if name in _MARKS else f"\\{name}"
            return (" " if name in _THIN or name.isspace() else kept), position
        return f"\\{name}", position

    def argument(self, position: int) -> tuple[str, int]:
        """Read a group in braces, without them, or one token."""
        while position < len(self.tokens) and self.tokens[position].isspace():
            position += 1
        if position >= len(self.tokens) or self.tokens[position] in ("}", "$"):
            return "", position
        if self.tokens[position] == "{":
            return self.group(position + 1)
        return self.item(position)

    def exponent(self, position: int) -> tuple[str, int]:
        """Read what is raised: a group, a command, a mark, or a whole number with its sign."""
        end = position
        while end < len(self.tokens) and (
            self.tokens[end].isdecimal()
            or self.tokens[end] == "."
            or (end == position and self.tokens[end] in ("-", "+"))
        ):
            end += 1
        number = "".join(self.tokens[position:end])
        return (number, end) if number.strip("+-") else self.argument(position)

    def follows_letter(self, position: int) -> bool:
        return position < len(self.tokens) and self.tokens[position][:1].isalpha()
