"""Data as TOML, which Python's own library only reads."""

from __future__ import annotations

import operator
from typing import Any, Mapping, Sequence

from . import _poise
from ._tables import checked_text, refuse_mask

_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t"}

# Of what contains itself there is no end.
_DEEPEST = 20


def _text(word: str) -> str:
    shown = (_ESCAPES.get(c, c if c >= " " and c != "\x7f" else f"\\u{ord(c):04X}") for c in checked_text(word))
    return '"' + "".join(shown) + '"'


def _value(place: str, value: Any, depth: int = 0) -> str:
    """A value in one line. Numbers are written so that the same double is read again."""
    if depth > _DEEPEST:
        raise _poise.InputError(f"{place:.200}: expected lists and dictionaries in each other {_DEEPEST} deep at most")
    if isinstance(value, str):
        return _text(value)
    refuse_mask(place, value)
    if type(value).__name__ in ("bool", "bool_"):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(place, key)} = {_value(f'{place}.{key}', one, depth + 1)}"
                                for key, one in value.items()) + " }"
    if isinstance(value, Sequence) or hasattr(value, "tolist") and getattr(value, "ndim", 0) > 0:
        return "[" + ", ".join(_value(place, one, depth + 1) for one in value) + "]"
    text = number_text(value)
    if text is None:
        raise _poise.InputError(f"{place}: expected a number, a text, True or False, or a list or dictionary of these, "
                                f"found {value!r:.200}")
    return text


def _key(place: str, key: Any) -> str:
    if not isinstance(key, str):
        raise _poise.InputError(f"{place or 'keys'}: expected a text as the name of a member, found {key!r:.200}")
    return _text(key)


def toml_text(document: Mapping[str, Any]) -> str:
    """A TOML document: tables of the top and lists of tables as such, everything below them in one line.

    >>> print(toml_text({"title": "A", "run": [{"rate": 0.1}, {"rate": 5}]}), end="")
    "title" = "A"
    [["run"]]
    "rate" = 0.1
    [["run"]]
    "rate" = 5

    Raises InputError for what TOML has no word for.
    """
    lines, tables = [], []
    for name, value in document.items():
        key = _key("", name)
        many = not isinstance(value, str) and isinstance(value, Sequence) and len(value) > 0
        if isinstance(value, Mapping):
            tables.append((f"[{key}]", name, value))
        elif many and all(isinstance(one, Mapping) for one in value):
            tables += [(f"[[{key}]]", name, one) for one in value]
        else:
            lines.append(f"{key} = {_value(name, value)}")
    for header, name, members in tables:
        lines.append(header)
        lines += [f"{_key(name, key)} = {_value(f'{name}.{key}', one)}" for key, one in members.items()]
    return "\n".join(lines) + "\n"


def number_text(value: Any) -> str | None:
    """A number, written so that the same double is read again; None of what is no number."""
    try:
        return str(operator.index(value))
    except TypeError:
        pass
    try:
        return repr(float(value))
    except (TypeError, ValueError, OverflowError):
        return None
