"""Sentences that can be said in other languages: English texts that keep what they are made of.

A message is a ``str``, the English sentence, so that whoever only prints it needs to know nothing
of this module. It carries its template and the values of its placeholders, or its parts;
:meth:`Message.translated` makes the same sentence from the template of another language. Messages
may be values of messages. They survive ``+``, ``str()``, :func:`chained`, exceptions, copies and
pickles, and JSON as :func:`as_data`; an f-string, ``str.join`` and slices make plain text of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple, TypeAlias


class Template(NamedTuple):
    """A sentence with placeholders, as it stands in the sources and in catalogues.

    Attributes:
        one: The English template, such as ``"joint {joint} has no limits"``; of two forms that
            for one thing.
        many: The English template for several things; empty where there is one form.
        number: How many things there are; 1 where there is one form.
    """

    one: str
    many: str = ""
    number: int = 1

    @property
    def english(self) -> str:
        """The English template for this count."""
        return self.many if self.many and self.number != 1 else self.one


Translate: TypeAlias = Callable[[Template], str]
"""Return the template of another language that says the same, with the same placeholders."""


class Message(str):
    """An English sentence that keeps what it is made of.

    Attributes:
        template: Its template; None for parts that stand one after the other.
        values: What stands for the placeholders; the parts, by position, where there is no
            template.
    """

    __slots__ = ("template", "values")
    template: Template | None
    values: Mapping[str, object]

    def translated(self, translate: Translate) -> str:
        """Return the sentence in another language.

        Args:
            translate: Finds templates of that language.
        """
        values = {
            name: value.translated(translate) if isinstance(value, Message) else value
            for name, value in self.values.items()
        }
        if self.template is None:
            return "".join(map(str, values.values()))
        return translate(self.template).format(**values)

    def having(self, **values: object) -> Message:
        """Return the message with other values for some placeholders that it has."""
        assert self.template is not None
        return _said(self.template, {**self.values, **values})

    def __str__(self) -> str:
        # str() of a message, and of an exception that carries one, is the message.
        return self

    def __add__(self, other: str) -> Message:
        return chained("", (self, other))

    def __radd__(self, other: str) -> Message:
        return chained("", (other, self))

    def __reduce__(self) -> tuple[object, ...]:
        return _message, (str.__str__(self), self.template, dict(self.values))


def say(template: str, /, **values: object) -> Message:
    """Return a message.

    Args:
        template: The English sentence with named placeholders, as ``str.format`` takes them; a
            literal, since catalogues are made from the sources.
        values: What stands for the placeholders. An exception stands for its message.
    """
    return _said(Template(template), values)


def plural(one: str, many: str, /, count: int, **values: object) -> Message:
    """Return a message that has another form for several things.

    Args:
        one: The sentence for one thing; see :func:`say`.
        many: The sentence for any other count, with the same placeholders.
        count: How many things there are; placeholder ``{count}``, which ``one`` may leave out.
        values: What stands for the other placeholders.
    """
    return _said(Template(one, many, count), {**values, "count": count})


def chained(separator: str, parts: Iterable[object]) -> Message:
    """Join texts, as ``str.join`` does, and keep the messages among them.

    Args:
        separator: Stands between the parts; a message where it holds words.
        parts: Texts, messages, or exceptions, which stand for their messages.
    """
    pieces: list[str] = []
    for k, part in enumerate(parts):
        for piece in (separator, str(part)) if k else (str(part),):
            if pieces and not isinstance(piece, Message) and not isinstance(pieces[-1], Message):
                pieces[-1] += piece
            elif piece:
                pieces.append(piece)
    return _message("".join(pieces), None, {str(k): piece for k, piece in enumerate(pieces)})


def as_data(text: str) -> object:
    """Return a text or message as plain data that JSON holds; :func:`from_data` reads it."""
    if not isinstance(text, Message):
        return text
    values = {name: _value_as_data(value) for name, value in text.values.items()}
    return {"template": text.template and list(text.template), "values": values}


def from_data(data: object) -> str:
    """Return what :func:`as_data` has written.

    Raises:
        ValueError: It is not of this form.
    """
    if isinstance(data, str):
        return data
    try:
        template, values = data["template"], data["values"]  # type: ignore[index]
        read = {
            name: from_data(value) if isinstance(value, dict) else value
            for name, value in values.items()
        }
        if template is None:
            return chained("", read.values())
        one, many, number = template
        return _said(Template(one, many, number), read)
    except (TypeError, LookupError, AttributeError, ValueError) as error:
        raise ValueError("no message") from error


def _value_as_data(value: object) -> object:
    if isinstance(value, Message):
        return as_data(value)
    if isinstance(value, (bool, int)):
        return value
    return float(value) if isinstance(value, float) else str(value)


def _said(template: Template, values: Mapping[str, object]) -> Message:
    plain = {k: str(v) if isinstance(v, BaseException) else v for k, v in values.items()}
    return _message(template.english.format(**plain), template, plain)


def _message(text: str, template: Template | None, values: Mapping[str, object]) -> Message:
    made = Message(text)
    made.template, made.values = template, values
    return made
