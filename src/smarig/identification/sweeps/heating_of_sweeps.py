"""The heating of a wire from its sweeps: τ, R_M, R_A and, with a second source, R/hA; and runs with its inputs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from smarig.core import Array, DataError, spaced
from smarig.identification.calibration.calibrate import calibrated
from smarig.identification.calibration.resistance import resistances
from smarig.identification.interval_estimate import Estimate
from smarig.identification.positive.adapted_partition import nodes_along
from smarig.identification.positive.observations import MIN_REVERSAL, branches
from smarig.identification.sweeps.gain_of_sweeps import gain_of_sweeps
from smarig.identification.sweeps.lag_problem import apart
from smarig.identification.sweeps.sweep_record import SweepRecord, is_sweep_run
from smarig.identification.sweeps.tau_of_sweeps import MISFIT, SweptTau, tau_of_sweeps
from smarig.plant import Actuator
from smarig.preisach import Everett
from smarig.record import Run
from smarig.replay import ActuatorRecord, Model, memory_histories

INTERVALS = 50  # of the triangle of a positive measure
_SECTIONS = ("wire", "heating", "transmission")


@dataclass(frozen=True, eq=False)
class HeatingOfSweeps:
    """Constants by name (tau, latent_heat, R_M, R_A, R_over_hA), reasons for others, and the fit of ``tau``."""

    swept: SweptTau
    parameters: dict[str, Estimate]
    not_available: dict[str, str]
    actuator: Actuator
    unit: str

    @property
    def tau_s(self) -> float:
        """The time constant; with latent heat, that without transformation at half the largest input."""
        return self.swept.tau.value

    @property
    def lack_of_fit(self) -> float:
        """Residual rms of the block means over that of the noise alone: 1 if a Preisach model follows the sweeps."""
        return self.swept.rms / self.swept.noise if self.swept.noise else float("nan")

    def to_json(self) -> dict[str, Any]:
        """Plain values: ``fit["heating"]`` of the model file."""
        swept = self.swept
        return {
            "parameters": {name: estimate.to_json() for name, estimate in self.parameters.items()},
            "not_available": dict(self.not_available),
            "blocks": swept.blocks,
            "sweeps": swept.sweeps,
            "rate_ratio": swept.rate_ratio,
            "rms": swept.rms,
            "noise": swept.noise,
            "lack_of_fit": self.lack_of_fit if np.isfinite(self.lack_of_fit) else None,
            **({} if swept.heat.is_constant_tau else self._law()),
        }

    def _law(self) -> dict[str, Any]:
        """What the law of the heating contains beyond τ."""
        heat = self.swept.heat
        return {
            "latent_K_per_unit": heat.latent_K_per_unit,
            "convection_exponent": heat.exponent,
            "heats_by": "current" if heat.resistances_ohm is None else "electrical power",
            "rms_constant_tau": self.swept.constant_rms,
        }

    @property
    def warnings(self) -> list[str]:
        """What a reader must know before he trusts τ."""
        found = [] if self.swept.latent is None else [self._of_latent_heat()]
        if not self.lack_of_fit > MISFIT:
            return found
        law = "a constant τ" if self.swept.latent is None else "latent heat"
        return [
            *found,
            f"The best Preisach model with {law} leaves {self.swept.rms:.3g}{spaced(self.unit)} of the sweeps "
            f"unexplained, {self.lack_of_fit:.2g} times their noise. The intervals of the heating include this, but τ "
            "may stand for another effect. Diagnose settled runs, or verify the model on one.",
        ]

    def _of_latent_heat(self) -> str:
        swept = self.swept
        return (
            f"A constant τ leaves {swept.constant_rms:.3g}{spaced(self.unit)} of the major loop unexplained. "
            f"Latent heat and an exponent {swept.heat.exponent:.3f} of the free convection leave "
            f"{swept.major_rms:.3g}{spaced(self.unit)}. τ is that without transformation at half the largest input. "
            "Predictions between settled points use τ alone."
        )

    def model(self, model: Model) -> Model:
        """The model with these constants of its wire, and with the estimates in ``fit["heating"]``.

        R/hA stays that of the actuator: the model's inputs are in the kelvin of the record.
        """
        kept = {name: e for name, e in self.parameters.items() if name in ("tau", "R_M", "R_A")}
        file = calibrated(self.actuator.file, kept, self.actuator.name)
        constants = {key: getattr(file, key).model_dump(mode="json") for key in _SECTIONS}
        return replace(
            model,
            actuator=ActuatorRecord(name=model.actuator.name, parameters=constants),
            fit={**model.fit, "heating": self.to_json()},
            warnings=(*self.warnings, *model.warnings),
        )

    @property
    def text(self) -> str:
        """One line for each constant."""
        lines = [f"{name} = {estimate}" for name, estimate in self.parameters.items()]
        return "\n".join([*lines, *(f"{name}: {why}" for name, why in self.not_available.items())])


def heating_of_sweeps(runs: Sequence[Run], reference: Everett | None = None) -> HeatingOfSweeps | None:
    """The heating from those runs that were made in sweeps, None if none was.

    Raises DataError with the reason if they do not determine τ.
    """
    records = [SweepRecord.of(run) for run in runs if is_sweep_run(run)]
    if not records:
        return None
    if len({record.actuator.name for record in records}) > 1:
        raise DataError("The runs of sweeps were made with different actuators. Identify them separately.")
    swept = tau_of_sweeps(records)
    records = [replace(record, heat=swept.heat) for record in records]
    found: dict[str, Estimate | str] = {
        "tau": swept.tau,
        **({} if swept.latent is None else {"latent_heat": swept.latent}),
        "R_over_hA": gain_of_sweeps(records, swept.tau.value, reference),
        **resistances([record.run for record in records], swept.tau.value),
    }
    return HeatingOfSweeps(
        swept=swept,
        parameters={name: x for name, x in found.items() if isinstance(x, Estimate)},
        not_available={name: x for name, x in found.items() if isinstance(x, str)},
        actuator=records[0].actuator,
        unit=records[0].run.unit,
    )


def with_fitted_inputs(runs: Sequence[Run], heating: HeatingOfSweeps) -> list[Run]:
    """The runs; one made in sweeps as its block means and turning points, with the input that the fitted τ gives."""
    return [
        _as_points(replace(SweepRecord.of(run), heat=heating.swept.heat), heating.tau_s)
        if is_sweep_run(run)
        else run
        for run in runs
    ]


def sweep_nodes(runs: Sequence[Run]) -> Array | None:
    """Nodes of a measure for the points of runs, dense where the output moves; None if none was made in sweeps."""
    if not any(is_sweep_run(run) for run in runs):
        return None
    lower, upper, records = memory_histories(runs)
    parts, first = [], 0
    for record in records:
        branch = branches(record.inputs, MIN_REVERSAL * (upper - lower))
        parts.append((record.inputs, record.outputs, branch + first))
        first += int(branch.max(initial=0)) + 1
    inputs, outputs, number = (np.concatenate(columns) for columns in zip(*parts))
    nodes = nodes_along(inputs, outputs, number, INTERVALS)
    return apart(np.concatenate([[lower, upper], nodes]))  # cells of no width would spoil the fit


def _as_points(record: SweepRecord, tau_s: float) -> Run:
    inputs, sample, block = record.path(tau_s)
    rows = np.round(sample).astype(np.int64)
    means = np.append(record.means(record.position), np.nan)  # block −1: a turning point, read once
    position = np.where(block >= 0, means[block], record.position[rows])
    columns = {name: values[record.first + rows] for name, values in record.run.columns.items()}
    columns |= {"input": inputs, "position": position}
    keep = (block >= 0) | record.valid[rows]
    return replace(
        record.run.with_meta(initial="negative"),
        columns={name: values[keep] for name, values in columns.items()},
        steps=(),
    )
