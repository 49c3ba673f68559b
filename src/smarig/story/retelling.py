"""What a model would have shown along a story, with and without effects: the plant retold on the critic's own ticks.

Every effect acts in the very plant the twin runs, so there is one place where an effect is written. The ticks are
fine after each change of the current and coarse later (``story.Drive``); ``numerics`` says what that costs.
Knows no data: predictions come from commands alone, so measured positions cannot explain themselves.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from smarig.model.effect import Effect
from smarig.model.plant import Plant
from smarig.preisach.everett import Everett
from smarig.preisach.operator import Initial, Preisach, State
from smarig.story.life import Life, lived
from smarig.story.sittings import offsets
from smarig.story.subject import Subject
from smarig.story.told import Drive, Story

Array = NDArray[np.float64]

COUPLED = ("settled", "moving", "resistance")  # kinds of readings that follow the operator's output


@dataclass(frozen=True, eq=False)
class Retelling:
    """Predictions by kind of reading, (n,) each; ``t_s`` and ``felt_K`` (m,) the path of what the hysteresis felt.

    ``states``, ``output`` and ``marks`` (n,) are the operator's memory, its output and the tick at each reading
    that depends on them (settled and moving positions, resistances); position minus output is what effects after
    the operator have added. ``follows`` (n,) is the reading's slope to the output: 1, or ∂R/∂y.
    """

    values: dict[str, Array]
    t_s: Array
    felt_K: Array
    states: tuple[State, ...]
    output: Array
    marks: NDArray[np.int64]
    follows: Array
    begins: tuple[int, ...] = (0,)

    @property
    def sitting(self) -> NDArray[np.int64]:
        """Which sitting each coupled reading (n,) is of."""
        return np.searchsorted(self.begins, self.marks, side="right") - 1

    def lived(self, hysteresis: Everett, initial: Initial, felt_K: Array, times: int = 1) -> Array:
        """Outputs (m,) of a hysteresis along a path felt, (m,), from the initial state in every sitting.

        ``times``: how many such paths are to be lived.
        """
        operator = Preisach(hysteresis, initial, samples=times * felt_K.size)
        return np.concatenate(
            [operator.simulate(part, initial) for part in np.split(felt_K, self.begins[1:])]
        )

    @property
    def placed(self) -> "Retelling":
        """The same with nothing but positions read; they stand first."""
        values = {kind: self.values[kind] for kind in ("settled", "moving") if kind in self.values}
        n = sum(v.size for v in values.values())
        return replace(
            self,
            values=values,
            states=self.states[:n],
            output=self.output[:n],
            marks=self.marks[:n],
            follows=self.follows[:n],
        )

    def of(self, kind: str) -> slice:
        """Where the coupled readings of one kind stand."""
        before = [self.values[k].size for k in COUPLED[: COUPLED.index(kind)] if k in self.values]
        return slice(sum(before), sum(before) + self.values[kind].size)

    def stacked(self, story: Story) -> Array:
        """All predictions in the order of the story's readings, (N,)."""
        return np.concatenate([self.values[r.kind] for r in story.kinds])


def retold(story: Story, subject: Subject, effects: Sequence[Effect] = ()) -> Retelling:
    """The story as the subject would have lived it, with further effects; in every sitting anew."""
    if not story.sittings:
        return _retold(story, subject, effects)
    return _in_turn(story, [_retold(sitting, subject, effects) for sitting in story.sittings])


def _retold(story: Story, subject: Subject, effects: Sequence[Effect]) -> Retelling:
    life = lived(story, subject, (*subject.effects, *effects))
    t, _, read = story.ticks
    rows = {r.kind: np.searchsorted(t[read], np.round(r.t_s, 6)) for r in story.kinds}
    coupled = np.concatenate([rows[k] for k in COUPLED if k in rows])
    own = {"current": life["current_A"] - life["command_A"], "room": life["ambient_K"]}
    if "resistance" in rows:
        own["resistance"] = _ohms(life, subject, by_command=story.ohms_by_command)
    position = life["counts"] * (subject.per_count or 1.0)
    return Retelling(
        {kind: own.get(kind, position)[k] for kind, k in rows.items()},
        t,
        life.felt_K,
        tuple(life.states[k] for k in coupled),
        life["output"][coupled],
        np.flatnonzero(read)[coupled],
        np.concatenate([_follows(k, life["command_A"][rows[k]], subject) for k in COUPLED if k in rows]),
    )


