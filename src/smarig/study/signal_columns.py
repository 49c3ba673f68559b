"""Chooses the columns of input and output by their quantities; a load that was held is neither."""

import re
from collections.abc import Sequence

import numpy as np

from smarig.core import Array, correlation
from smarig.study import quantity_words as q
from smarig.study.column_guess import STATED, UNSURE, ColumnGuess
from smarig.study.derived_charges import is_integral_of_current, of_terminal
from smarig.study.displacement_places import specimens_displacement
from smarig.study.held_quantities import held_levels, holds_still, is_noise, scatters
from smarig.study.known_masses import known_mass
from smarig.study.physical_roles import leads
from smarig.study.strain_columns import axial_strain
from smarig.study.thermometer_places import distance

_OUTPUTS = (
    q.WATER_CONTENT,
    q.ADSORBED,
    q.STRAIN,
    q.MOMENT,
    q.MAGNETISATION,
    q.POLARISATION,
    q.FLUX,
    q.DISPLACEMENT,
    q.ANGLE,
    q.FORCE,
    q.STRESS,
    q.MODULUS,
    q.RESISTANCE,
    q.RESISTIVITY,
    q.HEAT_FLOW,
    q.MASS,
)
_INPUTS = {
    q.MOMENT: (q.FIELD, q.TEMPERATURE, q.CURRENT, q.VOLTAGE),
    q.MAGNETISATION: (q.FIELD, q.TEMPERATURE, q.CURRENT, q.VOLTAGE),
    q.FLUX: (q.FIELD, q.CURRENT, q.VOLTAGE),
    q.POLARISATION: (q.ELECTRIC_FIELD, q.VOLTAGE, q.FIELD),
    q.STRESS: (q.TEMPERATURE, q.STRAIN),
    q.HEAT_FLOW: (q.TEMPERATURE,),
    q.CHARGE: (q.VOLTAGE, q.ELECTRIC_FIELD, q.CURRENT, q.TEMPERATURE),
    q.VOLTAGE: (q.CHARGE, q.TEMPERATURE, q.MASS),
    q.WATER_CONTENT: (q.MATRIC_POTENTIAL, q.RELATIVE_PRESSURE, q.HUMIDITY, q.TEMPERATURE),
    q.ADSORBED: (q.RELATIVE_PRESSURE, q.HUMIDITY, q.PRESSURE, q.TEMPERATURE),
    q.MASS: (q.RELATIVE_PRESSURE, q.HUMIDITY, q.PRESSURE, q.TEMPERATURE, q.FIELD, q.CURRENT),
}
_MECHANICAL = (  # what was measured at the specimen, before the current or voltage that causes it
    q.TEMPERATURE,
    q.FIELD,
    q.FLUX,
    q.CURRENT,
    q.ELECTRIC_FIELD,
    q.VOLTAGE,
    q.POWER,
    q.DUTY,
    q.STRESS,
    q.FORCE,
    q.PRESSURE,
    q.RELATIVE_PRESSURE,
    q.HUMIDITY,
    q.MATRIC_POTENTIAL,
    q.MASS,
)
_HEATS = (q.CURRENT, q.POWER, q.DUTY)
_TOGETHER = 0.5  # least correlation of a voltage with what heats with it
SENSOR_SIGNALS = (q.VOLTAGE, q.CURRENT)
_EXTENSOMETER = re.compile(r"extens[oó]m|estensim|dehnungsaufnehmer|feindehn", re.IGNORECASE)


def output_column(left: Sequence[ColumnGuess], named: str | None, not_this: str | None) -> ColumnGuess | None:
    if named is not None:
        return next((c for c in left if c.name == named), None)
    able = [c for c in left if c.name != not_this and not holds_still(c)]
    follow = [c for c in able if not is_noise(c)]  # noise follows no input, whatever its name
    return _output_among(follow) or _output_among(able)


def _output_among(columns: Sequence[ColumnGuess]) -> ColumnGuess | None:
    masses = known_mass(columns)
    able = [c for c in columns if c is not masses]
    hot = any(c.quantity == q.TEMPERATURE for c in able)
    stated = [c for c in able if c.quantity in _OUTPUTS and not c.by_numbers]
    able = stated or able  # what a name or a unit says counts more than what numbers look like
    for quantity in _OUTPUTS:
        found = [c for c in able if c.quantity == quantity]
        if quantity == q.STRESS and any(c.quantity == q.FORCE for c in able) and not hot:
            continue
        if found:
            found = [c for c in found if not c.commanded] or found
            best = max(found, key=lambda c: (*_certainty(c), -able.index(c)))
            if quantity in (q.DISPLACEMENT, q.ANGLE) and not best.by_numbers:
                return specimens_displacement(best, rivals_of(best, found))
            return axial_strain([best, *found]) if quantity == q.STRAIN else best
    return _output_with_charge(able) or _read_voltage(able, masses)


