"""Position tracking with feed-forward and feedback, PI and gain scheduling, on wires that differ from the
model.

The truths are the nominal surface with all parameters changed at random, so that the rms difference of the
two FOD surfaces is 10 % of the output range. Every controller has the nominal surface. Every controller is
tuned by the same simplex with the same budget on wires of other seeds, and runs through the same runner and
guard on the same references. This is done three times: freely; with currents that move by at most ``CALM_A``
per tick on average, since a high gain gets its small error with a current that jumps between its limits; and
freely on references ``FAST`` times as fast. Errors are those of the twin's true position, without
quantisation. Errors of the readings are listed too.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from smarig.config import load_rig
from smarig.control import (
    TRACKING_CONTROLLERS,
    ControllerModel,
    Reference,
    TrackingPerformance,
    controller_factory,
    reference,
    track,
    tracking_performance,
    tuned_numbers,
)
from smarig.core import RigFault, Sample, catalogue_names
from smarig.plant import Actuator, SupportsHooks
from smarig.preisach import Everett, FodSurface, thesis_surface
from smarig.protocols import Setup
from smarig.rig import Guard, Twin, TwinSettings
from smarig.runner import CallbackListener, Runner

RIG = "one_wire_twin"
LOW, HIGH = 2.0, 8.0  # mm: within reach of each of these wires, of 12.5
SHAPES = ("multisine", "ramps")
SECONDS, SKIP_S = 200.0, 20.0  # the way to the first point is not counted
ERROR_SHARE = 0.10
TUNING_SEEDS = (101, 102, 103)
NODES = 25
PREVIEW_S = (0.02, 2.0)
CALM_A = 0.015  # no more than the inverse needs
FAST = 2.0  # some of these wires cool too slowly in air for it, so medians are more useful than means


def run(quick: bool = False) -> dict[str, Any]:
    """``{"free": {"controllers": {name: {"rms_counts", …}}, "gain"}, "calm": the same, "fast": the same}``."""
    seeds, budget = (range(1, 6), 30) if quick else (range(1, 21), 90)
    nominal = controller_model()
    wires = {seed: perturbed_surface(seed) for seed in (*TUNING_SEEDS, *seeds)}
    free, calm, fast = (
        _compared(nominal, wires, seeds, budget, most_A, speed)
        for most_A, speed in ((math.inf, 1.0), (CALM_A, 1.0), (math.inf, FAST))
    )
    return {
        "rig": RIG,
        "model_error_share": ERROR_SHARE,
        "seeds": list(seeds),
        "budget": budget,
        "free": free,
        "calm": calm,
        "calm_A": CALM_A,
        "fast": fast,
        "fast_speed": FAST,
    }


def _compared(
    assumed_model: ControllerModel,
    wires: Mapping[int, Everett],
    seeds: Sequence[int],
    budget: int,
    most_A: float,
    speed: float,
) -> dict[str, Any]:
    """Every controller, tuned and evaluated; gains are ratios of mean rms errors to that of the inverse."""
    found = {}
    for name in catalogue_names(TRACKING_CONTROLLERS):
        numbers = tuned_numbers(name, _cost(assumed_model, name, wires, most_A, speed), budget)
        found[name] = _controller_figures(assumed_model, name, numbers, wires, seeds, speed)
    preview_gains = tuned_numbers(
        "pi", _cost(assumed_model, "pi", wires, most_A, speed), budget, {"lead_s": PREVIEW_S}
    )
    found["pi with preview"] = _controller_figures(assumed_model, "pi", preview_gains, wires, seeds, speed)
    best = {name: found[name]["rms_counts"]["mean"] for name in found}
    return {"controllers": found, "gain": {name: best[name] / best["inverse"] for name in best}}


def controller_model() -> ControllerModel:
    """The model that every controller is given."""
    file = load_rig(RIG)
    actuator = Actuator.named(file.actuator)
    setup = Setup(actuator, file.limits, file.period_s)
    return ControllerModel(setup, actuator.hysteresis, actuator.resolution(file.encoder))


def perturbed_surface(seed: int, share: float = ERROR_SHARE) -> FodSurface:
    """The nominal surface with changed parameters: the rms difference of both is ``share`` of the output
    range."""
    nominal = thesis_surface("one_e")
    levels = np.linspace(nominal.lower, nominal.upper, NODES)
    alpha, beta = (m[np.tri(NODES, dtype=bool)] for m in np.meshgrid(levels, levels, indexing="ij"))
    own, directions = (
        nominal.y(alpha, beta),
        np.random.default_rng([seed, 0x3172]).normal(size=len(nominal.x) + 1),
    )

    def at(scale: float) -> FodSurface:
        x = tuple((np.array(nominal.x) * (1 + scale * directions[:-1])).tolist())
        return replace(nominal, x=x, y_upper=nominal.y_upper * (1 + scale * float(directions[-1])))

    def rms_share(scale: float) -> float:
        return float(np.sqrt(np.mean((at(scale).y(alpha, beta) - own) ** 2))) / (
            nominal.y_upper - nominal.y_lower
        )

    near, scale = 0.0, 0.02
    while rms_share(scale) < share:
        near, scale = scale, 2 * scale
    for _ in range(50):
        near, scale = (mid, scale) if rms_share(mid := 0.5 * (near + scale)) < share else (near, mid)
    return at(near)


@dataclass(frozen=True)
class SimulatedLoop:
    """Figures of a closed loop: errors of the wire's position and of the readings, largest current, mean
    move per tick."""

    true: TrackingPerformance
    read: TrackingPerformance
    peak_A: float
    moves_A: float
    fault: str = ""


def simulate_loop(
    assumed_model: ControllerModel,
    name: str,
    numbers: Mapping[str, float],
    wire: Everett,
    target: Reference,
    seed: int,
    effects: Sequence[SupportsHooks] = (),
) -> SimulatedLoop:
    """One loop through runner and guard on a twin with noise. A trip is reported and ends it."""
    file = load_rig(RIG)
    twin = Twin(file, assumed_model.setup.actuator, TwinSettings(seed=seed, hysteresis=wire, effects=effects))
    rows: list[tuple[float, float, float, float, float]] = []

    def sample(s: Sample, _step: int | None, input_K: float) -> None:
        rows.append((s.t_s, twin.specimen.plant.position, s.position, s.current_A, input_K))

    guard = Guard(twin, file.limits, assumed_model.setup.actuator)
    fault = ""
    try:
        runner = Runner(guard, twin.position_per_count, [CallbackListener(on_sample=sample)])
        runner.run(track(assumed_model, controller_factory(name, numbers), target, prepare=False))
    except RigFault as error:
        fault = str(error)
    t, own, read, current, temperature = np.array(rows).T
    rest = (
        assumed_model.plant().position
    )  # the twin's wire starts at its own rest position; all of them are shifted to 0 mm
    figures = [
        tracking_performance(
            reference=target,
            t_s=t - t[0],
            position=y,
            current_A=current,
            input_K=temperature,
            actuator=assumed_model.setup.actuator,
            per_count=twin.position_per_count,
            skip_s=SKIP_S,
            ahead_s=numbers.get("lead_s", 0.0),
        )
        for y in (own - rest, read)
    ]
    return SimulatedLoop(
        figures[0], figures[1], float(np.abs(current).max()), float(np.abs(np.diff(current)).mean()), fault
    )


def references(seed: int, shapes: Sequence[str] = SHAPES, speed: float = 1.0) -> list[Reference]:
    """The references for the wire of a seed."""
    return [reference(shape, LOW, HIGH, seconds=SECONDS, seed=seed, speed=speed) for shape in shapes]


def _cost(
    assumed_model: ControllerModel, name: str, wires: Mapping[int, Everett], most_A: float, speed: float
) -> Callable[[Mapping[str, float]], float]:
    """Rms error over the tuning wires and references, with a penalty for trips and for currents that are not calm."""

    def cost(numbers: Mapping[str, float]) -> float:
        loops = [
            simulate_loop(assumed_model, name, numbers, wires[seed], target, seed)
            for seed in TUNING_SEEDS
            for target in references(seed, speed=speed)
        ]
        excess = max(0.0, float(np.mean([loop.moves_A for loop in loops])) / most_A - 1)
        rms = np.sqrt(np.mean([1e6 if loop.fault else loop.true.rms**2 for loop in loops]))
        return float(rms) * (1 + 100 * excess)

    return cost


def _controller_figures(
    assumed_model: ControllerModel,
    name: str,
    numbers: Mapping[str, float],
    wires: Mapping[int, Everett],
    seeds: Sequence[int],
    speed: float,
) -> dict[str, Any]:
    count = assumed_model.position_per_count

    def over(shapes: Sequence[str], speed: float) -> list[SimulatedLoop]:
        return [
            simulate_loop(assumed_model, name, numbers, wires[s], r, s)
            for s in seeds
            for r in references(s, shapes, speed)
        ]

    loops, steps = over(SHAPES, speed), [loop.read for loop in over(["steps"], 1.0)]
    settled = np.array([value for step in steps for value in step.settle_s])
    return {
        "numbers": dict(numbers),
        "rms_counts": _spread([loop.true.rms / count for loop in loops]),
        "reading_rms_counts": _spread([loop.read.rms / count for loop in loops]),
        "largest_counts": float(max(loop.true.largest for loop in loops) / count),
        "energy_J": float(np.mean([loop.true.energy_J for loop in loops])),
        "peak_K": float(max(loop.true.peak_K for loop in loops)),
        "peak_A": float(max(loop.peak_A for loop in loops)),
        "moves_A": float(np.mean([loop.moves_A for loop in loops])),
        "faults": sum(bool(loop.fault) for loop in loops),
        "steps": {
            "n": settled.size,
            "reached_2_counts": int(np.isfinite(settled).sum()),
            "median_s": float(np.nanmedian(settled)),
            "p90_s": float(np.nanpercentile(settled, 90)),
            "overshoot_counts": float(np.mean([o for step in steps for o in step.overshoot]) / count),
        },
    }


def _spread(values: Sequence[float]) -> dict[str, float]:
    return {
        "mean": float(np.mean(values)),
        "median": float(np.median(values)),
        "worst": float(np.max(values)),
    }
