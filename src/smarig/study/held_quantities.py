"""Whether a quantity was held: throughout, or at several levels while another one went there and back."""

from dataclasses import replace

import numpy as np

from smarig.core import Array
from smarig.exchange import FoundColumn
from smarig.measurement import noise_range
from smarig.study import quantity_words as q
from smarig.study.column_facts import column_facts
from smarig.study.column_guess import ColumnGuess
from smarig.study.input_turns import wide_turns

_FEWEST_TURNS = 3  # with both ends: there and back
_STRESS_SHARE = 0.5  # of the mean: spread within which a stress was held
_FORCE_SHARE = 0.1  # the same for a force
_HELD_K = 5.0  # the same for a temperature


def held_levels(load: ColumnGuess, drive: ColumnGuess) -> list[slice]:
    """The rows of each level at which a load is held for a cycle of another quantity or more; none if there are not two
    such levels.
    """
    rows = [part for part in _parts_with_travel(load.facts.values, drive) if _has_cycle(drive, part)]
    return rows if len(rows) > 1 and all(holds_still(_rows_of(load, part)) for part in rows) else []


def holds_still(c: ColumnGuess) -> bool:
    """Whether a load, field or temperature was held, whatever noise it has. Other columns count if they move at all.

    A field may be held at zero: its noise differs from row to row, and a path does not.
    """
    mean, spread = (abs(float(np.mean(c.facts.known))), c.facts.spread) if c.facts.known.size else (0.0, 0.0)
    if c.quantity == q.STRESS:
        noise = is_noise(c) and mean > 3 * float(np.std(c.facts.known))
        return spread <= _STRESS_SHARE * mean or noise
    if c.quantity == q.FORCE:
        return c.unit != "count" and spread <= _FORCE_SHARE * mean
    if c.quantity == q.FIELD:
        return c.facts.constant or is_noise(c)
    if c.quantity == q.TEMPERATURE:
        return c.facts.span < _HELD_K
    return c.facts.levels <= 1


def is_noise(c: ColumnGuess) -> bool:
    """Whether the motion of a column is its scatter: each value differs from the next as from any other."""
    return scatters(c.facts.known)


def scatters(x: Array) -> bool:
    """Whether neighbouring values (n,) differ as any two of them do."""
    return bool(x.size > 10 and np.std(np.diff(x)) > np.std(x))


def _parts_with_travel(load: Array, drive: ColumnGuess) -> list[slice]:
    """The rows of each level of a load, one level after the other, in which the input travels half its range or more.

    Between levels is a step of more than the range of the noise. Rows on the way from level to level are parts of
    their own.
    """
    known = np.flatnonzero(np.isfinite(load))
    x = load[known]
    if x.size < _FEWEST_TURNS:
        return []
    ordered = np.sort(x)
    gaps = np.flatnonzero(np.diff(ordered) > noise_range(x))
    level = np.searchsorted((ordered[gaps] + ordered[gaps + 1]) / 2, x)
    first = np.concatenate([[0], np.flatnonzero(np.diff(level)) + 1])
    last = np.concatenate([first[1:], [x.size]]) - 1
    u = drive.facts.values[known]
    travel = np.fmax.reduceat(u, first) - np.fmin.reduceat(u, first)
    wide = np.flatnonzero(2 * travel > drive.facts.span)
    return [slice(int(known[first[k]]), int(known[last[k]]) + 1) for k in wide]


def _has_cycle(drive: ColumnGuess, part: slice) -> bool:
    """Whether the input goes there and back in these rows."""
    u = drive.facts.values[part]
    return wide_turns(u[np.isfinite(u)]).size >= _FEWEST_TURNS


def _rows_of(c: ColumnGuess, part: slice) -> ColumnGuess:
    """A column in some rows, as in a table of its own."""
    f = c.facts
    return replace(
        c, facts=column_facts(FoundColumn(f.name, f.written_unit, f.values[part], f.kind, f.comment))
    )
