"""Faults of one channel at ten phases of heating and cooling, and sound wires: what is noticed, when, how far off.

A cell is one fault that begins 3 s after the start of one of ten holds which take the wire through its whole range and
back. The holds go on from there, once more through the range, until the guard trips. ``caught_s`` and ``error``: time
and largest error of the channel until the first sample is marked; ``tripped_s``: until the current is at zero.
``unseen``: the largest error of a step that is recorded as settled without a marked sample. A fault whose error stays
below the tolerance of its channel is no fault yet; such cells are ``small``.

Healthy campaigns: every effect of the catalogue at its typical strength, random holds, other seeds.
"""

import copy
import math
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from smarig.config import RigFile, load_rig
from smarig.core import NAN, Hold, LimitExceeded, Protocol, Quality, Sample, Settled, StepResult, StepVerdict
from smarig.plant import Actuator, Effect, EffectType, effect_types
from smarig.rig import Guard, Plausibility, Twin, TwinSettings
from smarig.runner import CallbackListener, Runner

RIGS = ("one_wire_twin", "two_wire_twin", "one_wire_thermomechanical", "two_wire_thermomechanical")
ONE_WIRE = (0.3, 0.42, 0.55, 0.7, 1.0, 0.6, 0.4, 0.25, 0.12, 0.0)  # of the largest temperature
TWO_WIRE = (0.15, 0.35, 0.6, 1.0, 0.4, -0.1, -0.35, -0.6, -1.0, 0.0)
AFTER_S = 3.0  # of a hold, until the fault begins
CAMPAIGNS, HOLDS = 200, 12
THERMOMETER_NOISE_K = 0.3
LARGEST_SHARE = (
    0.9  # of the temperature of the largest current: with a gain of an amplifier it trips at its limit
)
CLIPPED_SHARE = 0.6  # with an amplifier that clips at 0.8 of it, which trips as it should
SUSPECT = int(Quality.SUSPECT)
Change = Callable[[float, float, random.Random], float]


def stuck(_x: float, start: float, _: random.Random) -> float:
    """The reading of the start."""
    return start


def slipping(share: float) -> Change:
    """Only this share of every change arrives."""
    return lambda x, start, _dice: start + share * (x - start)


def jumping(by: float) -> Change:
    """So much more from the start on."""
    return lambda x, _start, _dice: x + by


def reversed_direction(x: float, start: float, _: random.Random) -> float:
    """Every change has the wrong sign."""
    return 2 * start - x


def negated(x: float, _start: float, _: random.Random) -> float:
    """The reading has the wrong sign."""
    return -x


def reading(value: float) -> Change:
    """Always this value."""
    return lambda _x, _start, _dice: value


def noisy(sd: float) -> Change:
    """Noise with this standard deviation is added."""
    return lambda x, _start, dice: x + dice.gauss(0.0, sd)


@dataclass(frozen=True)
class FaultyChannel:
    """A channel: its field of a sample, unit, tolerance of its check in that unit, and faults."""

    field: str
    unit: str
    tolerance: float
    faults: dict[str, Change]


def channels(file: RigFile, actuator: Actuator) -> dict[str, FaultyChannel]:
    """The channels of a rig with their faults."""
    plausibility = Plausibility(file, actuator)
    stroke = plausibility.stroke_counts
    largest_A = file.limits.current_max_A
    largest_V = largest_A * actuator.resistance_ohm
    surface = actuator.hysteresis
    common = {"slipping to 0.7": slipping(0.7), "slipping to 0.9": slipping(0.9), "stuck": stuck}

    def analog(field: str, unit: str, scale: float, tolerance: float, lost: float) -> FaultyChannel:
        others: dict[str, Change] = {
            "jumping by 0.2": jumping(0.2 * scale),
            "jumping by 0.05": jumping(0.05 * scale),
            "wrong sign": negated,
            "lost": reading(lost),
            "noisy": noisy(0.1 * scale),
        }
        return FaultyChannel(field, unit, tolerance * scale, common | others)

    jumps = {f"jumping by {n} counts": jumping(n) for n in (50, 20, 10, 5)}
    found = {
        "position": FaultyChannel(
            "counts",
            "counts",
            0.05 * stroke,
            common
            | jumps
            | {"wrong sign": reversed_direction, "lost": reading(0), "noisy": noisy(0.05 * stroke)},
        ),
        "current": analog("current_A", "A", largest_A, 0.05, 0.0),
        "voltage": analog("voltage_V", "V", largest_V, 0.1, 0.0),
    }
    if not actuator.two_wire:
        found["thermometer"] = analog("temperature_degC", "K", surface.upper - surface.lower, 0.1, NAN)
    return found