def rivals_of(out: ColumnGuess, columns: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """The other columns that are as surely of the quantity of an output as itself."""
    return [
        c for c in columns if c is not out and c.quantity == out.quantity and _certainty(c) == _certainty(out)
    ]


def _certainty(c: ColumnGuess) -> tuple[bool, bool, bool]:
    """How sure a column is what its quantity says; an extensometer sits at the specimen."""
    at_specimen = c.quantity == q.DISPLACEMENT and _EXTENSOMETER.search(c.label) is not None
    return not c.by_numbers, c.unit_confidence > UNSURE, at_specimen


def _output_with_charge(able: Sequence[ColumnGuess]) -> ColumnGuess | None:
    """The output beside a charge: the voltage of a cell, whose charge in A h a current counts; else the charge, in
    coulombs, that a voltage moves, unless it is the integral of the current and a sensor was read beside it.
    """
    charge = next((c for c in able if c.quantity == q.CHARGE), None)
    voltage = next((c for c in able if c.quantity == q.VOLTAGE and not c.commanded), None)
    counted = charge is not None and charge.unit.endswith("h")
    return voltage if counted else voltage_with_charge(able) or charge


def voltage_with_charge(able: Sequence[ColumnGuess]) -> ColumnGuess | None:
    """The voltage of a sensor, which is no copy of another voltage, beside a charge that is no reading."""
    charge = next((c for c in able if c.quantity == q.CHARGE and is_integral_of_current(c, able)), None)
    if charge is None:
        return None
    voltages = [c for c in able if c.quantity == q.VOLTAGE]
    electrodes = [c for c in voltages if not of_terminal(c)]
    sensors = [c for c in voltages if of_terminal(c) and not is_noise(c)]
    return next((c for c in sensors if electrodes and not any(is_signal_of(c, e) for e in electrodes)), None)


def _read_voltage(able: Sequence[ColumnGuess], masses: ColumnGuess | None) -> ColumnGuess | None:
    """A voltage that was read beside a temperature, as that of a divider, or beside masses. One that heats moves with
    its current or power, was commanded, or leads the temperature.
    """
    voltages = [c for c in able if c.quantity == q.VOLTAGE]
    if all(map(is_noise, voltages)):
        return None  # a supply
    if len(voltages) == 1 and masses is not None and not any(c.quantity in _HEATS for c in able):
        return voltages[0]  # of a bridge
    warm = next((c for c in able if c.quantity == q.TEMPERATURE), None)
    heated = len(voltages) > 1 or any(_moves_with(c, voltages) for c in able if c.quantity in _HEATS)
    if not voltages or warm is None or heated or voltages[0].commanded:
        return None
    return None if leads(voltages[0].facts.values, warm.facts.values) else voltages[0]


def _moves_with(c: ColumnGuess, voltages: Sequence[ColumnGuess]) -> bool:
    """Whether a current or a power rather rises and falls with a voltage than not, as both do in a wire that they heat;
    a current that only serves to read the voltage stays, and that of another device goes its way.
    """
    for voltage in voltages:
        known = np.isfinite(c.facts.values) & np.isfinite(voltage.facts.values)
        if known.sum() < 3 or correlation(c.facts.values[known], voltage.facts.values[known]) >= _TOGETHER:
            return True
    return False


def input_column(
    left: Sequence[ColumnGuess], out: ColumnGuess | None, named: str | None
) -> ColumnGuess | None:
    if named is not None:
        return next((c for c in left if c.name == named), None)
    able = [c for c in left if c is not out and not holds_still(c)]
    able = [c for c in able if out is None or not is_signal_of(c, out)]
    order = _INPUTS.get(out.quantity, _MECHANICAL) if out else _MECHANICAL
    order = _INPUTS[q.CHARGE] if out is not None and out is voltage_with_charge(left) else order
    others = [c for c in able if c.quantity in order and _is_swept(c)]
    able = [c for c in able if not _is_held_in_turn(c, others)]
    swept = [c for c in able if _is_swept(c)]
    return _input_among(swept, order) or _input_among(able, order)


def _input_among(able: Sequence[ColumnGuess], order: Sequence[str]) -> ColumnGuess | None:
    currents = [c for c in able if c.quantity == q.CURRENT]
    if any(is_grid(c) for c in currents):
        order = (q.CURRENT, *order)
    for quantity in order:
        found = [c for c in able if c.quantity == quantity and (quantity != q.FLUX or _is_stated(c))]
        if found:
            places = {c.name: distance(c) if quantity == q.TEMPERATURE else 0 for c in found}
            return min(found, key=lambda c: (c.commanded or is_grid(c), places[c.name], able.index(c)))
    nameless = [c for c in able if not c.quantity]
    return nameless[0] if nameless else None


def _is_held_in_turn(c: ColumnGuess, others: Sequence[ColumnGuess]) -> bool:
    """Whether a load was held at several levels, at each of which one of the others was swept there and back."""
    return c.quantity in q.HELD and any(held_levels(c, other) for other in others if other is not c)


def _is_swept(c: ColumnGuess) -> bool:
    """Whether a column moves by more than noise or a small part of its value."""
    return not is_noise(c) and (not c.facts.constant or c.quantity == q.TEMPERATURE)


def _is_stated(c: ColumnGuess) -> bool:
    """Whether both the name and the unit say the quantity: a letter such as B alone may name anything."""
    return c.quantity_confidence >= STATED


def is_grid(c: ColumnGuess) -> bool:
    """Whether readings are those of a staircase: equal steps from row to row, with a new level in each."""
    return c.quantity == q.CURRENT and c.facts.even and c.facts.levels == c.facts.known.size


def is_signal_of(c: ColumnGuess, out: ColumnGuess) -> bool:
    """Whether a voltage or current is the signal of the sensor of the output: a line between them, to within noise or
    their resolution, leaves no hysteresis.
    """
    known = np.isfinite(c.facts.values) & np.isfinite(out.facts.values)
    x, y = out.facts.values[known], c.facts.values[known]
    if c.quantity not in SENSOR_SIGNALS or is_noise(c) or x.size < 3 or not np.var(x):
        return False  # of readings in random order, the rest scatters as well
    slope = float(np.cov(x, y)[0, 1] / np.var(x, ddof=1))
    rest = y - y.mean() - slope * (x - x.mean())
    return scatters(rest) or bool(np.ptp(rest) <= _resolution(y) + abs(slope) * _resolution(x))


def _resolution(x: Array) -> float:
    """The least difference of two values."""
    return float(np.diff(np.unique(x)).min(initial=np.inf))
