"""The observer along recorded runs: its errors against the encoder, the coverage of its intervals, ambiguous spans.

What self-sensing has found, in words: the map of each wire, and where the resistance tells no position.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.control import AMBIGUOUS_SHARE, PositionObserver, ResistanceMap, SelfSensing, is_ambiguous
from smarig.core import Array, UsageError, root_mean_square
from smarig.identification.sensing.sensed_run import SensedRun, sensed_run, sensing_actuator
from smarig.record import Run
from smarig.replay import Model


@dataclass(frozen=True, eq=False)
class SensingErrors:
    """One run: the measured position, that of the observer with half of its interval, (n,) each.

    ``predicted`` is the model without resistance; ``reading`` and ``reading_half`` are those of the resistance of each
    tick alone, NaN and infinite without one.
    """

    run: str
    unit: str
    stroke: float
    measured: Array
    observed: Array
    half: Array
    predicted: Array
    reading: Array
    reading_half: Array

    @property
    def ambiguous(self) -> NDArray[np.bool_]:
        """Where the resistance of a tick does not tell its position, (n,); also without a reading."""
        return is_ambiguous(self.reading_half, self.stroke)

    @property
    def error_over_half(self) -> Array:
        """|error| over half of the interval, (n,)."""
        return np.abs(self.observed - self.measured) / self.half

    @property
    def reading_over_half(self) -> Array:
        """|error| over half of the interval of the readings alone, (m,), where there is one."""
        read = np.isfinite(self.reading)
        return (np.abs(self.reading - self.measured) / self.reading_half)[read]

    def widened(self, factor: float, reading_factor: float) -> "SensingErrors":
        """With wider intervals of the observer and of single readings."""
        return replace(self, half=self.half * factor, reading_half=self.reading_half * reading_factor)

    def to_json(self) -> dict[str, Any]:
        """Errors in the unit of position; shares of the samples."""
        error = self.observed - self.measured
        read = np.isfinite(self.reading)
        clear = read & ~self.ambiguous
        found = {
            "run": self.run,
            "n": error.size,
            "rms": _rms(error),
            "rms_of_stroke": (_rms(error) or 0.0) / self.stroke,
            "max_abs": float(np.abs(error).max()),
            "r_squared": 1.0 - float(np.var(error) / np.var(self.measured))
            if np.ptp(self.measured)
            else None,
            "coverage_95": float(np.mean(self.error_over_half <= 1)),
            "median_half": float(np.median(self.half)),
            "model_alone_rms": _rms(self.predicted - self.measured),
            "resistance_alone_rms": _rms((self.reading - self.measured)[clear]),
        }
        return found | {
            "readings": int(read.sum()),
            "no_reading": float(np.mean(~read)),
            "ambiguous": float(np.mean(self.ambiguous & read)),
        }

    @property
    def text(self) -> str:
        """The result in a sentence."""
        f, unit = self.to_json(), self.unit
        alone = f["resistance_alone_rms"]
        return (
            f"{self.run}: position from resistance and model, rms error {f['rms']:.3g} {unit} "
            f"({100 * f['rms_of_stroke']:.2f} % of the stroke), largest {f['max_abs']:.3g} {unit}; "
            f"{100 * f['coverage_95']:.1f} % of the samples are within the 95 % interval (median "
            f"±{f['median_half']:.2g} {unit}), n = {f['n']}. The model alone: rms "
            f"{f['model_alone_rms']:.3g} {unit}; the resistance alone, where it is not ambiguous: "
            f"{'none' if alone is None else f'rms {alone:.3g} {unit}'}. "
            f"Ambiguous: {100 * f['ambiguous']:.1f} % of the samples; no reading: {100 * f['no_reading']:.1f} %."
        )


def sensing_errors(model: Model, runs: Sequence[Run]) -> list[SensingErrors]:
    """The observer of a model along runs. Raises UsageError if the model has no part ``self_sensing``."""
    if not model.self_sensing:
        raise UsageError(
            f"Model '{model.name}' has no self-sensing. Identify it with smarig sense MODEL RUN… -o NEW.model.json."
        )
    sensing = SelfSensing.from_json(model.self_sensing)
    return errors_along(model, sensing, [sensed_run(model, run) for run in runs])


def errors_along(model: Model, sensing: SelfSensing, runs: Sequence[SensedRun]) -> list[SensingErrors]:
    """The observer along prepared runs."""
    found = []
    for run in runs:
        observer = PositionObserver(
            sensing, sensing_actuator(model), model.hysteresis, run.initial, run.period_s
        )
        rows = np.array(
            [observer.step(v, i)[:5] for v, i in zip(run.voltage_V.tolist(), run.current_A.tolist())]
        )
        position, half, predicted, reading, reading_half = rows.T
        known = np.isfinite(run.position)
        found.append(
            SensingErrors(
                run.name,
                model.unit,
                sensing.stroke,
                run.position[known],
                position[known],
                half[known],
                predicted[known],
                reading[known],
                reading_half[known],
            )
        )
    return found


def _rms(error: Array) -> float | None:
    return root_mean_square(error) if error.size else None


_UNITS = {
    "1": "ohm",
    "y": "ohm/{}",
    "T": "ohm/K",
    "yT": "ohm/({} K)",
    "xi": "ohm",
    "xiy": "ohm/{}",
    "m": "ohm/{}",
}


def sensing_text(sensing: SelfSensing, unit: str) -> list[str]:
    """A line for each wire and one for the observer."""
    lines = [_map_text(k, wire, sensing, unit) for k, wire in enumerate(sensing.wires, start=1)]
    return [
        *lines,
        f"The noise of a reading is {1e3 * sensing.noise_V:.2g} mV. A reading needs at least {sensing.least_A:.2g} A. "
        f"It is ambiguous where its 99.7 % interval is wider than ±{100 * AMBIGUOUS_SHARE:.0f} % of the stroke. "
        f"Intervals are widened by {sensing.interval_factor:.2f}, those of single readings by "
        f"{sensing.reading_factor:.2f}.",
    ]


def _map_text(number: int, wire: ResistanceMap, sensing: SelfSensing, unit: str) -> str:
    values = ", ".join(
        f"{name}: {value:.5g} {_UNITS[name].format(unit)} ({_ends(wire, name)})"
        for name, value in wire.coefficients.items()
    )
    which = f"Wire {number}: " if len(sensing.wires) > 1 else ""
    return (
        f"{which}R by its terms (95 %): {values}; error of the map {1e3 * wire.error_ohm:.2g} mohm, n = {wire.n}. "
        f"{_sign_text(wire, len(sensing.wires) > 1)}"
    )


def _ends(wire: ResistanceMap, name: str) -> str:
    low, high = wire.intervals.get(name, (float("nan"), float("nan")))
    return f"{low:.5g} to {high:.5g}"


def _sign_text(wire: ResistanceMap, two_wire: bool) -> str:
    """Whether resistance changes with position itself, by the sign of its slope at zero temperature and phase."""
    low, high = wire.intervals.get("y", (float("nan"), float("nan")))
    if low > 0 or high < 0:
        return f"The resistance of the cold wire {'rises' if low > 0 else 'falls'} with the position."
    if two_wire:
        return (
            "The resistance does not depend on the position itself, only on the phase of this wire: it shows the "
            "position only while this wire transforms."
        )
    return "The resistance of the cold wire does not depend on the position."
