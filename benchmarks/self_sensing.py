"""Position from resistance: regulation without an encoder, intervals and ambiguous spans, on four rigs.

Each rig is commissioned with its encoder: first_order_descending for the hysteresis, and for the resistance also
validation, continuous_reversal_curves and one regulation. Then, for each seed, a set-point is held twice, with the
encoder and with the resistance, and random currents are applied for five minutes. The R/hA of a Preisach twin differs
by up to 3 % from that of the commissioning; a thermomechanical wire is no Preisach operator anyway. The encoder's
readings and the twin's own position are the truth.

Two truths show where a resistance is ambiguous. ``missed``: the position from the resistance of a tick alone misses
the twin's by more than a tenth of the stroke. ``same_ohm``: of five twins with the same currents and ambient
temperatures up to 10 K apart, two have resistances that a reading cannot separate and positions more than a fifth of
the stroke apart; this uses the twin's physics alone, not the model.
"""

from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.fast_curves import HiddenHeating
from smarig.app import ModelSource, regulation
from smarig.config import RigFile, load_rig
from smarig.control import AMBIGUOUS_SHARE, PositionObserver, SelfSensing
from smarig.core import LimitExceeded
from smarig.identification import identify, identify_sensing
from smarig.plant import Actuator
from smarig.record import Run, load_run
from smarig.replay import Model
from smarig.report import closed_loop_result
from smarig.rig import Twin, TwinSettings, plant_of
from smarig.runner import Preview, Session

Array = NDArray[np.float64]
SURFACES = {
    "one_wire_twin": "best",
    "two_wire_twin": "best",
    "one_wire_thermomechanical": "best",
    "two_wire_thermomechanical": "positive",
}
SEEDS, HOLD_S, STEADY_S, PATH_S = 20, 180.0, 60.0, 300.0
STARTS = ("diagonal", "ascending", "descending", "ascending")  # of the loops, in turn
WITHIN = 0.05  # of the plane: the distance from B_ℓ that the approach may leave
WANTED_DETECTED = 0.95
GAIN = 0.03  # of R/hA
EXPECTED = Preview("regulate", 3600.0, 4, 1.0, 180.0, 0, 4_000_000)  # a preview would take as long as the run
OFFSETS_K = (-10.0, -5.0, 5.0, 10.0)
SAME_OHM = 1.96 * 2**0.5  # standard deviations of a reading: two readings that differ by less may be equal


@dataclass(frozen=True)
class CommissionedRig:
    """A rig, and the model that its commissioning gave."""

    file: RigFile
    actuator: Actuator
    model: Model
    path: Path

    @property
    def sensing(self) -> SelfSensing:
        """The self-sensing of the model."""
        return SelfSensing.from_json(self.model.self_sensing)

    @property
    def preisach(self) -> bool:
        """Whether the wire is a Preisach operator."""
        return self.actuator.file.thermomechanical is None

    def twin(self, seed: int) -> TwinSettings:
        """The wire of a seed."""
        gain = float(np.random.default_rng([seed, 118]).uniform(1 - GAIN, 1 + GAIN))
        return TwinSettings(seed=seed, effects=(HiddenHeating(1.0, gain),) if self.preisach else ())


def run(quick: bool = False) -> dict[str, Any]:
    """``{RIG: {"unit", "stroke", "seeds", "encoder", "resistance", "path", "results"}}``; see ``rig_result``.

    ``quick`` takes one seed of the one-wire twin.
    """
    with TemporaryDirectory() as folder:
        rigs = list(SURFACES)[:1] if quick else list(SURFACES)
        return {rig: rig_result(rig, Path(folder), 1 if quick else SEEDS) for rig in rigs}


def rig_result(rig: str, folder: Path, seeds: int = SEEDS) -> dict[str, Any]:
    """The figures of one rig.

    ``encoder`` and ``resistance``: rms over the seeds of the error in the last minute, and the worst mean error of that
    minute, in the unit and as shares of the stroke; ``tripped`` runs. ``path``: rms error, coverage and ambiguous spans
    under random currents, with detection as a share of the truly ambiguous ticks.
    """
    commissioned = commission(rig, folder)
    results = [_of_seed(commissioned, folder, seed) for seed in range(seeds)]
    stroke = commissioned.sensing.stroke
    found: dict[str, Any] = {"unit": commissioned.model.unit, "stroke": stroke, "seeds": seeds}
    for feedback in ("encoder", "resistance"):
        held = [r[feedback] for r in results if r[feedback] is not None]
        found[feedback] = {"tripped": seeds - len(held)} | (_errors(held, stroke) if held else {})
    covered = [r["resistance"]["coverage_95"] for r in results if r["resistance"] is not None]
    found["resistance"]["coverage_95"] = float(np.mean(covered)) if covered else None
    found["path"] = _pooled([r["path"] for r in results], stroke)
    return found | {"results": results}


