"""How a subject lives through a story: what there was to read at each time of a reading.

By parts of ticks where what is felt is known beforehand (``felt``), else tick by tick with the whole plant; either
gives the same numbers. Knows no kinds of readings.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.model.effect import Effect, Hook, Moment, Planted, Setup, Stage, chains
from smarig.model.plant import Plant
from smarig.model.warming import through
from smarig.preisach.operator import Preisach, State
from smarig.story.felt import Felt, felt
from smarig.story.subject import Subject
from smarig.story.told import Story

Array = NDArray[np.float64]
ROWS = ("counts", "output", "resistance", "command_A", "current_A", "ambient_K")
LATE = (Stage.OUTPUT, Stage.ADDITIVE, Stage.SENSOR)


@dataclass(frozen=True, eq=False)
class Life:
    """At each time of a reading (n,): columns as in ``ROWS`` (6, n) and the memory; ``felt_K`` (ticks,) in between.

    ``resistance`` is a factor of the wire's own at its austenite.
    """

    columns: Array
    states: tuple[State, ...]
    felt_K: Array

    def __getitem__(self, name: str) -> Array:
        return self.columns[ROWS.index(name)]


def lived(story: Story, subject: Subject, effects: Sequence[Effect]) -> Life:
    """The life of a subject with these effects, in one sitting."""
    way = felt(story, subject, effects)
    return _by_ticks(story, subject, effects) if way is None else _by_parts(story, subject, effects, way)


def _by_ticks(story: Story, subject: Subject, effects: Sequence[Effect]) -> Life:
    plant = Plant(subject.actuator, subject.hysteresis, subject.initial, 0.1, effects)
    per_count, before = subject.per_count or 1.0, 0.0
    t, current, marks = story.ticks
    felt_K, rows, states = np.empty(t.size), [], []
    for k, (now, i, mark) in enumerate(zip(t.tolist(), current.tolist(), marks.tolist())):
        plant.advance(i, now - before)
        before = now
        felt_K[k] = plant.felt_K
        counts = plant.sensed(plant.position / per_count)  # at every tick: a sensor may have a memory
        if mark:
            at = plant.now
            rows.append((counts, plant.operator.y, at.resistance, i, plant.current(i), at.ambient_K))
            states.append(plant.operator.state)
    return Life(np.array(rows).T, tuple(states), felt_K)


def _by_parts(story: Story, subject: Subject, effects: Sequence[Effect], way: Felt) -> Life:
    h = subject.hysteresis
    at = way.ends[story.ticks[2]]  # the parts at whose ends something was read
    output, states = _remembered(subject, way["felt_K"], at)
    setup = Setup(subject.actuator, h, subject.initial)
    late = chains(effects, setup)
    if any(late[stage] for stage in LATE):
        asked = at if _momentary(effects, setup) else np.arange(way["t_s"].size)
        counts = _counts(subject, late, way, asked)[at]
    else:
        counts = output / (subject.per_count or 1.0)
    others = [way[name][at] for name in ("resistance", "command_A", "current_A", "ambient_K")]
    return Life(
        np.stack([counts, output, *others]), states, np.clip(way["felt_K"][way.ends], h.lower, h.upper)
    )


def _remembered(subject: Subject, felt_K: Array, at: NDArray[np.int64]) -> tuple[Array, tuple[State, ...]]:
    """Outputs (n,) and memories at parts ``at`` (n,): only where a path turns is it remembered."""
    operator = Preisach(subject.hysteresis, subject.initial, compiled=False)
    move = np.diff(felt_K, prepend=felt_K[0], append=felt_K[-1])
    turns = move[:-1] * move[1:] <= 0
    turns[at] = True
    kept = np.flatnonzero(turns)
    output, states = [], []
    begin, path = 0, felt_K[kept].tolist()
    for end in (np.searchsorted(kept, at) + 1).tolist():
        for u in path[begin:end]:
            operator.step(u)
        begin = end
        output.append(operator.y)
        states.append(operator.state)
    return np.array(output), tuple(states)


def _momentary(effects: Sequence[Effect], setup: Setup) -> bool:
    """Whether nothing that acts after the hysteresis remembers."""
    remembering = [e for e in effects if not (isinstance(e, Planted) and e.kind.momentary)]
    return not any(stage in LATE for e in remembering for stage in e.hooks(setup))


def _counts(
    subject: Subject, late: Mapping[Stage, tuple[Hook, ...]], way: Felt, asked: NDArray[np.int64]
) -> Array:
    """What the sensor shows at the ends of parts (m,), 0 where it is not asked; between whole ticks it never is."""
    per_count, maps, added, sensor = subject.per_count or 1.0, *(late[stage] for stage in LATE)
    counts = np.zeros(way["t_s"].size)
    for k, (now, whole_s) in zip(asked.tolist(), _moments(subject, way, maps, asked)):
        position = through(added, through(maps, now.output, now), now)
        if whole_s:
            now.dt_s = whole_s
            counts[k] = through(sensor, position / per_count, now)
    return counts


def _moments(
    subject: Subject, way: Felt, maps: tuple[Hook, ...], asked: NDArray[np.int64]
) -> Iterator[tuple[Moment, float]]:
    """(the moment at the end of each part that is asked, the length of the tick that ends there or 0)."""
    h = subject.hysteresis
    operator = Preisach(h, subject.initial)
    span, began, y = h.everett(h.upper, h.lower), operator.y, operator.follow(way["felt_K"])
    per_span = 1.0 / span if span else 0.0
    now = Moment(output=began, austenite=(began - h.y_lower) * per_span)
    through(maps, began, now)  # where it rests
    travel = np.cumsum(np.abs(np.diff(y, prepend=began)) * per_span)
    whole = np.zeros(y.size)
    whole[way.ends] = np.diff(way["t_s"][way.ends], prepend=0.0)
    columns = (*way.columns, y, (y - h.y_lower) * per_span, travel, whole)
    rows = zip(*(column[asked].tolist() for column in columns))
    for row in rows:
        (
            now.t_s,
            now.dt_s,
            now.command_A,
            now.current_A,
            now.resistance,
            now.ambient_K,
            now.source_K,
            now.input_K,
            now.felt_K,
            now.output,
            now.austenite,
            now.travel,
            ends_s,
        ) = row
        yield now, ends_s
