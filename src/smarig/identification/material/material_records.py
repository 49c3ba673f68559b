"""Isobaric and isothermal records of runs: temperature, stress and strain at each reading, and the branches."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from smarig.config import ActuatorFile
from smarig.core import Array, DataError, UsageError
from smarig.identification.material.material_path import MaterialBranch
from smarig.measurement import dropouts, input_noise_sd, noise_range
from smarig.preisach import turning_points
from smarig.record import OWN_ZERO, Run, counted
from smarig.replay import recorded_conditions, stress_at_points, temperature_source, with_wire_temperature

Rows = NDArray[np.signedinteger[Any]]

PER_UNIT = {"1": 1.0, "mm/mm": 1.0, "m/m": 1.0, "%": 0.01, "ppm": 1e-6}  # of strain
HELD_TEMPERATURES = ("temperature", "chamber_temperature", "room_temperature")
ZERO_DEGC_K = 273.15
LARGEST_STRESS_MPA, LARGEST_STRAIN = 5000.0, 0.5  # no wire gives more: the unit is another one
FEWEST_READINGS = 20
MOST_READINGS = 400  # of a branch: blocks of consecutive readings are averaged
REVERSAL = 0.1  # of the range of the input: a smaller reversal does not end a branch
LOOP = 0.02  # of the range of the strain: a record whose directions differ by less shows no transformation


@dataclass(frozen=True, eq=False)
class MaterialRecord:
    """Readings (n,) in measured order, in °C, MPa and 1, with their branches.

    ``isobaric``: the temperature changes under constant stress; otherwise the stress changes at constant temperature.
    ``own_zero``: strain counts from a zero of this record. ``run`` is the run it comes from.
    """

    name: str
    run: Run
    isobaric: bool
    temperature_degC: Array
    stress_MPa: Array
    strain: Array
    branches: tuple[MaterialBranch, ...]
    own_zero: bool

    @property
    def level(self) -> float:
        """The stress of an isobaric record in MPa, the temperature of an isothermal one in °C."""
        return float(np.mean(self.stress_MPa if self.isobaric else self.temperature_degC))

    @property
    def condition(self) -> str:
        """What was held, in words."""
        return f"{self.level:.4g} {'MPa' if self.isobaric else '°C'}"

    @property
    def changing(self) -> Array:
        """The readings of what changes (n,): temperature or stress."""
        return self.temperature_degC if self.isobaric else self.stress_MPa

    @property
    def acting_MPa(self) -> Array:
        """The stress (n,), or (1,) if it is constant."""
        return self.stress_MPa[:1] if self.isobaric else self.stress_MPa


def material_records(runs: Sequence[Run]) -> list[MaterialRecord]:
    """The records of runs, by kind and level. Raises UsageError or DataError, in one sentence, for others."""
    if not runs:
        raise UsageError("Give at least one run to identify the material from.")
    found = [_record(run) for run in runs]
    return sorted(found, key=lambda r: (not r.isobaric, r.level))


def _record(run: Run) -> MaterialRecord:
    isobaric = run.input_unit in ("degC", "K") and stress_at_points(run) is None
    u, stress, strain, own_zero = (_isobaric if isobaric else _isothermal)(run)
    if u.size < FEWEST_READINGS:
        raise DataError(
            f"{run.name} has {u.size} readings with temperature, stress and strain. A record of the material needs at "
            f"least {FEWEST_READINGS}."
        )
    _check_sizes(run, stress, strain)
    changing = u if isobaric else stress
    if np.ptp(changing) == 0:
        what = "temperature" if isobaric else "stress"
        raise DataError(f"The {what} of {run.name} does not change, so nothing transforms. Leave it out.")
    rows, branches = _branches(changing, rising_cools=not isobaric)
    temperature, stress, strain = (_blocks(x, rows) for x in (u, stress, strain))
    record = MaterialRecord(run.name, run, isobaric, temperature, stress, strain, branches, own_zero)
    _check_loop(record)
    return record


def _isobaric(run: Run) -> tuple[Array, Array, Array, bool]:
    """Temperature, stress, strain of a run whose hysteresis input is a temperature."""
    stress_MPa = _held(run, ("stress",), "MPa")
    if stress_MPa is None:
        raise UsageError(
            f"{run.name} does not state its stress in MPa, which the material needs. State it in the mapping file "
            'under [conditions]: stress = { value = 100, unit = "MPa" }, or name its column.'
        )
    if "heating model" in (run.info.input.from_ or ""):
        run = with_wire_temperature(run, temperature_source([run]))
    temperature, strain, own_zero = _readings(run, _to_degC(run))
    return temperature, np.full(temperature.size, stress_MPa), strain, own_zero


def _isothermal(run: Run) -> tuple[Array, Array, Array, bool]:
    """Temperature, stress, strain of a run whose hysteresis input is a stress, or whose load changes."""
    by_load = stress_at_points(run)
    if by_load is not None:
        if "heating model" in (run.info.input.from_ or ""):
            run = with_wire_temperature(run, temperature_source([run]))
        temperature, strain = run.points()[0] + _to_degC(run), _strain(run, run.points()[1])
        known = np.isfinite(temperature) & np.isfinite(by_load) & np.isfinite(strain)
        held = np.full(int(known.sum()), float(np.mean(temperature[known])))
        return held, by_load[known], strain[known], _has_own_zero(run)
    if run.input_unit != "MPa":
        raise UsageError(
            f"The hysteresis input of {run.name} is {run.info.input.quantity or 'not named'} "
            f"({run.input_unit or 'no unit'}). The material needs records over a temperature in °C or K, or over a "
            "stress in MPa: change [input] in the mapping file."
        )
    held_degC = _held(run, HELD_TEMPERATURES, "degC")
    if held_degC is None and run.has("temperature_degC"):
        held_degC = float(np.nanmean(run["temperature_degC"]))
    if held_degC is None:
        raise UsageError(
            f"{run.name} does not state the temperature at which it was made. State it in the mapping file under "
            '[conditions]: temperature = { value = 80, unit = "degC" }.'
        )
    stress, strain, own_zero = _readings(run, 0.0)
    return np.full(stress.size, held_degC), stress, strain, own_zero


def _readings(run: Run, shift: float) -> tuple[Array, Array, bool]:
    """Input plus a shift, strain, and whether the strain has its own zero; rows that miss one are left out."""
    run = counted(run)
    u, y = run.points() if run.settled else (run["input"], run["position"])
    known = np.isfinite(u) & np.isfinite(y)
    u, y = u[known], y[known]
    kept = ~dropouts(u) if u.size else np.ones(0, dtype=bool)
    return u[kept] + shift, _strain(run, y[kept]), _has_own_zero(run)


def _strain(run: Run, position: Array) -> Array:
    """ε of a strain in its unit, or −y/L of a contraction in mm along a wire of known length L."""
    if run.unit in PER_UNIT:
        return position * PER_UNIT[run.unit]
    if run.unit == "mm":
        try:
            return -position / ActuatorFile.model_validate(run.info.actuator_values).wire.active_length.value
        except ValidationError:
            pass
    raise UsageError(
        f"The output of {run.name} is in {run.unit or 'no unit'}, and the material needs a strain. Give it in 1 or %, "
        "or in mm in a run whose actuator file states the length of the wire."
    )


def _has_own_zero(run: Run) -> bool:
    return run.unit == "mm" or run.info.encoder_zero == OWN_ZERO


def _to_degC(run: Run) -> float:
    """What is added to the input to give °C."""
    if run.input_unit == "degC":
        return 0.0
    if "above ambient" in (run.info.input.quantity or ""):
        if not run.has("ambient_degC"):
            raise UsageError(
                f"The temperature of {run.name} counts from an ambient temperature that it does not state. Add it to "
                "the mapping file as ambient_degC."
            )
        return float(np.nanmean(run["ambient_degC"]))
    return -ZERO_DEGC_K


def _held(run: Run, names: Sequence[str], unit: str) -> float | None:
    """The value of the first of these conditions that the run states in this unit."""
    conditions = recorded_conditions(run)
    for name in names:
        found = conditions.get(name)
        if found is not None and found.unit == unit and isinstance(found.value, float):
            return found.value
    return None


def _check_sizes(run: Run, stress: Array, strain: Array) -> None:
    if np.ptp(strain) > LARGEST_STRAIN:
        raise UsageError(
            f"The strain of {run.name} changes by {100 * np.ptp(strain):.3g} %, which no wire does. Check its unit in "
            f"the mapping file, where it is {run.unit}."
        )
    if np.abs(stress).max() > LARGEST_STRESS_MPA:
        raise UsageError(
            f"The stress of {run.name} reaches {np.abs(stress).max():.3g} MPa, which no wire bears. Check its unit in "
            "the mapping file."
        )


def _branches(u: Array, *, rising_cools: bool) -> tuple[list[Rows], tuple[MaterialBranch, ...]]:
    """Blocks of rows, one for each reading that is kept, and the branches of those readings."""
    threshold = max(
        REVERSAL * float(np.ptp(u)), 1.2 * noise_range(u, input_noise_sd(u)) if u.size > 2 else 0.0
    )
    turns = turning_points(u, min(threshold, 0.4 * float(np.ptp(u))))
    blocks: list[Rows] = []
    branches: list[MaterialBranch] = []
    for k, (a, b) in enumerate(pairwise(turns)):
        rows = np.arange(a + (k > 0), b + 1)
        if not rows.size:
            continue
        parts = np.array_split(rows, min(rows.size, MOST_READINGS))
        first = len(blocks)
        blocks += parts
        branches.append(MaterialBranch(first, len(blocks), (u[b] > u[a]) == rising_cools))
    return blocks, tuple(branches)


def _blocks(x: Array, rows: Sequence[Rows]) -> Array:
    return np.array([float(np.mean(x[r])) for r in rows])


def _check_loop(record: MaterialRecord) -> None:
    """Raise DataError for a record without both directions, or whose directions agree."""
    if {b.cooling for b in record.branches} != {True, False}:
        one, other = ("heating", "cooling") if record.isobaric else ("unloading", "loading")
        missing = one if record.branches[0].cooling else other
        raise DataError(
            f"{record.name} has no loop: {missing} is missing. The material needs both directions in each record."
        )
    if _gap(record) < LOOP * float(np.ptp(record.strain)):
        raise DataError(
            f"{record.name} shows no loop: both directions have the same strain, so it contains no transformation. "
            "Leave it out, or extend its range."
        )


def _gap(record: MaterialRecord) -> float:
    """The largest difference in strain between the longest branches of both directions."""
    longest = [
        max(
            (b for b in record.branches if b.cooling == cooling),
            key=lambda b: float(np.ptp(record.changing[b.first : b.stop])),
        )
        for cooling in (True, False)
    ]
    curves = []
    for b in longest:
        u, y = record.changing[b.first : b.stop], record.strain[b.first : b.stop]
        order = np.argsort(u, kind="stable")
        curves.append((u[order], y[order]))
    low = max(float(u[0]) for u, _ in curves)
    high = min(float(u[-1]) for u, _ in curves)
    if high <= low:
        return 0.0
    at = np.linspace(low, high, 200)
    return float(np.max(np.abs(np.interp(at, *curves[0]) - np.interp(at, *curves[1]))))