@dataclass
class FaultyRig:
    """A twin with a thermometer on its wire; from ``begin`` on one reading of each sample is changed."""

    twin: Twin
    begin: int | None = None
    channel: str = ""
    change: Change = stuck
    start: float = 0.0
    dice: random.Random = field(default_factory=lambda: random.Random(1))
    truth: list[Sample] = field(default_factory=list)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "twin":
            raise AttributeError(name)
        return getattr(self.twin, name)

    def step(self, current_A: float, at_most: int = 1) -> tuple[Sample, ...]:
        """The next sample, as the rig reports it; ``truth`` keeps it as it is."""
        true = self._with_thermometer(self.twin.step(current_A, at_most)[0])
        self.truth.append(true)
        if self.begin is None or true.tick < self.begin:
            return (true,)
        value = getattr(true, self.channel)
        offset = true.ambient_degC if self.channel == "temperature_degC" else 0.0
        if true.tick == self.begin:
            self.start = value - offset
        new = offset + self.change(value - offset, self.start, self.dice)
        read: dict[str, Any] = {self.channel: round(new) if self.channel == "counts" else new}
        return (true._replace(**read),)

    def _with_thermometer(self, s: Sample) -> Sample:
        if self.twin.actuator.two_wire:
            return s
        wire_K = self.twin.specimen.wire_K
        noise_K = self.dice.gauss(0.0, THERMOMETER_NOISE_K)
        return s._replace(temperature_degC=round(s.ambient_degC + wire_K[0] + noise_K, 2))


def run(quick: bool = False, seed: int = 1) -> dict[str, Any]:
    """``{"faults": {RIG: {CHANNEL: {FAULT: …}}}, "healthy": …, "never_noticed": n}``; ``quick``: one wire, 3 phases."""
    rigs = RIGS[:1] if quick else RIGS
    faults = {rig: fault_table(rig, (1, 4, 7) if quick else range(10), seed) for rig in rigs}
    return {"faults": faults, "healthy": healthy(rigs, 12 if quick else CAMPAIGNS, seed)}


# --- faults --------------------------------------------------------------------------------------


def guarded(rig: str, settings: TwinSettings) -> tuple[Guard, FaultyRig]:
    """A guard on a twin whose readings can be changed."""
    file = load_rig(rig)
    actuator = Actuator.named(file.actuator)
    faulty = FaultyRig(Twin(file, actuator, settings))
    return Guard(faulty, file.limits, actuator, Plausibility(file, actuator)), faulty  # pyrefly: ignore [bad-argument-type]


def levels_A(actuator: Actuator, file: RigFile) -> list[float]:
    """The currents of the ten holds."""
    hottest_K = actuator.input_for(file.limits.current_max_A)
    shares = TWO_WIRE if actuator.two_wire else ONE_WIRE
    return [actuator.current_for(share * hottest_K) for share in shares]


def one_hold(current_A: float, limit_s: float) -> Protocol:
    """A hold until the wire has settled."""
    yield Hold(current_A, Settled(timeout_s=limit_s))


def fault_table(rig: str, phases: Any, seed: int) -> dict[str, dict[str, dict[str, Any]]]:
    """The figures of each fault of each channel of a rig."""
    guard, _ = guarded(rig, TwinSettings(seed=seed))
    file, actuator = load_rig(rig), Actuator.named(load_rig(rig).actuator)
    levels = levels_A(actuator, file)
    cells: dict[tuple[str, str], list[Cell]] = {}
    for phase, level_A in enumerate(levels):
        if phase in phases:
            rest = [*levels[phase:], *levels]
            for name, channel in channels(file, actuator).items():
                for fault, change in channel.faults.items():
                    cell = cell_of(copy.deepcopy(guard), rest, channel, change)
                    cells.setdefault((name, fault), []).append(cell)
        Runner(guard, 1.0, []).run(one_hold(level_A, 150.0))
    found: dict[str, dict[str, Any]] = {}
    for (name, fault), of_phases in cells.items():
        found.setdefault(name, {})[fault] = summary(channels(file, actuator)[name], of_phases)
    return found


@dataclass
class Cell:
    """What became of a fault."""

    caught_s: float = math.nan
    error: float = 0.0  # largest until it was caught
    tripped_s: float = math.nan
    kind: str = ""
    unseen: float = 0.0
    largest: float = 0.0
    marked_steps: int = 0


def cell_of(guard: Guard, currents_A: list[float], channel: FaultyChannel, change: Change) -> Cell:
    """Run the holds with a fault that begins in the first of them."""
    rig: FaultyRig = guard.rig  # pyrefly: ignore [bad-assignment]
    rig.begin = rig.tick + round(AFTER_S / guard.period_s)
    rig.channel, rig.change, rig.truth = channel.field, change, []
    cell, errors, marks = Cell(), [], []

    def on_sample(s: Sample, _step: int | None, _input_K: float) -> None:
        if s.tick < (rig.begin or 0):
            return
        true, read = getattr(rig.truth[-1], channel.field), getattr(s, channel.field)
        error = channel.tolerance * 2 if math.isnan(read) else abs(read - true)
        errors.append(error)
        marks.append(bool(s.quality & SUSPECT))
        cell.largest = max(cell.largest, error)
        if math.isnan(cell.caught_s):
            cell.error = max(cell.error, error)
            if marks[-1]:
                cell.caught_s = len(errors) * guard.period_s

    def on_step(result: StepResult) -> None:
        window = slice(max(0, len(errors) - result.n), None)
        if result.verdict is not StepVerdict.SETTLED or any(marks[window]):
            cell.marked_steps += 1
        elif errors:
            cell.unseen = max(cell.unseen, sum(errors[window]) / len(errors[window]))

    def on_event(kind: str, _t_s: float) -> None:
        cell.kind = kind

    listener = CallbackListener(on_sample=on_sample, on_step=on_step, on_event=on_event)
    runner = Runner(guard, 1.0, [listener])
    try:
        for current_A in currents_A:
            runner.run(one_hold(current_A, 150.0))
    except LimitExceeded:
        cell.tripped_s = len(errors) * guard.period_s
        cell.kind = cell.kind or "limit"
        if math.isnan(cell.caught_s):
            cell.caught_s = cell.tripped_s
    return cell


