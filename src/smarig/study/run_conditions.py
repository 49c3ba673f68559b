"""Columns that were held in each run and differ between runs: conditions of the runs, whatever they measure."""

from collections.abc import Sequence
from dataclasses import replace

from smarig.study import quantity_words as q
from smarig.study.column_guess import LIKELY, ColumnGuess
from smarig.study.stated_conditions import condition_name, may_be_condition
from smarig.study.table_guess import Role, TableGuess

_REASON = "{}held in each run and different between runs"


def with_run_conditions(guesses: Sequence[TableGuess]) -> list[TableGuess]:
    """The guesses of several runs, in which columns that differ more between runs than within any are conditions."""
    shared = set.intersection(*(set(guess.roles) for guess in guesses)) if len(guesses) > 1 else set()
    found = {
        name: Role("condition", _reason(guesses[0], name), LIKELY)
        for name in shared
        if _is_condition(name, guesses)
    }
    return [replace(guess, roles=guess.roles | _new(found, guess)) for guess in guesses]


def _is_condition(name: str, guesses: Sequence[TableGuess]) -> bool:
    """Whether a column that is not used differs between the runs; one of the quantity of the output is a result."""
    columns = [_column(guess, name) for guess in guesses]
    results = {c.quantity for guess in guesses for c in guess.of_role("output")} - {""}
    unused = all(
        guess.roles[name].role == "ignored" and name not in guess.branches.values() for guess in guesses
    )
    known = all(_has_values(c) and c.quantity not in results for c in columns)
    return unused and known and _differ(columns)


def _has_values(c: ColumnGuess) -> bool:
    """Whether a column holds readings in a unit that is known, or none."""
    known = bool(c.unit) or not (c.facts.written_unit or c.unit_reason)
    return (
        c.facts.kind == "number"
        and bool(c.facts.known.size)
        and c.quantity not in q.NO_SIGNALS
        and known
        and may_be_condition(c)
    )


def _differ(columns: Sequence[ColumnGuess]) -> bool:
    """Whether the levels of a column in the runs lie further apart than its values in any of them; equal levels are
    one.
    """
    ends = sorted((float(c.facts.low), float(c.facts.high)) for c in columns)
    levels = [ends[0]]
    for low, high in ends[1:]:
        if low <= levels[-1][1]:
            levels[-1] = (levels[-1][0], max(high, levels[-1][1]))
        else:
            levels.append((low, high))
    widest = max(high - low for low, high in ends)
    return len(levels) > 1 and widest < min(b[0] - a[1] for a, b in zip(levels, levels[1:]))


def _new(found: dict[str, Role], guess: TableGuess) -> dict[str, Role]:
    """The conditions that a table does not have yet; of two of one name the first counts."""
    known = {condition_name(c) for c in guess.of_role("condition")}
    new = {}
    for c in guess.columns:
        if c.name in found and condition_name(c) not in known:
            known.add(condition_name(c))
            new[c.name] = found[c.name]
    return new


def _reason(guess: TableGuess, name: str) -> str:
    quantity = _column(guess, name).quantity
    return _REASON.format(f"{quantity}, " if quantity else "")


def _column(guess: TableGuess, name: str) -> ColumnGuess:
    return next(c for c in guess.columns if c.name == name)
