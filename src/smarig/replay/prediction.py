"""Predictions of a model for the readings of a timeline, with and without effects.

Effects act in the same plant as in the twin. Ticks are fine after each change of the current and coarse later
(``CurrentProfile``); ``numerics`` gives the resulting error. Predictions depend on the drive alone, not on measured
positions.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.plant import Plant, SupportsHooks
from smarig.preisach import Everett, Initial, Preisach, State
from smarig.replay.input_trajectory import CACHE_SIZE
from smarig.replay.plant_model import PlantModel
from smarig.replay.timeline import DriveProfile, Timeline, session_offsets_s
from smarig.replay.trajectory import Trajectory, simulate_timeline

OUTPUT_DEPENDENT_KINDS = (
    "settled",
    "moving",
    "resistance",
)  # kinds of readings that depend on the operator's output


@dataclass(frozen=True, eq=False)
class Prediction:
    """Predictions by kind of reading, (n,) each; ``t_s`` and ``hysteresis_input_K`` (m,) are the time and the input of
    the hysteresis at every tick.

    ``states``, ``output`` and ``tick_index`` (n,) are the operator's memory, its output and the tick at each reading
    that depends on them (settled and moving positions, resistances). Position minus output is the contribution of
    effects after the operator. ``output_slope`` (n,) is the reading's slope to the output: 1, or ∂R/∂y.
    """

    values: dict[str, Array]
    t_s: Array
    hysteresis_input_K: Array
    states: tuple[State, ...]
    output: Array
    tick_index: NDArray[np.int64]
    output_slope: Array
    session_starts: tuple[int, ...] = (0,)

    @property
    def session(self) -> NDArray[np.int64]:
        """The session of each coupled reading (n,)."""
        return np.searchsorted(self.session_starts, self.tick_index, side="right") - 1

    def outputs_at(self, hysteresis: Everett, initial: Initial, ticks: NDArray[np.int64]) -> Array:
        """Outputs (n,) of a hysteresis at ticks (n,); the path between these and its turning points is left out."""
        path = self.hysteresis_input_K
        move = np.diff(path, prepend=path[0], append=path[-1])
        kept = move[:-1] * move[1:] <= 0
        kept[[*self.session_starts]] = kept[ticks] = True
        at = np.flatnonzero(kept)
        own = replace(self, session_starts=tuple(np.searchsorted(at, self.session_starts).tolist()))
        return own.outputs_along(hysteresis, initial, path[at])[np.searchsorted(at, ticks)]

    def outputs_along(self, hysteresis: Everett, initial: Initial, hysteresis_input_K: Array) -> Array:
        """Outputs (m,) of a hysteresis along inputs (m,), from the initial state in every session."""
        operator = Preisach(hysteresis, initial)
        return np.concatenate(
            [
                operator.simulate(part, initial)
                for part in np.split(hysteresis_input_K, self.session_starts[1:])
            ]
        )

    @property
    def positions_only(self) -> "Prediction":
        """The same with position readings only, which come first."""
        values = {kind: self.values[kind] for kind in ("settled", "moving") if kind in self.values}
        n = sum(v.size for v in values.values())
        return replace(
            self,
            values=values,
            states=self.states[:n],
            output=self.output[:n],
            tick_index=self.tick_index[:n],
            output_slope=self.output_slope[:n],
        )

    def of(self, kind: str) -> slice:
        """Rows of the coupled readings of one kind."""
        before = [
            self.values[k].size
            for k in OUTPUT_DEPENDENT_KINDS[: OUTPUT_DEPENDENT_KINDS.index(kind)]
            if k in self.values
        ]
        return slice(sum(before), sum(before) + self.values[kind].size)

    def stacked(self, timeline: Timeline) -> Array:
        """All predictions in the order of the timeline's readings, (N,)."""
        return np.concatenate([self.values[r.kind] for r in timeline.all_readings])


def predict(timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks] = ()) -> Prediction:
    """The prediction of a plant with further effects for the readings of a timeline, session by session."""
    if not timeline.sessions:
        return _predict_session(timeline, plant_model, effects)
    return _join_predictions(
        timeline, [_predict_session(session, plant_model, effects) for session in timeline.sessions]
    )


def _predict_session(
    timeline: Timeline, plant_model: PlantModel, effects: Sequence[SupportsHooks]
) -> Prediction:
    m = plant_model
    return _cached_prediction(
        timeline, m.actuator, m.hysteresis, m.initial, (*m.effects, *effects), m.per_count
    )


@lru_cache(maxsize=CACHE_SIZE)
def _cached_prediction(timeline: Timeline, *plant: Any) -> Prediction:
    plant_model = PlantModel(*plant)
    trajectory = simulate_timeline(timeline, plant_model, plant_model.effects)
    t, _, read = timeline.ticks
    rows = {r.kind: np.searchsorted(t[read], np.round(r.t_s, 6)) for r in timeline.all_readings}
    coupled = np.concatenate([rows[k] for k in OUTPUT_DEPENDENT_KINDS if k in rows])
    own = {"current": trajectory["current_A"] - trajectory["command_A"], "room": trajectory["ambient_K"]}
    if "resistance" in rows:
        own["resistance"] = _resistance_ohm(
            trajectory, plant_model, by_command=timeline.resistance_from_command
        )
    position = trajectory["counts"] * (plant_model.per_count or 1.0)
    return Prediction(
        values={kind: own.get(kind, position)[k] for kind, k in rows.items()},
        t_s=t,
        hysteresis_input_K=trajectory.hysteresis_input_K,
        states=tuple(trajectory.states[k] for k in coupled),
        output=trajectory["output"][coupled],
        tick_index=np.flatnonzero(read)[coupled],
        output_slope=np.concatenate(
            [
                _output_slope(k, trajectory["command_A"][rows[k]], plant_model)
                for k in OUTPUT_DEPENDENT_KINDS
                if k in rows
            ]
        ),
    )