def summary(channel: FaultyChannel, cells: list[Cell]) -> dict[str, Any]:
    """The figures of one fault over its phases."""
    caught = [c for c in cells if not math.isnan(c.caught_s)]
    tripped = [c for c in cells if not math.isnan(c.tripped_s)]
    unnoticed = [c for c in cells if math.isnan(c.caught_s)]
    return {
        "unit": channel.unit,
        "phases": len(cells),
        "caught": len(caught),
        "tripped": len(tripped),
        "caught_s": _median_and_largest([c.caught_s for c in caught]),
        "error": _median_and_largest([c.error for c in caught]),
        "tripped_s": _median_and_largest([c.tripped_s for c in tripped]),
        "tolerance": round(channel.tolerance, 3),
        "small": sum(c.largest <= channel.tolerance for c in unnoticed),
        "unnoticed": sum(c.largest > channel.tolerance for c in unnoticed),
        "unseen": round(max(c.unseen for c in cells), 3),
        "unseen_steps_beyond_tolerance": sum(c.unseen > channel.tolerance for c in cells),
        "kinds": sorted({c.kind for c in tripped}),
        "by_phase": [
            [None if math.isnan(x) else round(x, 2) for x in (c.caught_s, c.error, c.tripped_s, c.unseen)]
            for c in cells
        ],
    }


def _median_and_largest(values: list[float]) -> list[float] | None:
    if not values:
        return None
    ordered = sorted(values)
    return [round(ordered[len(ordered) // 2], 2), round(ordered[-1], 2)]


# --- healthy wires -------------------------------------------------------------------------------


def healthy(rigs: tuple[str, ...], campaigns: int, seed: int) -> dict[str, Any]:
    """Trips and marked samples of wires whose readings are right."""
    wires = list(_wires(rigs))
    tripped: list[str] = []
    marked: dict[str, int] = {}
    samples, steps = 0, 0
    for k in range(campaigns):
        rig, kind = wires[k % len(wires)]
        guard, _ = guarded(rig, TwinSettings(seed=seed + k, effects=_effects(kind)))
        name = f"{rig}, {kind.name if kind else 'no effect'}, seed {seed + k}"
        counts = {"n": 0, "marked": 0, "steps": 0}
        share = CLIPPED_SHARE if kind is not None and kind.name == "saturation" else LARGEST_SHARE
        if (cause := _campaign(guard, seed + k, share, counts)) is not None:
            tripped.append(f"{name}: {cause}")
        if counts["marked"]:
            marked[name] = counts["marked"]
        samples, steps = samples + counts["n"], steps + counts["steps"]
    return {
        "campaigns": campaigns,
        "tripped": tripped,
        "samples": samples,
        "marked": marked,
        "steps": steps,
    }


def _wires(rigs: tuple[str, ...]) -> Iterator[tuple[str, EffectType | None]]:
    for rig in rigs:
        actuator = Actuator.named(load_rig(rig).actuator)
        yield rig, None
        if actuator.file.thermomechanical is None:
            yield from ((rig, kind) for kind in effect_types(actuator.file.arrangement))


def _effects(kind: EffectType | None) -> tuple[Effect, ...]:
    if kind is None:
        return ()
    return (kind(at_h=0.1),) if kind.name == "slip" else (kind(),)


def _campaign(guard: Guard, seed: int, share: float, counts: dict[str, int]) -> str | None:
    """Random holds over the range and two returns to cold; the cause of a trip."""
    dice, actuator = random.Random(seed), guard.rig.actuator  # pyrefly: ignore [missing-attribute]
    limits = guard.limits
    hottest_K, coldest_K = (
        share * actuator.input_for(x) for x in (limits.current_max_A, limits.current_min_A)
    )

    def on_sample(s: Sample, _step: int | None, _input_K: float) -> None:
        counts["n"] += 1
        counts["marked"] += bool(s.quality & SUSPECT)

    def on_step(_: StepResult) -> None:
        counts["steps"] += 1

    runner = Runner(guard, 1.0, [CallbackListener(on_sample=on_sample, on_step=on_step)])
    inputs = [dice.uniform(min(coldest_K, 0.0), hottest_K) for _ in range(HOLDS)]
    inputs[3], inputs[HOLDS // 2], inputs[-1] = hottest_K, 0.0, 0.0
    try:
        for input_K in inputs:
            runner.run(one_hold(actuator.current_for(input_K), dice.uniform(30.0, 120.0)))
    except LimitExceeded as cause:
        return str(cause)
    return None
