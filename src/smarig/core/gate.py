"""The one gate for what a file may name: a path, a program, another file, a formula, an address.

Whoever made a file also chose what it names. A text that leads anywhere therefore carries who named it: ``named`` marks
it where it is read out of a file, and ``passed`` lets it through, or refuses it in one sentence, where it is used.
Nothing is looked up before: a refused path is not opened, nor is it asked whether it exists. ``GATED_KEYS`` lists the
keys with their rules; ``named`` knows no other. To add one: a row there, ``named`` where the file is read (in a schema:
``marked_as``), ``passed`` where the text is used, and a crafted file in ``tests/gate``.
"""

import shlex
from collections.abc import Collection
from typing import Any

from smarig.core.errors import NotPassed
from smarig.core.gated_keys import GATED_KEYS, GatedKey, Origin
from smarig.core.shown_text import shown

_LONGEST = 200  # characters of what a file names, in a sentence


class Named(str):
    """A text that a file names: its row of the table, who named it, and the file that it stands in.

    Copies, pickles and frozen schemas keep the mark, and so does ``str()`` of a text from inside another file, which
    ``Path`` refuses on older Pythons. Anything else made of it is a plain text and counts as the user's: pass it
    through the gate before.
    """

    row: GatedKey
    origin: Origin
    where: str

    def __str__(self) -> str:
        return self if self.origin is Origin.INSIDE else str.__str__(self)


def named(text: str, key: str, where: object, origin: Origin = Origin.INSIDE) -> Named:
    """Mark a text with the key that it stands under and the file ``where``. A mark of less trust stays.

    >>> named("../rig.toml", "run: begun_with.rig", "a.run.sqlite").origin
    <Origin.INSIDE: 0>
    """
    if isinstance(text, Named) and text.origin <= origin:
        return text
    found = Named(text)
    found.row, found.origin, found.where = GATED_KEYS[key], origin, str(where)
    return found


def named_where_text(value: Any, key: str, where: object) -> Any:
    """A value of any type out of a file; texts are marked."""
    return named(value, key, where) if isinstance(value, str) and value else value


def passed(text: str, known: Collection[str] = ()) -> str:
    """The text without its mark, if whoever named it may. ``known`` names are smarig's own: anybody may use them.

    Raises NotPassed with the text and the way to allow it. A text without a mark is the user's own.

    >>> passed("rig.toml"), passed(named("one_wire_twin", "run: begun_with.rig", "a.run.sqlite"), ["one_wire_twin"])
    ('rig.toml', 'one_wire_twin')
    >>> passed(named("rig.toml", "run: begun_with.rig", "a.run.sqlite"), ["one_wire_twin"])
    Traceback (most recent call last):
        ...
    smarig.core.errors.NotPassed: a.run.sqlite names the rig file 'rig.toml', which is not read, because a record may
    come from anywhere. If you trust it, smarig resume a.run.sqlite --rig rig.toml reads it.
    """
    if not isinstance(text, Named):
        return text
    least = text.row.least
    if text not in known and (least is None or text.origin < least):
        plain = str.__str__(text)
        given = {"where": text.where, "text": shown(plain, _LONGEST), "again": _again(plain)}
        raise NotPassed(text.row.sentence.format(**given), plain)
    return str.__str__(text)


def _again(text: str) -> str:
    """The path as one word of a shell; RIG for one that is not shown as it is."""
    return shlex.quote(text) if text.isprintable() and len(text) <= _LONGEST else "RIG"
