"""Current staircases as a lab would plan them: settled holds at targets, in runs of one session.

Targets are commanded steady temperatures (R/hA) i², signed for two wires. They do not depend on the hidden
effects.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from benchmarks.boxes.kinetic_hysteresis import BoxHysteresis
from benchmarks.boxes.wire import BoxWire

_TURNS = (0.9, 0.2, 0.72, 0.35, 0.58)
_FEWEST, _MOST = 250, 420  # holds


@dataclass(frozen=True)
class PlannedHold:
    """A constant current until the wire is steady, then ``extra_s``, then the window."""

    target_K: float
    branch: str
    extra_s: float = 0.0


@dataclass(frozen=True)
class RunPlan:
    """One run: its name, whether it is held out, and its holds."""

    name: str
    held_out: bool
    holds: tuple[PlannedHold, ...]


@dataclass(frozen=True)
class _ActiveRange:
    """The lab's saturations, and the range in which the wire was observed to move."""

    lower: float
    upper: float
    first: float
    last: float

    def at(self, share: float) -> float:
        """The target at a share of the range in which the wire moves."""
        return float(round(self.first + share * (self.last - self.first), 3))


def random_plan(rng: np.random.Generator, wire: BoxWire, hysteresis: BoxHysteresis) -> tuple[RunPlan, ...]:
    """All runs of a box in the order of time: 250 to 420 holds."""
    active = _observed_range(rng, wire, hysteresis)
    curves, n = _levels(rng, active, int(rng.integers(8, 12))), int(rng.integers(3, 5))
    train = [
        RunPlan("fod", False, (*_saturate(active), *_rise(active, 10), *_curves(curves))),
        RunPlan("congruency", False, tuple(_congruency(rng, active, n))),
        RunPlan("wiping_out", False, tuple(_wiping_out(active, n))),
    ]
    if rng.random() < 0.3:
        train.append(RunPlan("repeat", False, tuple(_repeat(rng, active, curves, wire))))
    others = _levels(rng, active, int(rng.integers(6, 9)))
    held_out = [RunPlan("curves", True, (*_saturate(active), *_curves(others)))]
    points = int(rng.integers(40, 100))
    so_far = sum(len(run.holds) for run in (*train, *held_out)) + 3
    points = min(max(points, _FEWEST - so_far), _MOST - so_far)
    held_out.append(RunPlan("validation", True, (*_saturate(active), *_walk(rng, active, points))))
    rng.shuffle(held_out)
    last = held_out[-1]
    end = (PlannedHold(active.upper, "saturate"), PlannedHold(active.lower, "saturate"))
    plan = (*train, *held_out[:-1], RunPlan(last.name, True, (*last.holds, *end)))
    return _with_longer_holds(rng, plan) if rng.random() < 0.3 else plan


def duration_h(plan: tuple[RunPlan, ...], wire: BoxWire) -> float:
    """Approximate duration of a plan."""
    holds = [hold for run in plan for hold in run.holds]
    return sum(25 + 8 * wire.tau_s + hold.extra_s for hold in holds) / 3600


def _observed_range(rng: np.random.Generator, wire: BoxWire, hysteresis: BoxHysteresis) -> _ActiveRange:
    first, last = np.quantile(hysteresis.beta, 0.01), np.quantile(hysteresis.alpha, 0.99)
    lower = -wire.reference_K if wire.two_wire else 0.0
    first = max(first - rng.uniform(0, 8), lower + 2)
    return _ActiveRange(
        lower, wire.reference_K, float(first), float(min(last + rng.uniform(0, 8), 0.97 * wire.reference_K))
    )


def _levels(rng: np.random.Generator, active: _ActiveRange, segments: int) -> list[float]:
    """A partition: saturations and levels in between, evenly spaced with random shifts."""
    inner = (np.arange(segments - 1) + rng.uniform(0.2, 0.8, segments - 1)) / (segments - 1)
    return [active.lower, *(active.at(s) for s in inner), active.upper]


