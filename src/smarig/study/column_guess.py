"""Guesses the quantity and unit of each column of a table, each with its reason and a confidence."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from smarig.core import shown
from smarig.exchange import FoundColumn, FoundTable, continued_counts, convert, dimension, known_unit
from smarig.study import quantity_words as q
from smarig.study.column_facts import ColumnFacts, column_facts, counts_rows, steps_of
from smarig.study.default_names import default_names
from smarig.study.leading_units import leading_units
from smarig.study.message_units import REASON, are_messages, si_unit
from smarig.study.quantity_units import (
    is_of_motion,
    is_rate_unit,
    is_strain_unit,
    quantity_in_unit,
    quantity_of_unit,
)
from smarig.study.shared_prefixes import shared_prefix

STATED, LIKELY, WEAK, NONE = 0.95, 0.75, 0.5, 0.2  # confidences
UNSURE = 0.5  # a role or unit that is less sure needs an answer
_WHATEVER_UNIT = (q.RATE, q.INDEX, q.SCATTER, q.STATUS)  # quantities that a name states whatever the unit is
_ANY_TIME = "assumed: equal steps of whole numbers may be s, ms or others"
ASSUMED = "assumed: no unit is stated"
_STRAIN_MM = 0.1  # larger strains are not in mm/mm
_STRAIN_PERCENT = 15.0
_MOST_RATIO = 1.5  # of a pressure or a humidity to that of saturation
_SYMMETRIC = 0.05  # of the range: a middle closer to 0
_BOTH_WAYS = 0.25  # of the range: the same for two columns that go about 0 together
_KELVIN_ABOVE = 200.0  # a temperature that never falls below is in K
_LAST_S = 2.0**32  # from 1970: no clock of 32 bits goes on
_OF_TEMPERATURE = re.compile(r"dT|[Tt]emp|heating|cooling|[°K]C?\s*/|degC\s*/")
VALUE_IN_NAME = re.compile(r"(?<![\d.])(-?\d+(?:[.,]\d+)?)\s*_?(MPa|N|kgf|gf|lbf|degC|°C|C|Hz)(?![A-Za-z])")


@dataclass(frozen=True, eq=False)
class ColumnGuess:
    """The meaning of a column: quantity and unit, each with the reason and a confidence between 0 and 1."""

    facts: ColumnFacts
    label: str
    quantity: str
    quantity_reason: str
    quantity_confidence: float
    unit: str
    unit_reason: str
    unit_confidence: float
    commanded: bool = False
    # what says the quantity; "": its numbers, or nothing
    stated_by: Literal["", "name", "unit", "clock"] = ""
    unit_by_numbers: bool = False  # neither the file nor the user states the unit

    @property
    def name(self) -> str:
        """The name of the column in the file."""
        return self.facts.name

    @property
    def unit_is_assumed(self) -> bool:
        """Whether neither the file nor the user states the unit, and the numbers do not tell it: those of a temperature
        are plausible in several.
        """
        plausible = self.unit_by_numbers and self.quantity in (q.TEMPERATURE, q.AMBIENT)
        return bool(self.unit) and (self.unit_confidence <= WEAK or plausible)

    @property
    def by_numbers(self) -> bool:
        """Whether neither its name nor its unit says what the column is."""
        return not self.stated_by

    @property
    def is_named(self) -> bool:
        """Whether its name says what the column is; a unit alone does not tell it from others in that unit."""
        return self.stated_by == "name"

    @property
    def is_flag(self) -> bool:
        """Whether it is a state of the instrument, on or off: zeros and ones, of which nothing says a quantity."""
        return self.facts.is_flag and self.by_numbers and not self.unit

    def without_meaning(self) -> "ColumnGuess":
        """The guess without the quantity and unit that its numbers alone suggested."""
        return replace(
            self,
            quantity="",
            quantity_reason="",
            quantity_confidence=0.0,
            unit="",
            unit_reason="",
            unit_confidence=0.0,
            stated_by="",
            unit_by_numbers=False,
        )

    def with_stated_unit(self) -> "ColumnGuess":
        """The guess with its unit only if the file or the user states one of numbers."""
        if self.facts.known.size and not self.unit_by_numbers:
            return self
        return replace(self, unit="", unit_reason="", unit_confidence=0.0, unit_by_numbers=False)

    def corrected(self, unit: str) -> "ColumnGuess":
        """The guess with a unit that the user gave."""
        strain = self.by_numbers and dimension(unit) == "ratio" and self.quantity == q.DISPLACEMENT
        by_unit = q.STRAIN if strain else quantity_of_unit(unit)
        other = by_unit and dimension(unit) not in q.DIMENSIONS.get(self.quantity, ())
        reason = f"its unit {unit}" if self.quantity else ""  # without any, the loop still decides the roles
        meant = self
        if other and self._may_follow_unit:
            meant = replace(_found(self, by_unit, reason, LIKELY), stated_by="unit" if reason else "")
        return replace(
            meant,
            unit=unit,
            unit_reason="given by you",
            unit_confidence=1.0,
            unit_by_numbers=False,
            quantity_confidence=max(meant.quantity_confidence, LIKELY if meant.quantity else 0.0),
        )

    @property
    def _may_follow_unit(self) -> bool:
        """Whether a unit says more of the quantity than what is known of it."""
        return self.by_numbers or self.quantity not in _WHATEVER_UNIT


def guess_columns(
    table: FoundTable, units: Mapping[str, str], files: Sequence[str] = ()
) -> list[ColumnGuess]:
    """A guess for each column of a table. ``units`` are given by the user; ``files`` names of files of this layout."""
    guesses = _by_names_and_numbers(table, [table.path.name, table.path.stem, *files])
    guesses = _with_steps_as_rates(guesses)
    if are_messages(table.names):
        guesses = [_in_message(guess) for guess in guesses]
    guesses = [_continued(_with_unit(guess)) for guess in guesses]
    return [g.corrected(units[g.name]) if g.name in units else g for g in guesses]


def _by_names_and_numbers(table: FoundTable, files: Sequence[str]) -> list[ColumnGuess]:
    """The guesses by names and units, and by numbers where these say nothing."""
    prefix, numbered = shared_prefix(table.names), default_names(table.names)
    if any(c.unit for c in table.columns):
        numbered = ()  # "V1 [V]" names a voltage
    leading = leading_units(table.columns)
    named = [
        _by_name(
            column_facts(replace(c, unit=leading.get(c.name, c.unit))),
            f"{leading[c.name]} " if c.name in leading else prefix,
        )
        for c in table.columns
        if c.name not in numbered
    ]
    columns = [c for c in table.columns if c.name in numbered]
    bare = [_by_name(column_facts(replace(c, name=f"column {k}"))) for k, c in enumerate(columns, start=1)]
    found = [
        replace(
            guess if guess.quantity in q.NO_SIGNALS else guess.without_meaning(),
            facts=replace(guess.facts, name=c.name),
        )
        for guess, c in zip(_by_numbers(bare, files), columns)
    ]
    guesses = {guess.name: guess for guess in (*_by_numbers(named, files), *found)}
    return [guesses[name] for name in table.names]


def _in_message(guess: ColumnGuess) -> ColumnGuess:
    """The guess with the unit that its quantity has in a message, if its name states the quantity and no unit; whole
    numbers are counts of a converter.
    """
    counts = guess.facts.whole and guess.quantity in (q.DISPLACEMENT, q.ANGLE, q.FORCE)
    unit = "" if guess.unit or guess.unit_reason or guess.by_numbers or counts else si_unit(guess.quantity)
    return replace(guess, unit=unit, unit_reason=REASON, unit_confidence=LIKELY) if unit else guess


def _continued(guess: ColumnGuess) -> ColumnGuess:
    """The guess with the counts of an encoder continued where its register passes an end."""
    if guess.unit != "count" or guess.quantity not in (q.DISPLACEMENT, q.ANGLE):
        return guess
    f = guess.facts
    counts = continued_counts(f.values)
    return replace(guess, facts=column_facts(FoundColumn(f.name, f.written_unit, counts, f.kind, f.comment)))


def _by_name(facts: ColumnFacts, prefix: str = "") -> ColumnGuess:
    """The quantity by name, without a prefix that other names share, and unit."""
    name = "" if _nameless(facts.name) else facts.name.removeprefix(prefix)
    label, written = q.name_and_unit(name, facts.written_unit)
    written = written or (label if _is_part_of_second(label) else "")
    whole = q.is_quotient(label)  # dB/dt and dL/L0 are no paths
    parts = [label] if whole else label.split("/")[::-1]  # of a path, the last that says something
    quantities = [q.quantity_of_name(part) for part in parts if part]
    quantity, commanded = next(
        (found for found in quantities if found[0]), quantities[0] if quantities else ("", False)
    )
    quantity = quantity or q.quantity_of_name(q.without_branch(label))[0]
    commanded = commanded or q.is_remarked_as_commanded(facts.comment)
    unit = known_unit(
        written, temperature=quantity in (q.TEMPERATURE, q.AMBIENT) or label.strip().lower() in ("t", "temp")
    )
    if label.strip() in ("T", "ϑ", "θ", "Θ") and dimension(unit or "K") == "temperature":
        quantity = q.TEMPERATURE if unit or not (facts.rising and facts.even) else q.TIME
    celsius = unit == written.strip() == "C" and not quantity
    if celsius and like_temperature(facts):
        quantity, unit = q.TEMPERATURE, "degC"
    quantity = quantity_in_unit(quantity, unit, label)
    by_unit = q.STRAIN if is_strain_unit(written) else quantity_of_unit(unit)
    by_unit = q.RATE if is_rate_unit(written) else by_unit
    confidence = LIKELY if quantity else 0.0
    reason = f"its name {shown(label)}" if quantity else ""
    stated_by: Literal["", "name", "unit", "clock"] = "name" if quantity else ""
    if (
        by_unit
        and (by_unit == q.RATE or dimension(unit) not in q.DIMENSIONS.get(quantity, ()))
        and (quantity not in _WHATEVER_UNIT or by_unit == q.TIME)  # "sample rate [s]" states a time
    ):
        quantity, reason, confidence = by_unit, f"its unit {unit or written}", LIKELY
        stated_by = "unit"
    elif quantity == q.CHARGE and not unit:
        quantity, reason, confidence = "", "", 0.0  # "charge" is a load in French
    elif by_unit and quantity:
        confidence, reason = STATED, f"its name {shown(label)} and its unit {unit or written}"
    counter = (
        counts_rows(facts) and not unit and (quantity == q.DISPLACEMENT or q.is_letter_with_index(label))
    )
    if counter or (quantity == q.DISPLACEMENT and not is_of_motion(written)):
        quantity, reason, confidence = "", "", 0.0
    if facts.kind == "clock":
        quantity, unit, reason, confidence = q.TIME, "s", "clock times", STATED
        stated_by = "clock"
    if written and not unit:
        unit_reason, unit_confidence = f"written as {shown(written)}, which is unknown", NONE
    elif celsius and quantity:
        reason, confidence, stated_by = f"its unit C, and {_as_celsius(facts)}", LIKELY, "unit"
        unit_reason, unit_confidence = "C stands for °C where no name means a charge", LIKELY
    else:
        unit_reason, unit_confidence = ("stated in the file", STATED) if unit else ("", 0.0)
    stated_by = stated_by if quantity else ""
    return ColumnGuess(
        facts, label, quantity, reason, confidence, unit, unit_reason, unit_confidence, commanded, stated_by
    )


def _is_part_of_second(label: str) -> bool:
    """Whether a name is only the unit of a part of a second, such as "ms"; longer units of time are words too."""
    unit = known_unit(label)
    return dimension(unit) == "time" and convert(1.0, unit, "s") < 1


def _nameless(name: str) -> bool:
    return re.fullmatch(r"column \d+|\S+/column \d+", name) is not None


def _is_log(guesses: Sequence[ColumnGuess]) -> bool:
    """Whether a table has three columns or more, and no names."""
    return len(guesses) > 2 and all(_nameless(guess.name) for guess in guesses)


def _by_numbers(guesses: list[ColumnGuess], files: Sequence[str]) -> list[ColumnGuess]:
    """Quantities of columns whose names and units say nothing, by their numbers and by the names of the files."""
    out = []
    for k, guess in enumerate(guesses):
        f = guess.facts
        if guess.quantity or not f.known.size:
            out.append(guess)
        elif f.even and f.whole and f.rising and f.step != 1 and k == 0 and _is_log(guesses):
            found = _found(guess, q.TIME, f"rises in equal steps of {f.step:g}, in the first column", LIKELY)
            out.append(
                replace(found, unit="s", unit_reason=_ANY_TIME, unit_confidence=NONE, unit_by_numbers=True)
            )
        elif f.rising and f.whole and f.even and f.low >= 0:
            out.append(_found(guess, q.INDEX, "whole numbers that rise evenly", LIKELY))
        elif (
            f.rising
            and k == 0
            and f.levels > 0.5 * f.known.size
            and (f.low >= 0 or len(guesses) > 2)  # two columns from below 0: a branch of a loop
        ):
            out.append(_found(guess, q.TIME, "rises from row to row, in the first column", LIKELY))
        elif f.levels <= 3 and f.span < 1e-3 and not f.constant:
            out.append(
                _found(guess, q.INDEX, "two or three tiny values in turn: a time within a pair of rows", WEAK)
            )
        elif f.constant and (found := _value_in_name(f, files)):
            out.append(
                _found(guess, found, f"its value {np.mean(f.known):.4g} is in the file's name", LIKELY)
            )
        else:
            out.append(guess)
    unknown = [g for g in out if not g.quantity and g.facts.known.size and g.facts.span > 0]
    both_ways = [g for g in unknown if _about_zero(g.facts, _BOTH_WAYS)]  # as force and travel of a damper
    able = [g for g in unknown if _may_be_temperature(g) and not (g in both_ways and len(both_ways) > 1)]
    warm = [g for g in able if like_temperature(g.facts)]
    widest = max(warm, key=lambda g: g.facts.span, default=None)
    warm = [g for g in warm if widest is not None and _near(g.facts, widest.facts)]
    has_temperature = any(g.quantity == q.TEMPERATURE for g in out)
    for guess in warm if not has_temperature else []:
        out[out.index(guess)] = _found(guess, q.TEMPERATURE, _as_celsius(guess.facts), LIKELY)
    for guess in [g for g in out if g in unknown and is_of_motion(_written(g.facts))]:
        loaded = any(g.quantity == q.STRESS for g in out)
        most = max(abs(guess.facts.low), abs(guess.facts.high))
        hot = any(g.quantity == q.TEMPERATURE for g in out)
        may_be_strain = not guess.unit or dimension(guess.unit) == "ratio"
        if may_be_strain and ((hot and most < _STRAIN_MM) or (loaded and most < _STRAIN_PERCENT)):
            reason = "its range is that of a strain" + (" beside a stress" if loaded else "")
            out[out.index(guess)] = _found(guess, q.STRAIN, reason, 0.7)
        elif hot and not guess.facts.constant and _may_move(guess.facts):
            out[out.index(guess)] = _found(guess, q.DISPLACEMENT, "what moves beside a temperature", 0.6)
    return out


def _as_celsius(f: ColumnFacts) -> str:
    return f"goes up and down from {f.low:.3g} to {f.high:.3g}, as temperatures in °C do"


def _written(facts: ColumnFacts) -> str:
    """The unit of a column as the file writes it."""
    return q.name_and_unit("" if _nameless(facts.name) else facts.name, facts.written_unit)[1]


def _may_move(facts: ColumnFacts) -> bool:
    """Whether numbers may be positions: a named column of two whole numbers is a switch."""
    return not (facts.whole and facts.levels <= 2 and not _nameless(facts.name))


def _near(a: ColumnFacts, b: ColumnFacts) -> bool:
    """Whether two columns show one quantity: their medians differ by less than a fifth of the wider range."""
    return bool(
        abs(np.nanmedian(a.values) - np.nanmedian(b.values)) <= 0.2 * b.span and a.span > 0.5 * b.span
    )


def like_temperature(f: ColumnFacts) -> bool:
    """Whether numbers may be temperatures of a wire in °C: they pass 15, begin between −60 and 200, and are not
    symmetric about 0 as fields and voltages are.
    """
    if _about_zero(f, _SYMMETRIC):
        return False
    return not f.constant and f.span > 15 and f.low > -200 and 15 < f.high < 800 and -60 < f.known[0] < 200


def _may_be_temperature(guess: ColumnGuess) -> bool:
    """Whether neither the name nor the unit of a column says that it is something else."""
    of_unit = not guess.unit or dimension(guess.unit) == "temperature"
    return of_unit and not q.names_another(guess.label)


def _about_zero(f: ColumnFacts, share: float) -> bool:
    """Whether the middle of a range is close to 0: within a share of the range."""
    return abs(f.low + f.high) < share * f.span


def _value_in_name(f: ColumnFacts, files: Sequence[str]) -> str:
    """The quantity of a nearly constant column whose value a file's name states with a unit."""
    mean = float(np.mean(f.known))
    for text in files:
        for value, unit in VALUE_IN_NAME.findall(text):
            if abs(float(value.replace(",", ".")) - mean) <= 0.05 * abs(mean):
                return "frequency" if unit == "Hz" else quantity_of_unit(unit) or q.TEMPERATURE
    return ""


