"""Rig time saved by continuous reversal curves at two rates, against the settled protocol; τ and R/hA are hidden.

Three groups of ten wires. The first has surfaces of Table 5.1 and random truths outside every family
(``random_truths``), with a τ of 0.6 to 1.6 of the actuator's and R/hA within 10 % of it; settings of the estimator were
chosen on them. The second has random truths and heatings on which none was chosen. The third are thermomechanical wires
(``thermomechanical_wires``): their τ is m c/(h A) without transformation at half the largest steady input.
``first_order_descending`` waits at every point, ``continuous_reversal_curves`` at the lower end. Both are identified
by default settings; for the settled run the better of "best" and "positive" counts. The errors are those of ``verify``
on a run of settled random holds; below a tenth of an encoder count they count as equal.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from benchmarks.random_truths import random_truth
from benchmarks.thermomechanical_wires import NAMED, middle_tau_s, random_wire
from smarig.identification import Identification, identify, verify
from smarig.plant import EffectContext, Hook, Stage
from smarig.preisach import Everett, thesis_surface
from smarig.protocols import Setup
from smarig.record import Run, load_run
from smarig.rig import TwinSettings
from smarig.runner import Preview, Session

WANTED_SHARE, WANTED_TAU_PERCENT = 0.20, 3.0
THERMOMECHANICAL = 10
EQUAL_COUNTS = 0.1  # rms: smaller errors of two models are equal for this encoder
POINTS = 40  # of a validation run
LONGER = {"curves": 20}  # where the default settings do not reach the error of the settled run
WIRES = (
    ("one_wire_twin", "one_c"),
    ("one_wire_twin", "one_p"),
    ("one_wire_twin", "one_e"),
    ("two_wire_twin", "two_c"),
    ("two_wire_twin", "two_e"),
    *(("one_wire_twin", seed) for seed in range(4)),
    ("two_wire_twin", 4),
)
HELD_BACK = tuple(  # random hystereses and heatings on which no setting of the estimator was chosen
    ("two_wire_twin" if seed % 3 == 2 else "one_wire_twin", seed) for seed in range(100, 110)
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
    true_tau_s: float
    hysteresis: Everett | None = None
    heating: HiddenHeating | None = None


def run(quick: bool = False) -> dict[str, Any]:
    """Share of the settled protocol's rig time at equal validation error, and the error of τ, of each group.

    ``{"wanted_share", "wanted_tau_percent", "chosen_on", "held_back", "thermomechanical"}``; each group is
    ``{"wires", "median_share", "worst_share", "reached", "strictly_better", "default_share", "median_counts",
    "median_tau_percent", "worst_tau_percent", "tau_in_interval", "results": [{"wire", "rig", "settled_h",
    "settled_counts", "fast_h", "fast_counts", "surface", "share", "tau_s", "tau_percent", "tau_inside",
    "tau_half_percent", "lack_of_fit", "latent_K"}]}``. ``share`` belongs to the first settings (default, then more
    curves) whose error is at or below that of the settled run (or ``EQUAL_COUNTS``), None if neither reaches it;
    medians count this as more than 1. ``fast_…`` are those of the default settings. ``quick`` takes two wires of the
    first group and one of each other.
    """
    with TemporaryDirectory() as folder:
        path = Path(folder)
        groups: dict[str, list[ComparedWire]] = {
            "chosen_on": [_wire(k) for k in ((1, 5) if quick else range(len(WIRES)))],
            "held_back": [_held_back(k) for k in range(1 if quick else len(HELD_BACK))],
            "thermomechanical": [_thermomechanical(k, path) for k in range(1 if quick else THERMOMECHANICAL)],
        }
        found = {name: _summary([_compared(w, path) for w in wires]) for name, wires in groups.items()}
    return {"wanted_share": WANTED_SHARE, "wanted_tau_percent": WANTED_TAU_PERCENT, **found}


def _summary(results: list[dict[str, Any]]) -> dict[str, Any]:
    shares = [np.inf if r["share"] is None else r["share"] for r in results]
    taus = [abs(r["tau_percent"]) for r in results]
    return {
        "wires": len(results),
        "median_share": _finite(np.median(shares)),
        "worst_share": _finite(max(shares)),
        "reached": sum(r["share"] is not None for r in results),
        "strictly_better": sum(r["fast_counts"] <= r["settled_counts"] for r in results),
        "default_share": float(np.median([r["fast_h"] / r["settled_h"] for r in results])),
        "median_counts": {
            k: float(np.median([r[f"{k}_counts"] for r in results])) for k in ("settled", "fast")
        },
        "median_tau_percent": float(np.median(taus)),
        "worst_tau_percent": float(max(taus)),
        "tau_in_interval": sum(r["tau_inside"] for r in results),
        "results": results,
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _held_back(number: int) -> ComparedWire:
    """τ 0.5 to 2 times the actuator's, as of wires of 0.7 to 1.5 times its diameter; R/hA within 15 %."""
    rig, seed = HELD_BACK[number]
    rng = np.random.default_rng([seed, 2027])
    heating = HiddenHeating(float(np.exp(rng.uniform(-1, 1) * np.log(2))), float(rng.uniform(0.85, 1.15)))
    return ComparedWire(
        seed, rig, f"held-back {seed}", _hidden_tau_s(rig, heating), random_truth(seed, rig), heating
    )


def _thermomechanical(number: int, folder: Path) -> ComparedWire:
    rig = NAMED[number] if number < len(NAMED) else random_wire(number, folder)
    return ComparedWire(
        200 + number, rig, rig if number < len(NAMED) else f"varied {number}", middle_tau_s(rig)
    )


def _hidden_tau_s(rig: str, heating: HiddenHeating) -> float:
    return Setup.of(rig).tau_s * heating.tau


def _wire(number: int) -> ComparedWire:
    rig, truth = WIRES[number]
    rng = np.random.default_rng([number, 2026])
    heating = HiddenHeating(float(rng.uniform(0.6, 1.6)), float(rng.uniform(0.9, 1.1)))
    hysteresis = thesis_surface(truth) if isinstance(truth, str) else random_truth(truth, rig)
    name = truth if isinstance(truth, str) else f"random {truth}"
    return ComparedWire(number, rig, name, _hidden_tau_s(rig, heating), hysteresis, heating)


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
    tau = result.heating.parameters["tau"]
    latent = result.heating.parameters.get("latent_heat")
    return {
        "tau_s": tau.value,
        "tau_percent": 100 * (tau.value / wire.true_tau_s - 1),
        "tau_inside": tau.ci95[0] <= wire.true_tau_s <= tau.ci95[1],
        "tau_half_percent": 50 * (tau.ci95[1] - tau.ci95[0]) / tau.value,
        "lack_of_fit": result.heating.lack_of_fit,
        "latent_K": latent.value if latent else None,
    }


def _counts(result: Identification, held: Run) -> float:
    return verify(result.model, held).runs[0].settled.rms / held.info.output.resolution


def _measured(wire: ComparedWire, protocol: str, settings: dict[str, Any], out: Path) -> Run:
    twin = TwinSettings(
        seed=10 * wire.number + len(protocol),
        hysteresis=wire.hysteresis,
        effects=(wire.heating,) if wire.heating else (),
    )
    no_preview = Preview(protocol, 0.0, 0, 0.0, 0.0, 0, 0)  # a twin needs no preview
    with Session(wire.rig, twin=twin, wire=f"wire {wire.number} of the benchmark") as session:
        return load_run(session.run(protocol, settings, out, expected=no_preview))