def _ohms(life: Life, subject: Subject, *, by_command: bool) -> Array:
    """Resistance (n,) of the wire that carries the current; over the current asked for, where none was measured."""
    wire, h, command = subject.actuator, subject.hysteresis, life["command_A"]
    austenite = (life["output"] - h.y_lower) / subject.stroke
    austenite = np.where((command < 0) & wire.two_wire, 1 - austenite, austenite)
    ohms = np.array([wire.resistance_at_ohm(a) for a in austenite.tolist()]) * life["resistance"]
    some = command != 0
    if by_command:
        ohms[some] *= life["current_A"][some] / command[some]
    return ohms


def _follows(kind: str, command_A: Array, subject: Subject) -> Array:
    """∂(reading)/∂(output), (n,): a resistance follows the austenite of the wire that carries the current."""
    if kind != "resistance":
        return np.ones(command_A.size)
    wire = subject.actuator
    per_stroke = wire.resistance_at_ohm(1.0) - wire.resistance_at_ohm(0.0)
    return np.where((command_A < 0) & wire.two_wire, -1.0, 1.0) * per_stroke / subject.stroke


def positions(drive: Drive, subject: Subject, at_s: Array) -> Array:
    """Positions (n,) along a drive at times (n,), increasing."""
    plant = Plant(subject.actuator, subject.hysteresis, subject.initial, 0.1, subject.effects)
    t, current = drive.ticks(at_s)
    seen, per_count, before = np.empty(t.size), subject.per_count or 1.0, 0.0
    for k, (now, i) in enumerate(zip(t.tolist(), current.tolist())):
        plant.advance(i, now - before)
        before = now
        seen[k] = plant.sensed(plant.position / per_count) * per_count
    return np.interp(at_s, t, seen)


def _in_turn(story: Story, parts: Sequence[Retelling]) -> Retelling:
    """Retellings of all sittings as one, in the order of the joined story's readings."""
    ticks = np.cumsum([0, *[part.t_s.size for part in parts]])
    coupled = [(k, part.of(kind)) for kind in COUPLED for k, part in enumerate(parts) if kind in part.values]

    def together(column: Callable[[Retelling], Array]) -> Array:
        return np.concatenate([column(parts[k])[rows] for k, rows in coupled])

    return Retelling(
        {
            r.kind: np.concatenate([p.values[r.kind] for p in parts if r.kind in p.values])
            for r in story.kinds
        },
        np.concatenate([part.t_s + begin for part, begin in zip(parts, offsets(story.sittings))]),
        np.concatenate([part.felt_K for part in parts]),
        tuple(state for k, rows in coupled for state in parts[k].states[rows]),
        together(lambda part: part.output),
        np.concatenate([parts[k].marks[rows] + ticks[k] for k, rows in coupled]),
        together(lambda part: part.follows),
        tuple(ticks[:-1].tolist()),
    )


def about(told: Retelling, subject: Subject, centre: Everett) -> Retelling:
    """The same path felt, with the outputs of another hysteresis along it."""
    if centre is subject.hysteresis:
        return told
    output = told.lived(centre, subject.initial, told.felt_K)[told.marks]
    change, values, at = told.follows * (output - told.output), dict(told.values), 0
    for kind in COUPLED:
        if kind in values:
            n = values[kind].size
            values[kind] = values[kind] + change[at : at + n]
            at += n
    return replace(told, values=values, output=output)


def numerics(story: Story, subject: Subject) -> float:
    """Largest difference of settled positions between the critic's ticks and ones a quarter as long, output units."""
    if story.sittings:
        return max(numerics(sitting, subject) for sitting in story.sittings)
    coarse = retold(story, subject).values["settled"]
    t, current = story.drive.ticks(np.round(story.settled.t_s, 6))
    plant = Plant(subject.actuator, subject.hysteresis, subject.initial, 0.1, subject.effects)
    seen, before = {}, 0.0
    for now, i in zip(t.tolist(), current.tolist()):
        for _ in range(4):
            plant.advance(i, (now - before) / 4)
        before = now
        seen[now] = plant.position
    fine = np.array([seen[v] for v in np.round(story.settled.t_s, 6).tolist()])
    return float(np.abs(coarse - fine).max())
