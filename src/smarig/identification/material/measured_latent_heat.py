"""The latent heat from electrical power, where the temperature of the wire was measured along a continuous record.

    ∫ V i dt + V ∫ σ dε  =  hA ∫ (T − T_amb) dt + C ΔT − ρ V L Δξ

Each term is a sum between readings far apart, so nothing is differentiated; hA, C and L follow by least squares. The
work term is that of the load, as in the heat balance of the thermomechanical twin.
"""

from collections.abc import Sequence

import numpy as np

from smarig.core import Array
from smarig.identification.interval_estimate import Estimate, linear_fit
from smarig.identification.material.law import MaterialLaw, cooled_fraction, heated_fraction
from smarig.identification.material.material_records import MaterialRecord
from smarig.plant import Actuator
from smarig.preisach import turning_points
from smarig.record import Run

_CHANNELS = ("t_s", "current_A", "voltage_V", "temperature_degC", "ambient_degC", "position")
_PARTS = 200  # of a record: the balance is closed over each
_REVERSAL = 0.1  # of the range of the temperature
_PA = 1e6


def latent_heat(
    records: Sequence[MaterialRecord], law: MaterialLaw, actuator: Actuator | None
) -> Estimate | str:
    """L in J/kg from all records with power and a measured temperature, or why there is none."""
    usable = [r for r in records if r.isobaric and all(r.run.has(c) for c in _CHANNELS)]
    if not usable:
        return (
            "no record has current, voltage and a measured temperature of the wire and of the room over time."
        )
    if actuator is None:
        return "the mass of the wire is not known; name an actuator file with --actuator."
    wire = actuator.file.wire
    section_mm2 = np.pi / 4 * wire.diameter.value**2
    volume_m3 = section_mm2 * wire.active_length.value * 1e-9
    balances = [_balance(r.run, r.level, law, volume_m3, wire.active_length.value) for r in usable]
    fit = linear_fit(balances)
    if fit is None:
        return "the records do not separate it from heat loss and heat capacity."
    mass_kg = wire.density.value * volume_m3
    value, half = float(-fit.x[2] / mass_kg), float(fit.half[2] / mass_kg)
    if value - half <= 0:
        return f"its interval, {value - half:.3g} to {value + half:.3g} J/kg, contains 0."
    return Estimate(value, (value - half, value + half), "J/kg", "balance of electrical power", fit.n)


def _balance(
    run: Run, stress_MPa: float, law: MaterialLaw, volume_m3: float, length_mm: float
) -> tuple[Array, Array]:
    """The terms of hA, C and ρVL (k, 3), and the heat that is known (k,), over parts of a record."""
    known = np.all([np.isfinite(run[c]) for c in _CHANNELS], axis=0)
    t, i, v, T, ambient, y = (run[c][known] for c in _CHANNELS)
    xi = _fraction(law, T, stress_MPa)
    scale = {"mm": -1.0 / length_mm, "%": 0.01}.get(run.unit, 1.0)
    ends = np.unique(np.linspace(0, t.size - 1, _PARTS + 1).round().astype(int))
    heat = np.diff(_integral(t, v * i)[ends]) + _PA * volume_m3 * stress_MPa * np.diff((scale * y)[ends])
    loss = np.diff(_integral(t, T - ambient)[ends])
    return np.column_stack([loss, np.diff(T[ends]), np.diff(xi[ends])]), heat


def _integral(t: Array, x: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(0.5 * (x[1:] + x[:-1]) * np.diff(t))])


def _fraction(law: MaterialLaw, T: Array, stress_MPa: float) -> Array:
    """ξ (n,) along temperatures under constant stress: the outer branch that the direction of each part is on."""
    turns, stress = turning_points(T, _REVERSAL * float(np.ptp(T))), np.array([stress_MPa])
    cooled, heated = cooled_fraction(law, T, stress), heated_fraction(law, T, stress)
    xi = np.empty_like(T)
    for a, b in zip(turns[:-1], turns[1:]):
        xi[a : b + 1] = (heated if T[b] > T[a] else cooled)[a : b + 1]
    return xi
