"""Tables over the Preisach plane that are given to a study: no records, but models, which are written as such.

An Everett table has F(α, β), the fall of the output on the first-order curve from α down to β (twice the function of
Mayergoyz). A table of weights has the mass of the relays (α, β), of a density its mass per area; a cell of the plane
reaches half-way to the next levels, and its mass lies in it evenly.
"""

import re
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from smarig.core import Array, DataError, UsageError
from smarig.exchange import PlaneTable, known_unit, plane_table
from smarig.preisach import FodTable
from smarig.replay import ActuatorRecord, Model, NoiseRecord, SignalDescription
from smarig.study.quantity_words import name_and_unit
from smarig.study.study_files import STUDY_MODEL

EVERETT, WEIGHTS, DENSITY = "an Everett table", "a table of Preisach weights", "a Preisach density"
_WORDS = (
    (EVERETT, re.compile(r"everett", re.IGNORECASE)),
    (DENSITY, re.compile(r"densit|dichte|\bmu\b|μ", re.IGNORECASE)),
    (WEIGHTS, re.compile(r"weight|gewicht|mass|\bw\b", re.IGNORECASE)),
)
_SAME = 1e-9  # of the largest value: rounding


def refuse_plane_tables(files: Sequence[Path], folder: Path, name: str, units: Mapping[str, str]) -> None:
    """Raise UsageError for a file that is a table over the Preisach plane. ``folder`` takes its model.

    ``units``: those of "input" and "output" that the user gave; else the names of the columns may say them.
    """
    for file in files:
        table = plane_table(file)
        if table is None:
            continue
        what, size = kind_of(table), table.levels.size
        known = f"{file} is {what} over {size} levels of α and β, and no record of an input and an output"
        try:
            hysteresis = fod_table_of(table)
        except DataError as error:
            raise UsageError(f"{known}; it makes no model: {error}") from None
        found = {"input": _unit_in(table.level_name), "output": _unit_in(table.words), **units}
        path = _model(hysteresis, name, found).save(folder / STUDY_MODEL, force=True)
        unsaid = "".join(f" --unit {key}=UNIT" for key in ("input", "output") if not found[key])
        more = f" The file does not say its units; give them with{unsaid}." if unsaid else ""
        raise UsageError(f"{known}. It was written as the model {path}, which `smarig simulate` runs.{more}")


def _unit_in(name: str) -> str:
    """The known unit that a name ends with or has in brackets, "" for none."""
    return known_unit(name_and_unit(name)[1], temperature=True)


def kind_of(table: PlaneTable) -> str:
    """What the values are: as the file says, else an Everett table if they are 0 at α = β and grow with α − β."""
    stated = next((kind for kind, words in _WORDS if words.search(table.words)), "")
    if stated:
        return stated
    values = _triangle(table)
    inside = np.tri(values.shape[0], dtype=bool)
    filled = np.where(inside, values, np.nan)
    least = -_SAME * float(np.nanmax(np.abs(filled), initial=0.0))
    rising, falling = np.diff(filled, axis=0), -np.diff(filled, axis=1)
    grows = all((steps[np.isfinite(steps)] >= least).all() for steps in (rising, falling))
    return EVERETT if grows and not np.nan_to_num(np.diag(values)).any() else WEIGHTS


def fod_table_of(table: PlaneTable) -> FodTable:
    """The first-order curves y(α, β) = F(α, u₀) − F(α, β) − F(uₙ, u₀)/2 of a table over the plane.

    Weights w at levels give F = 2 Σ w over the cells that a rise from β to α passes, exact at their edges. Raises
    DataError for values where α < β, for missing ones, and for a table of zeros.
    """
    kind, values, levels = kind_of(table), _triangle(table), table.levels
    outside = np.nan_to_num(values[~np.tri(levels.size, dtype=bool)])
    if outside.any():
        raise DataError("it has values where α < β, where there are no relays.")
    values = np.where(np.eye(levels.size, dtype=bool), np.nan_to_num(values), values)
    missing = np.argwhere(np.isnan(values) & np.tri(levels.size, dtype=bool))
    if missing.size:
        i, j = missing[0]
        raise DataError(f"it has no value at α = {levels[i]:g}, β = {levels[j]:g}.")
    values = np.tril(values)
    if not values.any():
        raise DataError("all of its values are 0.")
    if kind != EVERETT:
        levels = _edges(levels)
        values = _everett(values * (np.outer(np.diff(levels), np.diff(levels)) if kind == DENSITY else 1.0))
    full = values[-1, 0]
    curves = values[:, :1] - values - full / 2
    return FodTable(levels, np.where(np.tri(levels.size, dtype=bool), curves, np.nan))


def _triangle(table: PlaneTable) -> Array:
    """The values with α in rows: of a matrix with β in rows, which has them above its diagonal, the transpose."""
    known = np.nan_to_num(table.values)
    only_above = np.triu(known, 1).any() and not np.tril(known, -1).any()
    return table.values.T if only_above else table.values


def _edges(levels: Array) -> Array:
    """The edges (n + 1,) of the cells about n levels."""
    middle = (levels[1:] + levels[:-1]) / 2
    return np.concatenate([[2 * levels[0] - middle[0]], middle, [2 * levels[-1] - middle[-1]]])


def _everett(mass: Array) -> Array:
    """F (n + 1, n + 1) at the edges of cells with mass (n, n): twice that of the cells below α and above β."""
    size = mass.shape[0] + 1
    found = np.zeros((size, size))
    found[1:, :-1] = 2 * np.cumsum(np.cumsum(mass, axis=0)[:, ::-1], axis=1)[:, ::-1]
    return np.tril(found)


def _model(hysteresis: FodTable, name: str, units: Mapping[str, str]) -> Model:
    output = units["output"] or "1"
    return Model(
        name=name,
        hysteresis=hysteresis,
        rig="None",
        actuator=ActuatorRecord(name="None", parameters={}),
        arrangement="",
        input=SignalDescription(quantity="input", unit=units["input"] or "1"),
        output=SignalDescription(quantity="output", unit=output),
        mirrored=False,
        fit={},
        noise_floor=NoiseRecord(value=None, unit=output, source="none"),
        provenance=(),
        twin=False,
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        warnings=("Read from a table over the Preisach plane: its error is not known.",),
    )