def is_rate_of_output(guess: ColumnGuess) -> bool:
    """Whether a column that moves is the rate of what could be an output, and not that of a temperature."""
    f = guess.facts
    moves = f.known.size > 1 and f.span > 0
    return guess.quantity == q.RATE and moves and not _OF_TEMPERATURE.search(guess.name)


def _with_steps_as_rates(guesses: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """The guesses; a column that holds the step of another one from row to row, as a charge per row, is a rate."""
    found = []
    for guess in guesses:
        others = [g for g in guesses if g is not guess and dimension(g.unit) == dimension(guess.unit)]
        whole = next((g for g in others if guess.quantity != q.TIME and steps_of(guess.facts, g.facts)), None)
        reason = f"its sum is {shown(whole.name)}" if whole else ""
        found.append(_found(guess, q.RATE, reason, STATED) if whole else guess)
    return found


def _found(guess: ColumnGuess, quantity: str, reason: str, confidence: float) -> ColumnGuess:
    """The guess with a quantity that its numbers suggest."""
    return replace(
        guess, quantity=quantity, quantity_reason=reason, quantity_confidence=confidence, stated_by=""
    )


def as_temperature(guess: ColumnGuess) -> ColumnGuess:
    """A column as a temperature, as its name says."""
    return _with_unit(
        _found(guess.without_meaning(), q.TEMPERATURE, f"its name {shown(guess.label)}", LIKELY)
    )


def as_force_reading(guess: ColumnGuess) -> ColumnGuess:
    """A column without a name beside the masses that load a sensor: whole numbers are its readings, no temperatures."""
    if not guess.facts.whole or not is_of_motion(_written(guess.facts)):
        return guess.without_meaning() if guess.quantity == q.TEMPERATURE else guess
    stated = guess.with_stated_unit()
    return _with_unit(_found(stated, q.FORCE, "what is read in whole numbers beside masses", LIKELY))


def displacement_confidence(guess: ColumnGuess) -> float:
    """How sure it is that a displacement without a unit is in mm: a column whose name says something else, a unit that
    is not known for example, may be any quantity.
    """
    return NONE if guess.label and guess.by_numbers else WEAK


def _with_unit(guess: ColumnGuess) -> ColumnGuess:
    """The guess with a unit where the file states none."""
    f = guess.facts
    if guess.unit or not guess.quantity or not f.known.size:
        return guess
    most = max(abs(f.low), abs(f.high))
    match guess.quantity:
        case q.TEMPERATURE | q.AMBIENT:
            low = f.lowest_reading
            unit = "K" if low > _KELVIN_ABOVE else "degC"
            reason, sure = f"{low:.3g} to {f.high:.3g} are plausible temperatures in {unit}", LIKELY
        case q.STRAIN:
            unit = "mm/mm" if most < _STRAIN_MM else "%" if most < _STRAIN_PERCENT else "ppm"
            reason, sure = f"{most:.3g} {unit} is a usual strain of these wires", LIKELY
        case q.STRESS:
            unit = "Pa" if most > 1e5 else "MPa"
            reason, sure = f"{most:.3g} is a usual stress in {unit}", LIKELY
        case q.TIME if f.low > _LAST_S:
            parts = (("ms", 1e3), ("us", 1e6), ("ns", 1e9))
            unit = next((unit for unit, number in parts if f.low <= _LAST_S * number), "s")
            reason, sure = "as seconds, its times would lie after the year 2106", LIKELY
        case q.TIME:
            unit, reason, sure = "s", "the usual unit of time", 0.7
        case q.CURRENT | q.VOLTAGE | q.RESISTANCE | q.POWER:
            unit = {q.CURRENT: "A", q.VOLTAGE: "V", q.RESISTANCE: "ohm", q.POWER: "W"}[guess.quantity]
            reason, sure = "the SI unit, as none is stated", WEAK
        case q.RELATIVE_PRESSURE | q.HUMIDITY | q.WATER_CONTENT:
            unit, reason, sure = ("%" if most > _MOST_RATIO else "1"), "its range", 0.6
        case q.DUTY:
            unit, reason, sure = ("%" if 1 < most <= 100 else "1" if most <= 1 else "count"), "its range", 0.6
        case q.FORCE if f.whole and most > 100:
            unit, reason, sure = "count", "whole numbers: readings of a converter", 0.7
        case q.FORCE:
            unit, reason, sure = "N", "the SI unit, as none is stated", WEAK
        case q.DISPLACEMENT | q.ANGLE if f.whole and most > 100:
            unit, reason, sure = "count", "whole numbers: readings of an encoder or converter", WEAK
        case q.DISPLACEMENT:
            unit, reason, sure = "mm", ASSUMED, displacement_confidence(guess)
        case q.ANGLE:
            unit, reason, sure = "deg", ASSUMED, WEAK
        case q.FIELD:
            unit = "A/m" if most > 20 else "T"
            reason, sure = f"{most:.3g} would be extreme in another unit", WEAK
        case q.FLUX:
            unit, reason, sure = "T", f"{most:.3g} is a usual flux density in T", 0.7
        case _:
            return guess
    if guess.unit_reason:  # the file states a unit, but an unknown one: an assumption would contradict it
        by_range = guess.quantity in (q.TEMPERATURE, q.AMBIENT)
        reason, sure = f"{guess.unit_reason}; taken as {unit}", WEAK if by_range else NONE
    return replace(guess, unit=unit, unit_reason=reason, unit_confidence=sure, unit_by_numbers=True)