def _errors(held: list[dict[str, float]], stroke: float) -> dict[str, float]:
    rms = float(np.sqrt(np.mean([h["rms"] ** 2 for h in held])))
    worst = max(abs(h["steady"]) for h in held)
    return {"rms": rms, "worst": worst, "rms_of_stroke": rms / stroke, "worst_of_stroke": worst / stroke}


def commission(rig: str, folder: Path) -> CommissionedRig:
    """Identify the hysteresis and the resistance of a rig that has an encoder."""
    file = load_rig(rig)
    curves = _recorded(rig, "first_order_descending", folder, 101)
    plain = identify([curves], surface=SURFACES[rig]).model
    path = folder / f"{rig}.model.json"
    plain.save(path, force=True)
    others = [
        _recorded(rig, name, folder, seed)
        for name, seed in (("validation", 102), ("continuous_reversal_curves", 104))
    ]
    regulated = _regulated(rig, path, _setpoint(plain, 0.55), TwinSettings(seed=103), "encoder", folder)
    if regulated is None:
        raise LimitExceeded(f"The commissioning of {rig} tripped.")
    sensing, _ = identify_sensing(plain, [curves, *others, regulated])
    model = replace(plain, self_sensing=sensing.to_json())
    model.save(path, force=True)
    return CommissionedRig(file, Actuator.named(file.actuator), model, path)


def _recorded(rig: str, protocol: str, folder: Path, seed: int) -> Run:
    with Session(rig, seed=seed) as session:
        return load_run(session.run(protocol, {}, folder / f"{rig}_{protocol}.run.sqlite", force=True))


def _setpoint(model: Model, share: float) -> float:
    h = model.hysteresis
    return h.y_lower + share * h.everett(h.upper, h.lower)


def _regulated(
    rig: str,
    model: Path,
    setpoint: float,
    twin: TwinSettings,
    feedback: str,
    folder: Path,
    start: str = "diagonal",
) -> Run | None:
    """A run that holds a set-point; None if it tripped."""
    loop = regulation(
        ModelSource.of(model),
        load_rig(rig),
        setpoint,
        within=WITHIN,
        hold_s=HOLD_S,
        start=start,
        feedback=feedback,
    )
    out = folder / f"{rig}_{feedback}.run.sqlite"
    with Session(rig, twin=twin) as session:
        try:
            session.run(
                loop.protocol,
                loop.settings,
                out,
                force=True,
                expected=EXPECTED,
                protocol_factory=loop.make,
            )
        except LimitExceeded:
            return None
    return load_run(out)


def _of_seed(rig: CommissionedRig, folder: Path, seed: int) -> dict[str, Any]:
    share = float(np.random.default_rng([seed, 119]).uniform(0.15, 0.85))
    setpoint = _setpoint(rig.model, share)
    found: dict[str, Any] = {"seed": seed, "setpoint": setpoint}
    for feedback in ("encoder", "resistance"):
        start = STARTS[seed % len(STARTS)]
        run_ = _regulated(rig.file.name, rig.path, setpoint, rig.twin(seed), feedback, folder, start)
        found[feedback] = None if run_ is None else _held(run_)
    return found | {"path": _path(rig, seed)}


def _held(run_: Run) -> dict[str, Any]:
    """The error by the encoder in the last minute of the hold, and what the observer says of itself."""
    result = closed_loop_result(run_)
    loop = result.loop if result is not None else None
    if loop is None:
        raise LimitExceeded("The loop of a regulation was never closed.")
    error = (loop.position - loop.wanted)[loop.t_s >= loop.t_s[-1] - STEADY_S]
    observed = getattr(result, "observed", None)
    own = observed.to_json() if observed is not None else {}
    kept = ("coverage_95", "observer_rms", "median_half", "ambiguous")
    return {"rms": float(np.sqrt(np.mean(error**2))), "steady": float(np.mean(error))} | {
        name: own[name] for name in kept if name in own
    }


# --- random currents ---------------------------------------------------------------------------------


def _currents(rig: CommissionedRig, seed: int) -> Array:
    """Holds of 5 to 40 s at random currents, one in ten at zero."""
    rng = np.random.default_rng([seed, 120])
    limits, found, n = rig.file.limits, [], round(PATH_S / rig.file.period_s)
    while len(found) < n:
        current_A = 0.0 if rng.random() < 0.1 else rng.uniform(limits.current_min_A, limits.current_max_A)
        found += [current_A] * round(rng.uniform(5.0, 40.0) / rig.file.period_s)
    return np.array(found[:n])


