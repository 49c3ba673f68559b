"""One session with a wire: holds on a time grid that is fine after each change of current.

A first pass determines the duration of each hold. Further passes (without noise, without effects) repeat its
grid.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.boxes.box_plant import BoxPlant
from benchmarks.boxes.hold_plan import PlannedHold
from benchmarks.boxes.output_effects import PlantRecord
from benchmarks.boxes.relays import Array
from benchmarks.boxes.wire import BoxWire

PERIOD_S = 0.1
_GROWTH, _COARSEST = 1.12, 20  # ticks
WINDOW, _WINDOW_TICKS = 25, 10  # samples of a second
_STEADY_K, _TIMEOUT_S = 0.01, 600.0


@dataclass(frozen=True, eq=False)
class Grid:
    """Times (n,) as ticks from the start, their holds, and whether they are in a window; ``timed_out`` per
    hold."""

    tick: NDArray[np.intp]
    hold: NDArray[np.intp]
    window: NDArray[np.bool_]
    timed_out: tuple[bool, ...]

    @property
    def t_s(self) -> Array:
        """Times."""
        return np.asarray(self.tick * PERIOD_S, dtype=float)

    @property
    def dt_s(self) -> Array:
        """Time since the previous point."""
        return np.diff(self.tick, prepend=0) * PERIOD_S

    def settled(self, y: Array) -> Array:
        """Means over the windows, one per hold."""
        hold = self.hold[self.window]
        return np.bincount(hold, y[self.window]) / np.bincount(hold)


@dataclass(frozen=True)
class AmbientFluctuation:
    """Temperature noise of the wire: standard deviation and correlation time (Ornstein–Uhlenbeck)."""

    sd_K: float
    time_s: float

    def source(self, rng: np.random.Generator) -> Callable[[float], float]:
        """A function of the time since its last call."""
        state, normals = 0.0, iter(())

        def next_fluctuation_K(dt_s: float) -> float:
            nonlocal state, normals
            normal = next(normals, None)
            if normal is None:
                normals = iter(rng.standard_normal(4096).tolist())
                normal = next(normals)
            decay = math.exp(-dt_s / self.time_s)
            state = decay * state + self.sd_K * math.sqrt(1 - decay * decay) * normal
            return state

        return next_fluctuation_K if self.sd_K else _no_fluctuation


def _no_fluctuation(dt_s: float) -> float:  # noqa: ARG001
    return 0.0


class _StepLog:
    """The states of a plant, step by step."""

    def __init__(self) -> None:
        self.rows: list[tuple[float, ...]] = []

    def add(self, plant: BoxPlant) -> None:
        """Append the state at the end of a step."""
        now = plant.now
        self.rows.append(
            (
                now.share,
                plant.input_K,
                plant.hysteresis_input_K,
                now.travel,
                plant.current_A,
                plant.resistance,
                plant.ambient_shift_K,
            )
        )

    def trajectory(self, grid: Grid) -> PlantRecord:
        """All states as columns."""
        return PlantRecord(grid.t_s, grid.hold, *np.array(self.rows).T)


def simulate_on_new_grid(
    plant: BoxPlant, wire: BoxWire, holds: Sequence[PlannedHold], next_fluctuation_K: Callable[[float], float]
) -> tuple[Grid, PlantRecord]:
    """Execute the holds, each until the wire is within 0.01 K of steady (or for 600 s), and its window."""
    log, ticks, numbers, windows, timed_out = _StepLog(), [], [], [], []
    tick = 0
    for k, hold in enumerate(holds):
        command_A = wire.command(hold.target_K)
        begin, step, steady = tick, 1.0, False
        while not steady and (tick - begin) * PERIOD_S < _TIMEOUT_S:
            tick += int(step)
            _advance(plant, log, command_A, int(step), next_fluctuation_K)
            ticks.append(tick)
            step = min(step * _GROWTH, _COARSEST)
            steady = plant.distance_to_steady_K < _STEADY_K
        waits = [_COARSEST] * round(hold.extra_s / PERIOD_S / _COARSEST)
        for more in (*waits, *[_WINDOW_TICKS] * WINDOW):
            tick += more
            _advance(plant, log, command_A, more, next_fluctuation_K)
            ticks.append(tick)
        timed_out.append(not steady)
        windows += [False] * (len(ticks) - len(windows) - WINDOW) + [True] * WINDOW
        numbers += [k] * (len(ticks) - len(numbers))
    grid = Grid(np.array(ticks), np.array(numbers), np.array(windows), tuple(timed_out))
    return grid, log.trajectory(grid)


def simulate_on_grid(plant: BoxPlant, wire: BoxWire, holds: Sequence[PlannedHold], grid: Grid) -> PlantRecord:
    """Repeat the same times and currents without ambient fluctuation."""
    log = _StepLog()
    commands = [wire.command(hold.target_K) for hold in holds]
    for k, dt_s in zip(grid.hold.tolist(), grid.dt_s.tolist()):
        plant.step(commands[k], dt_s, 0.0)
        log.add(plant)
    return log.trajectory(grid)


def _advance(
    plant: BoxPlant, log: _StepLog, command_A: float, ticks: int, next_fluctuation_K: Callable[[float], float]
) -> None:
    dt_s = ticks * PERIOD_S
    plant.step(command_A, dt_s, next_fluctuation_K(dt_s))
    log.add(plant)


def nominal_input(wire: BoxWire, holds: Sequence[PlannedHold], grid: Grid) -> Array:
    """The temperature of the heating model along the commands with the lab's constants, in closed form."""
    starts = np.flatnonzero(np.diff(grid.hold, prepend=-1))
    stops = np.append(starts[1:], grid.hold.size)
    input_K, first, second, before = np.empty(grid.hold.size), 0.0, 0.0, 0.0
    for a, b, hold in zip(starts.tolist(), stops.tolist(), holds):
        decay = np.exp(-(grid.t_s[a:b] - before) / wire.tau_s)
        to_first, to_second = max(hold.target_K, 0.0), max(-hold.target_K, 0.0)
        one, two = to_first + (first - to_first) * decay, to_second + (second - to_second) * decay
        input_K[a:b] = one - two
        first, second, before = float(one[-1]), float(two[-1]), float(grid.t_s[b - 1])
    return input_K
