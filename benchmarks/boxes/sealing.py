"""A box as files: the actuator's constants, training runs and held-out runs. The label goes to the caller.

The files contain neither the hidden effects nor the seed that gives them.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.boxes.box_effects import Hidden
from benchmarks.boxes.box_plant import BoxPlant
from benchmarks.boxes.box_session import (
    PERIOD_S,
    WINDOW,
    Grid,
    nominal_input,
    simulate_on_grid,
    simulate_on_new_grid,
)
from benchmarks.boxes.label import Label, RunTruth
from benchmarks.boxes.output_effects import OUTPUT_EFFECTS, PlantRecord, position, sensor_output
from benchmarks.boxes.random_box import Box
from benchmarks.boxes.relays import Array
from benchmarks.boxes.unlisted_effects import UNLISTED_OUTPUT, unlisted_output
from benchmarks.boxes.wire import actuator_toml
from smarig.core import StorageError
from smarig.record import schema, write_run

_AMBIENT_DEGC = 22.0
_NOISE_A, _NOISE_V, _NOISE_DEGC = 0.0002, 0.002, 0.02


@dataclass(frozen=True)
class SealedBox:
    """A box on disk, and its label, which is not on disk."""

    label: Label
    actuator: Path
    train: tuple[Path, ...]
    held_out: tuple[Path, ...]

    @property
    def commitment(self) -> str:
        """SHA-256 of the label."""
        return self.label.commitment


@dataclass(frozen=True, eq=False)
class SessionData:
    """An executed session: its grid, the recorded columns (n,), and the clean outputs of all holds."""

    grid: Grid
    columns: dict[str, Array]
    settled: Array
    with_effects: Array
    without: Array


def write_box(box: Box, folder: Path) -> SealedBox:
    """Make the runs of a box and write them, with its actuator file, into a folder."""
    session = simulate_session(box)
    actuator = folder / "actuator.toml"
    try:
        for part in ("train", "held_out"):
            (folder / part).mkdir(parents=True, exist_ok=True)
        actuator.write_text(actuator_toml(box.wire, "box_wire"), encoding="utf-8")
    except OSError as error:
        raise StorageError(f"A box cannot be written to {folder}: {error.strerror or error}.") from None
    paths = [_run_path(folder, k, run.name, run.held_out) for k, run in enumerate(box.plan, start=1)]
    for k, (path, holds) in enumerate(zip(paths, _holds_of(box))):
        columns, steps = _rows(box, session, holds)
        write_run(path, _meta(box, k, actuator), columns, steps, force=True)
    held_out = {path for path, run in zip(paths, box.plan) if run.held_out}
    train = tuple(path for path in paths if path not in held_out)
    return SealedBox(_label(box, session), actuator, train, tuple(path for path in paths if path in held_out))


def simulate_session(box: Box) -> SessionData:
    """Execute all holds: with noise as recorded, and without ambient fluctuation with and without the
    effects."""
    rng = np.random.default_rng([box.seed, box.number, 1])
    wire, holds = box.wire, [hold for run in box.plan for hold in run.holds]
    plant = BoxPlant(wire, box.hysteresis, box.hidden)
    grid, recorded = simulate_on_new_grid(plant, wire, holds, box.noise.ambient_fluctuation.source(rng))
    without_fluctuation = box.noise.ambient_fluctuation.sd_K == 0
    noise_free = (
        recorded
        if without_fluctuation
        else simulate_on_grid(BoxPlant(wire, box.hysteresis, box.hidden), wire, holds, grid)
    )
    acts_back = set(box.hidden) - OUTPUT_EFFECTS - UNLISTED_OUTPUT
    without_effects = (
        simulate_on_grid(BoxPlant(wire, box.hysteresis, {}), wire, holds, grid) if acts_back else noise_free
    )
    columns = _columns(box, grid, recorded, rng)
    columns["input"] = nominal_input(wire, holds, grid)
    columns["current_command_A"] = np.array([wire.command(hold.target_K) for hold in holds])[grid.hold]
    clean, plain = (
        _clean_outputs(box, grid, noise_free, box.hidden),
        _clean_outputs(box, grid, without_effects, {}),
    )
    return SessionData(grid, columns, grid.settled(columns["position"]), clean, plain)


def _position(box: Box, record: PlantRecord, hidden: Hidden) -> Array:
    """The position at the sensor."""
    y = position(record, box.wire, box.hysteresis, hidden)
    y = unlisted_output(y, record, box.hysteresis.stroke, hidden)
    return sensor_output(y, record.t_s, hidden)


def _clean_outputs(box: Box, grid: Grid, record: PlantRecord, hidden: Hidden) -> Array:
    """Settled outputs without noise and quantisation, relative to the initial position of the pulley."""
    y = _position(box, record, hidden)
    return grid.settled(y - y[0])


def _columns(box: Box, grid: Grid, record: PlantRecord, rng: np.random.Generator) -> dict[str, Array]:
    """Every channel at every time, including the noise of instruments."""
    n, wire, noise = grid.tick.size, box.wire, box.noise
    y = _position(box, record, box.hidden) / wire.per_count
    counts = np.floor(y + noise.encoder_counts * rng.standard_normal(n) + noise.phase)
    counts -= np.floor(y[0] + noise.phase)
    current_A = record.current_A
    return {
        "counts": counts,
        "position": counts * wire.per_count,
        "current_A": current_A + _NOISE_A * rng.standard_normal(n),
        "voltage_V": current_A * wire.resistance_ohm * record.resistance + _NOISE_V * rng.standard_normal(n),
        "ambient_degC": _AMBIENT_DEGC + record.ambient_shift_K + _NOISE_DEGC * rng.standard_normal(n),
    }


def _holds_of(box: Box) -> Iterable[range]:
    """Numbers of the holds of each run."""
    first = 0
    for run in box.plan:
        yield range(first, first + len(run.holds))
        first += len(run.holds)


def _rows(box: Box, session: SessionData, holds: range) -> tuple[dict[str, Any], list[tuple]]:
    """Samples and steps of one run."""
    grid = session.grid
    own = np.flatnonzero((grid.hold >= holds.start) & (grid.hold < holds.stop))
    edges = np.flatnonzero(np.diff(grid.hold, append=-1))  # the last time of each hold
    if "transients" not in box.channels:  # the first time of the run, and the end of each hold
        own = np.unique(np.concatenate([own[:1], edges[holds.start : holds.stop]]))
    measured = {"current": "current_A", "voltage": "voltage_V", "ambient": "ambient_degC"}
    absent = {column for channel, column in measured.items() if channel not in box.channels}
    columns: dict[str, Any] = {k: v[own] for k, v in session.columns.items() if k not in absent}
    columns |= {"tick": grid.tick[own], "t_s": grid.t_s[own], "step": grid.hold[own] - holds.start}
    columns["counts"] = columns["counts"].astype(int)
    unknown = set(columns) - set(schema.SAMPLE_COLUMNS)
    if unknown:
        raise StorageError(f"A run has no column for {sorted(unknown)[0]}.")
    ends_s = np.concatenate([[0.0], grid.t_s[edges]])
    plans = [hold for run in box.plan for hold in run.holds]
    steps = [
        (
            k - holds.start,
            0,
            0,
            plans[k].branch,
            plans[k].target_K,
            float(ends_s[k]),
            float(ends_s[k + 1]),
            "timed_out" if grid.timed_out[k] else "settled",
            float(session.settled[k]),
            WINDOW,
        )
        for k in holds
    ]
    return columns, steps


def _run_path(folder: Path, number: int, name: str, held_out: bool) -> Path:
    return folder / ("held_out" if held_out else "train") / f"{number:02d}_{name}.run.sqlite"


def _meta(box: Box, run: int, actuator: Path) -> dict[str, Any]:
    """The metadata that a session writes: all runs have one session, one encoder zero and one clock."""
    wire = box.wire
    protocol = {"fod": "first_order_descending", "repeat": "first_order_descending"}
    name = box.plan[run].name
    first = "anhysteretic" if wire.two_wire else "negative"
    one_wire_input = "wire temperature above ambient"
    return {
        "protocol": protocol.get(name, "first_order_descending" if name == "curves" else name),
        "settings": {},
        "rig": "box",
        "wire": f"box-{box.number}",
        "actuator": str(actuator),
        "source": "twin",
        "start_epoch": 1.8e9 + 1e5 * box.number,
        "period_s": PERIOD_S,
        "input": {
            "quantity": "wire temperature difference T₁ − T₂" if wire.two_wire else one_wire_input,
            "unit": "K",
            "from": "heating model along the commanded current",
        },
        "output": {
            "quantity": "shaft angle" if wire.two_wire else "displacement",
            "unit": wire.unit,
            "per_count": wire.per_count,
        },
        "initial": "continued" if run else first,
        "encoder_zero": "power-up",
        "notes": "",
    }


def _label(box: Box, session: SessionData) -> Label:
    error = (session.settled - session.with_effects) / box.wire.per_count
    plans = [hold for run in box.plan for hold in run.holds]

    def truth(name: str, held_out: bool, holds: range) -> RunTruth:
        own = slice(holds.start, holds.stop)
        return RunTruth(
            name,
            held_out,
            tuple(hold.target_K for hold in plans[own]),
            tuple(session.with_effects[own].tolist()),
            tuple(session.without[own].tolist()),
        )

    return Label(
        seed=box.seed,
        number=box.number,
        category=box.category,
        effects=box.hidden,
        left_out=box.left_out,
        arrangement=box.wire.arrangement,
        channels=box.channels,
        noise_counts=float(np.std(error)),
        per_count=box.wire.per_count,
        draught_K=box.noise.ambient_fluctuation.sd_K,
        runs=tuple(truth(r.name, r.held_out, holds) for r, holds in zip(box.plan, _holds_of(box))),
    )
