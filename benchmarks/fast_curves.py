"""Rig time saved by continuous reversal curves at two rates, against the settled protocol; τ and R/hA are hidden.

Ten wires: surfaces of Table 5.1, and random truths outside every family (``random_truths``). Their τ is 0.6 to 1.6 of
the actuator's, their R/hA within 10 % of it, and the record knows neither. ``first_order_descending`` waits at every
point, ``continuous_reversal_curves`` at none. Both are identified by default settings; for the settled run the better
of "best" and "positive" counts. The errors are those of ``verify`` on a run of settled random holds; below a tenth of
an encoder count they count as equal.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from benchmarks.random_truths import random_truth
from smarig.identification import Identification, identify, verify
from smarig.plant import Actuator, EffectContext, Hook, Stage
from smarig.preisach import Everett, thesis_surface
from smarig.record import Run, load_run
from smarig.rig import TwinSettings
from smarig.runner import Preview, Session

WANTED_SHARE, WANTED_TAU_PERCENT = 0.20, 3.0
EQUAL_COUNTS = 0.1  # rms: smaller errors of two models are equal for this encoder
POINTS = 40  # of a validation run
LONGER = {"curves": 25}  # where the default settings do not reach the error of the settled run
WIRES = (
    ("one_wire_twin", "one_c"),
    ("one_wire_twin", "one_p"),
    ("one_wire_twin", "one_e"),
    ("two_wire_twin", "two_c"),
    ("two_wire_twin", "two_e"),
    *(("one_wire_twin", seed) for seed in range(4)),
    ("two_wire_twin", 4),
)


@dataclass(frozen=True)
class HiddenHeating:
    """A wire whose τ and R/hA are these factors times the actuator's."""

    tau: float
    gain: float

    def hooks(self, context: EffectContext) -> Mapping[Stage, Hook]:
        """Factors on the lag and on the source."""
        del context
        return {
            Stage.LAG: lambda lag, _now: lag * self.tau,
            Stage.SOURCE: lambda source, _now: source * self.gain,
        }


@dataclass(frozen=True)
class ComparedWire:
    """One wire of the comparison."""

    number: int
    rig: str
    name: str
    hysteresis: Everett
    heating: HiddenHeating


def run(quick: bool = False) -> dict[str, Any]:
    """Share of the settled protocol's rig time at equal validation error, and the error of τ.

    ``{"wires", "wanted_share", "median_share", "worst_share", "reached", "strictly_better", "default_share",
    "median_counts", "wanted_tau_percent", "median_tau_percent", "worst_tau_percent", "tau_in_interval",
    "results": [{"wire", "rig", "tau_factor", "gain_factor", "settled_h", "settled_counts", "fast_h",
    "fast_counts", "surface", "share", "tau_percent", "tau_inside", "tau_half_percent", "lack_of_fit"}]}``.
    ``share`` belongs to the first settings (default, then more curves) whose error is at or below that of the
    settled run (or ``EQUAL_COUNTS``), None if neither reaches it; medians count this as more than 1. ``fast_…`` are
    those of the default settings. ``quick`` takes two wires.
    """
    numbers = (1, 5) if quick else range(len(WIRES))
    with TemporaryDirectory() as folder:
        results = [_compared(_wire(number), Path(folder)) for number in numbers]
    shares = [np.inf if r["share"] is None else r["share"] for r in results]
    taus = [abs(r["tau_percent"]) for r in results]
    return {
        "wires": len(results),
        "wanted_share": WANTED_SHARE,
        "median_share": _finite(np.median(shares)),
        "worst_share": _finite(max(shares)),
        "reached": sum(r["share"] is not None for r in results),
        "strictly_better": sum(r["fast_counts"] <= r["settled_counts"] for r in results),
        "default_share": float(np.median([r["fast_h"] / r["settled_h"] for r in results])),
        "median_counts": {
            k: float(np.median([r[f"{k}_counts"] for r in results])) for k in ("settled", "fast")
        },
        "wanted_tau_percent": WANTED_TAU_PERCENT,
        "median_tau_percent": float(np.median(taus)),
        "worst_tau_percent": float(max(taus)),
        "tau_in_interval": sum(r["tau_inside"] for r in results),
        "results": results,
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _wire(number: int) -> ComparedWire:
    rig, truth = WIRES[number]
    rng = np.random.default_rng([number, 2026])
    heating = HiddenHeating(float(rng.uniform(0.6, 1.6)), float(rng.uniform(0.9, 1.1)))
    hysteresis = thesis_surface(truth) if isinstance(truth, str) else random_truth(truth, rig)
    return ComparedWire(
        number, rig, truth if isinstance(truth, str) else f"random {truth}", hysteresis, heating
    )


def _compared(wire: ComparedWire, folder: Path) -> dict[str, Any]:
    settled = _measured(wire, "first_order_descending", {}, folder / f"settled_{wire.number}.run.sqlite")
    held = _measured(
        wire,
        "validation",
        {"points": POINTS, "seed": 100 + wire.number},
        folder / f"held_{wire.number}.run.sqlite",
    )
    settled_counts = min(_counts(identify(settled, kind), held) for kind in ("best", "positive"))
    share, found = None, None
    for k, settings in enumerate(({}, LONGER)):
        fast = _measured(
            wire, "continuous_reversal_curves", settings, folder / f"fast_{wire.number}_{k}.run.sqlite"
        )
        result = identify(fast)
        counts = _counts(result, held)
        found = found or (fast, result, counts)
        if counts <= max(settled_counts, EQUAL_COUNTS):
            share = fast.span_s / settled.span_s
            break
    fast, result, counts = found or (settled, identify(settled), settled_counts)
    return {
        "wire": wire.name,
        "rig": wire.rig,
        "tau_factor": wire.heating.tau,
        "gain_factor": wire.heating.gain,
        "settled_h": settled.span_s / 3600,
        "settled_counts": settled_counts,
        "fast_h": fast.span_s / 3600,
        "fast_counts": counts,
        "surface": result.surface,
        "share": share,
        **_tau_error(wire, result),
    }


def _tau_error(wire: ComparedWire, result: Identification) -> dict[str, Any]:
    if result.heating is None:
        raise AssertionError("A run of sweeps was not recognised.")
    true_s = (
        Actuator.named("gorbet_one_wire" if "one" in wire.rig else "gorbet_two_wire").tau_s * wire.heating.tau
    )
    tau = result.heating.parameters["tau"]
    return {
        "tau_percent": 100 * (tau.value / true_s - 1),
        "tau_inside": tau.ci95[0] <= true_s <= tau.ci95[1],
        "tau_half_percent": 50 * (tau.ci95[1] - tau.ci95[0]) / tau.value,
        "lack_of_fit": result.heating.lack_of_fit,
    }


def _counts(result: Identification, held: Run) -> float:
    return verify(result.model, held).runs[0].settled.rms / held.info.output.resolution


def _measured(wire: ComparedWire, protocol: str, settings: dict[str, Any], out: Path) -> Run:
    twin = TwinSettings(
        seed=10 * wire.number + len(protocol), hysteresis=wire.hysteresis, effects=(wire.heating,)
    )
    no_preview = Preview(protocol, 0.0, 0, 0.0, 0.0, 0, 0)  # a twin needs no preview
    with Session(wire.rig, twin=twin, wire=f"wire {wire.number} of the benchmark") as session:
        return load_run(session.run(protocol, settings, out, expected=no_preview))
