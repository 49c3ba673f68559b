"""Blocks of columns side by side whose names are the same but for a label, as "Run 1: Time" and "Run 2: Time"."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile

from smarig.exchange.units.written_units import known_unit

_FEWEST = 3  # columns of a block: a clock, an input and an output
_BETWEEN = " _.:;,|/#-"  # signs between a label and a name
_OPENING = "([{<"
_WORD = re.compile(r"[^\W_]*")
_NUMBER = re.compile(r"\d*(?:[.,]\d+)?")
_UNIT_BEGAN = re.compile(r"\d[\s_]?([°%]?[^\W\d_]*)$")
_UNIT_GOES_ON = re.compile(r"[\s_]?[°%]?[^\W\d_]*")


@dataclass(frozen=True)
class LabelledBlock:
    """A block of columns: its label ("" for a first one without), and the names without it."""

    label: str
    names: tuple[str, ...]


def labelled_blocks(names: Sequence[str]) -> list[LabelledBlock]:
    """The blocks of the shortest period of the names, where each differs from the first by one and the same text.

    >>> found = labelled_blocks(["Run 1: t (s)", "Run 1: T", "Run 1: x", "Run 2: t (s)", "Run 2: T", "Run 2: x"])
    >>> [block.label for block in found], found[0].names
    (['Run 1', 'Run 2'], ('t (s)', 'T', 'x'))
    >>> [block.label for block in labelled_blocks(["t", "T", "x", "t.1", "T.1", "x.1"])]
    ['', '1']
    """
    for period in range(_FEWEST, len(names) // 2 + 1):
        if len(names) % period:
            continue
        if found := _of_groups([names[k : k + period] for k in range(0, len(names), period)]):
            return found
    return []


def _of_groups(groups: Sequence[Sequence[str]]) -> list[LabelledBlock]:
    """The blocks; [] if names differ otherwise than by a label, or are equal."""
    found = []
    for k, group in enumerate(groups):
        other = groups[1 if k == 0 else 0]
        places = [_difference(name, partner) for name, partner in zip(group, other)]
        texts = {name[a:b] for name, (a, b) in zip(group, places)}
        partners = {_middle(partner, name, place) for name, partner, place in zip(group, other, places)}
        if len(texts) > 1 or len(partners) > 1 or texts == partners:
            return []
        found.append(_without_label(group, places))
    names, labels = found[0].names, {block.label for block in found}
    same = all(block.names == names for block in found) and len(labels) == len(found)
    return found if same and all(names) and len(set(names)) == len(names) else []


def _shared(texts: Sequence[str]) -> str:
    """The signs with which all texts begin."""
    same = takewhile(lambda signs: len(set(signs)) == 1, zip(*texts))
    return "".join(signs[0] for signs in same)


def _difference(name: str, other: str) -> tuple[int, int]:
    """Where a name differs from another one: from the first sign that does to behind the last one."""
    first = len(_shared([name, other]))
    last = len(_shared([name[first:][::-1], other[first:][::-1]]))
    return first, len(name) - last


def _middle(other: str, name: str, place: tuple[int, int]) -> str:
    """The text of another name in the place where it differs."""
    return other[place[0] : len(other) - (len(name) - place[1])]


def _without_label(group: Sequence[str], places: Sequence[tuple[int, int]]) -> LabelledBlock:
    """The block of names with the text at these places, and with what stands around it in all of them."""
    heads = [name[:a] for name, (a, _) in zip(group, places)]
    tails = [name[b:] for name, (_, b) in zip(group, places)]
    text = group[0][slice(*places[0])]
    if len(set(heads)) == 1:
        rest = _rest(heads[0] + text, tails)
        if rest in tails:  # a name would be left without a word
            rest = ""
        names = [tail.removeprefix(rest).lstrip(_BETWEEN + ")]}>") for tail in tails]
        return LabelledBlock((heads[0] + text + rest).strip(_BETWEEN + _OPENING), tuple(names))
    before = _word_end(_shared([head[::-1] for head in heads])[::-1])
    rest = _rest(before + text, tails)
    tails = [tail.removeprefix(rest) for tail in tails]
    closing = tails[0] if len(set(tails)) == 1 and len(tails[0]) < 2 else ""
    names = [
        f"{head.removesuffix(before).rstrip(_BETWEEN + _OPENING)}{tail.removeprefix(closing)}"
        for head, tail in zip(heads, tails)
    ]
    return LabelledBlock((before + text + rest).strip(_BETWEEN + _OPENING), tuple(names))


def _rest(label: str, tails: Sequence[str]) -> str:
    """What belongs to a label behind the signs that differ: the rest of its word, or of its number and its unit.

    >>> _rest("2", ["00 g Time", "00 g Temp"]), _rest("Run A", ["bove t", "bove T"]), _rest("Run 1", [" T", " V"])
    ('00 g', 'bove', '')
    """
    shared = _shared(tails)
    if label[-1:].isalpha() and not _UNIT_BEGAN.search(label):
        return _whole(_WORD.match(shared), tails)
    number = _whole(_NUMBER.match(shared), tails) if not label[-1:].isalpha() else ""
    began = _UNIT_BEGAN.search(label + number)
    more = _UNIT_GOES_ON.match(shared[len(number) :])
    if began and more and known_unit(began[1] + more[0].strip(" _")):
        return number + _whole(more, [tail.removeprefix(number) for tail in tails]) or number
    return number


def _whole(match: re.Match[str] | None, tails: Sequence[str]) -> str:
    """The text of a match at the start of names if a word ends there in all of them, "" otherwise."""
    if not match or any(tail[match.end() :][:1].isalnum() for tail in tails):
        return ""
    return match[0]


def _word_end(shared: str) -> str:
    """The end of names that they share, from the first sign between words on; digits at the end are of a number."""
    places = [k for k, sign in enumerate(shared) if sign in _BETWEEN + _OPENING]
    return shared[places[0] :] if places else shared[len(shared.rstrip("0123456789")) :]