def _saturate(active: _ActiveRange) -> list[PlannedHold]:
    return [PlannedHold(active.lower, "saturate")]


def _line(start: float, stop: float, n: int, branch: str) -> list[PlannedHold]:
    return [PlannedHold(float(round(u, 3)), branch) for u in np.linspace(start, stop, n + 1)[1:]]


def _rise(active: _ActiveRange, n: int) -> list[PlannedHold]:
    """Ascend to saturation, and return."""
    steps = [PlannedHold(active.at(k / (n - 1)), "major up") for k in range(n)]
    return [*steps, PlannedHold(active.upper, "major up"), PlannedHold(active.lower, "saturate")]


def _curves(levels: list[float]) -> list[PlannedHold]:
    """First-order descending curves over a partition."""
    holds: list[PlannedHold] = []
    for k in range(1, len(levels)):
        holds.append(PlannedHold(levels[k], f"rise {k}"))
        holds += [PlannedHold(level, f"fod {k}") for level in reversed(levels[:k])]
    return holds


def _wiping_out(active: _ActiveRange, n: int) -> Iterable[PlannedHold]:
    """Two identical nested inputs; the second must retrace the first."""
    turns, start = [active.at(share) for share in _TURNS], active.lower
    yield from _saturate(active)
    for segment in ("A", "B"):
        yield from _line(start, turns[0], n, f"{segment} peak")
        for k in range(1, len(turns)):
            yield from _line(turns[k - 1], turns[k], n, f"{segment} {k}")
        start = turns[-1]
    yield from _saturate(active)


def _congruency(rng: np.random.Generator, active: _ActiveRange, n: int) -> Iterable[PlannedHold]:
    """Loops between the same limits from both branches, three times each."""
    middle, half = rng.uniform(0.45, 0.6), rng.uniform(0.12, 0.22)
    bottom, top = active.at(middle - half), active.at(middle + half)
    yield from _saturate(active)
    yield from _line(active.at(0.0), top, n, "rise")
    for k in range(1, 4):
        yield from _line(top, bottom, n, f"A{k} down")
        yield from _line(bottom, top, n, f"A{k} up")
    yield PlannedHold(active.upper, "peak")
    yield from _line(active.at(1.0), bottom, n, "fall")
    for k in range(1, 4):
        yield from _line(bottom, top, n, f"B{k} up")
        yield from _line(top, bottom, n, f"B{k} down")
    yield from _saturate(active)


def _repeat(
    rng: np.random.Generator, active: _ActiveRange, levels: list[float], wire: BoxWire
) -> Iterable[PlannedHold]:
    """A pause, then one descending curve again."""
    k = int(rng.integers(len(levels) // 2, len(levels)))
    rest_K = 0.0 if wire.two_wire else active.lower
    yield PlannedHold(rest_K, "pause", float(round(60 * rng.uniform(20, 60), 1)))
    yield from _saturate(active)
    yield PlannedHold(levels[k], f"rise {k}")
    for level in reversed(levels[:k]):
        yield PlannedHold(level, f"fod {k}")


def _walk(rng: np.random.Generator, active: _ActiveRange, points: int) -> Iterable[PlannedHold]:
    """A random walk, reflected at the ends of the range in which the wire moves."""
    share = rng.uniform(0.3, 0.9)
    for _ in range(points):
        share = abs(share + rng.normal(0, 0.3)) % 2
        share = 2 - share if share > 1 else share
        yield PlannedHold(active.at(share), "validation")


def _with_longer_holds(rng: np.random.Generator, plan: tuple[RunPlan, ...]) -> tuple[RunPlan, ...]:
    """Make some holds longer than others."""
    waits = (0.0, 0.0, 0.0, 30.0, 120.0, 300.0)

    def with_wait(hold: PlannedHold) -> PlannedHold:
        return PlannedHold(hold.target_K, hold.branch, hold.extra_s + float(rng.choice(waits)))

    return tuple(RunPlan(run.name, run.held_out, tuple(with_wait(h) for h in run.holds)) for run in plan)