def _resistance_ohm(trajectory: Trajectory, plant_model: PlantModel, *, by_command: bool) -> Array:
    """Resistance (n,) of the wire that carries the current; over the commanded current if none was measured."""
    wire, command = plant_model.actuator, trajectory["command_A"]
    ohms = np.array([wire.resistance_at_ohm(a) for a in trajectory["austenite"].tolist()])
    ohms *= trajectory["resistance"]
    some = command != 0
    if by_command:
        ohms[some] *= trajectory["current_A"][some] / command[some]
    return ohms


def _output_slope(kind: str, command_A: Array, plant_model: PlantModel) -> Array:
    """∂(reading)/∂(output), (n,): the resistance of a single wire depends on the output's share of the stroke.

    Those of two wires depend on the phases of their own temperatures, so the present output tells nothing of them.
    """
    if kind != "resistance":
        return np.ones(command_A.size)
    wire = plant_model.actuator
    if wire.two_wire:
        return np.zeros(command_A.size)
    per_stroke = wire.resistance_at_ohm(1.0) - wire.resistance_at_ohm(0.0)
    return np.full(command_A.size, per_stroke / plant_model.stroke)


def predict_positions(drive: DriveProfile, plant_model: PlantModel, at_s: Array) -> Array:
    """Positions (n,) along a drive at times (n,), increasing."""
    plant = Plant(plant_model.actuator, plant_model.hysteresis, plant_model.initial, 0.1, plant_model.effects)
    t, current = drive.ticks(at_s)
    sensed_positions, per_count, before = np.empty(t.size), plant_model.per_count or 1.0, 0.0
    for k, (now, i) in enumerate(zip(t.tolist(), current.tolist())):
        plant.advance(i, now - before)
        before = now
        sensed_positions[k] = plant.sensed(plant.position / per_count) * per_count
    return np.interp(at_s, t, sensed_positions)


def _join_predictions(timeline: Timeline, parts: Sequence[Prediction]) -> Prediction:
    """The predictions of all sessions as one, in the order of the joined timeline's readings."""
    ticks = np.cumsum([0, *[part.t_s.size for part in parts]])
    coupled = [
        (k, part.of(kind))
        for kind in OUTPUT_DEPENDENT_KINDS
        for k, part in enumerate(parts)
        if kind in part.values
    ]

    def together(column: Callable[[Prediction], Array]) -> Array:
        return np.concatenate([column(parts[k])[rows] for k, rows in coupled])

    return Prediction(
        values={
            r.kind: np.concatenate([p.values[r.kind] for p in parts if r.kind in p.values])
            for r in timeline.all_readings
        },
        t_s=np.concatenate(
            [part.t_s + begin for part, begin in zip(parts, session_offsets_s(timeline.sessions))]
        ),
        hysteresis_input_K=np.concatenate([part.hysteresis_input_K for part in parts]),
        states=tuple(state for k, rows in coupled for state in parts[k].states[rows]),
        output=together(lambda part: part.output),
        tick_index=np.concatenate([parts[k].tick_index[rows] + ticks[k] for k, rows in coupled]),
        output_slope=together(lambda part: part.output_slope),
        session_starts=tuple(ticks[:-1].tolist()),
    )


def with_hysteresis(prediction: Prediction, plant_model: PlantModel, centre: Everett) -> Prediction:
    """The prediction with the same inputs and the outputs of another hysteresis along them."""
    if centre is plant_model.hysteresis:
        return prediction
    output = prediction.outputs_at(centre, plant_model.initial, prediction.tick_index)
    change, values, at = prediction.output_slope * (output - prediction.output), dict(prediction.values), 0
    for kind in OUTPUT_DEPENDENT_KINDS:
        if kind in values:
            n = values[kind].size
            values[kind] = values[kind] + change[at : at + n]
            at += n
    return replace(prediction, values=values, output=output)


def numerics(timeline: Timeline, plant_model: PlantModel) -> float:
    """Largest difference of settled positions between these ticks and ticks a quarter as long, in output units."""
    if timeline.sessions:
        return max(numerics(session, plant_model) for session in timeline.sessions)
    coarse = predict(timeline, plant_model).values["settled"]
    t, current = timeline.drive.ticks(np.round(timeline.settled.t_s, 6))
    plant = Plant(plant_model.actuator, plant_model.hysteresis, plant_model.initial, 0.1, plant_model.effects)
    sensed_positions, before = {}, 0.0
    for now, i in zip(t.tolist(), current.tolist()):
        for _ in range(4):
            plant.advance(i, (now - before) / 4)
        before = now
        sensed_positions[now] = plant.position
    fine = np.array([sensed_positions[v] for v in np.round(timeline.settled.t_s, 6).tolist()])
    return float(np.abs(coarse - fine).max())