def _path(rig: CommissionedRig, seed: int) -> dict[str, Any]:
    """The observer under random currents against the twin's own position, resistance, and those of its family."""
    settings = rig.twin(seed)
    twin = Twin(rig.file, rig.actuator, settings)
    family = [plant_of(rig.file, rig.actuator, settings) for _ in OFFSETS_K]
    plant = twin.specimen.plant
    start = plant.position
    initial = "anhysteretic" if rig.actuator.two_wire else "negative"
    observer = PositionObserver(rig.sensing, rig.actuator, rig.model.hysteresis, initial, rig.file.period_s)
    rows, observed = [], []
    for current_A in _currents(rig, seed).tolist():
        sample = twin.step(current_A)[0]
        for member, offset_K in zip(family, OFFSETS_K):
            member.step(twin.output_A, offset_K)
        members = [plant, *family]
        rows.append(
            (
                twin.output_A,
                *(m.position - start for m in members),
                *(m.resistance_ohm(twin.output_A) for m in members),
            )
        )
        observed.append(observer.step(sample.voltage_V, sample.current_A))
    return _path_figures(rig, np.array(rows), np.array(observed))


def _path_figures(rig: CommissionedRig, rows: Array, observed: Array) -> dict[str, Any]:
    k, stroke = len(OFFSETS_K) + 1, rig.sensing.stroke
    current, positions, ohms = rows[:, 0], rows[:, 1 : 1 + k], rows[:, 1 + k :]
    position, half, predicted, reading, _, flagged = observed[:, :6].T
    read = np.isfinite(reading)
    noise = rig.file.amplifier.voltage_noise_V, rig.file.amplifier.current_noise_A
    with np.errstate(divide="ignore"):
        sd_ohm = np.hypot(noise[0], ohms[:, 0] * noise[1]) / np.abs(current)
    same = np.zeros(current.size, dtype=bool)
    for a, b in combinations(range(k), 2):
        equal = np.abs(ohms[:, a] - ohms[:, b]) < SAME_OHM * sd_ohm
        same |= equal & (np.abs(positions[:, a] - positions[:, b]) > 2 * AMBIGUOUS_SHARE * stroke)
    missed = np.abs(reading - positions[:, 0]) > AMBIGUOUS_SHARE * stroke
    error = position - positions[:, 0]
    return {
        "n": current.size,
        "square": float(np.sum(error**2)),
        "model_alone_square": float(np.sum((predicted - positions[:, 0]) ** 2)),
        "largest": float(np.abs(error).max()),
        "covered": int(np.sum(np.abs(error) <= half)),
        "confidently_wrong": int(np.sum((np.abs(error) > half) & (np.abs(error) > AMBIGUOUS_SHARE * stroke))),
        "read": int(read.sum()),
        "flagged": int(np.sum(read & (flagged > 0))),
        "same_ohm": int(np.sum(read & same)),
        "same_ohm_flagged": int(np.sum(read & same & (flagged > 0))),
        "missed": int(np.sum(read & missed)),
        "missed_flagged": int(np.sum(read & missed & (flagged > 0))),
        "either": int(np.sum(read & (missed | same))),
        "either_flagged": int(np.sum(read & (missed | same) & (flagged > 0))),
    }


def _pooled(paths: list[dict[str, Any]], stroke: float) -> dict[str, Any]:
    total = {name: sum(p[name] for p in paths) for name in paths[0]}
    n, read = total["n"], total["read"]
    rms = float(np.sqrt(total["square"] / n))

    def share(part: str, whole: str) -> float | None:
        return total[part] / total[whole] if total[whole] else None

    return {
        "rms": rms,
        "rms_of_stroke": rms / stroke,
        "model_alone_rms": float(np.sqrt(total["model_alone_square"] / n)),
        "largest": max(p["largest"] for p in paths),
        "coverage_95": total["covered"] / n,
        "worst_coverage_95": min(p["covered"] / p["n"] for p in paths),
        "confidently_wrong": total["confidently_wrong"] / n,
        "no_reading": 1 - read / n,
        "flagged": share("flagged", "read"),
        "flagged_without_cause": (total["flagged"] - total["either_flagged"]) / read,
        "truly_ambiguous": share("either", "read"),
        "detected": share("either_flagged", "either"),
        "detected_same_ohm": share("same_ohm_flagged", "same_ohm"),
        "detected_missed": share("missed_flagged", "missed"),
        "missed_unflagged": (total["missed"] - total["missed_flagged"]) / read,
    }
