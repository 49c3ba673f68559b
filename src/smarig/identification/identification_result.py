"""The result of an identification: the model and its evidence."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, NotebookDisplay, spaced
from smarig.identification.density_report import DensityReport
from smarig.identification.error_verdict import ErrorLevel, ErrorVerdict, error_verdict
from smarig.identification.extended.choose_extension import ExtensionChoice
from smarig.identification.fod_data import FodData
from smarig.identification.measured.load_dependence import LoadDependence
from smarig.identification.noise_floor import noise_floor, noise_record
from smarig.identification.positive.positive_fit import PositiveFit
from smarig.identification.repeatability import Repeatability
from smarig.identification.rows_used import RowsUsed, early_end_warnings
from smarig.identification.surface.choose_surface import SurfaceChoice
from smarig.identification.surface.curve_report import CurveReport
from smarig.identification.surface.fit_figures import plain
from smarig.identification.surface.surface_fit import SurfaceFit
from smarig.identification.sweeps.heating_of_sweeps import HeatingOfSweeps
from smarig.preisach import Initial
from smarig.record import Run
from smarig.replay import Model, model_metadata, pooled_conditions, provenance

NOT_TESTED = "at the noise floor, but not tested: too few curves to hold one out"


@dataclass(frozen=True, eq=False)
class Identification(NotebookDisplay):
    """A model and the evidence for it. ``surface`` is the kind used.

    ``fit`` is None for tables and for a positive measure, which has ``positive``. ``data`` are the first-order
    curves of the runs. They are empty if the runs of a positive measure contain none; its own points are
    ``model.fit["points"]``. ``choice`` describes the choice of "best", and is None if the kind was named.
    ``extension`` is the result for the extended models of §3.5, None if none was requested. ``rows`` are the rows used
    of each run. ``load`` is the dependence on a load, None if none was requested. ``crossing_note``: a sentence on
    crossing curves of the default twin, "" for all other data. ``heating`` are the constants of the heating from
    continuous sweeps, None without such a run.
    """

    model: Model
    surface: str
    data: FodData
    fit: SurfaceFit | None
    density: DensityReport
    curves: CurveReport
    choice: SurfaceChoice | None
    positive: PositiveFit | None = None
    extension: ExtensionChoice | None = None
    rows: tuple[RowsUsed, ...] = ()
    load: LoadDependence | None = None
    crossing_note: str = ""
    heating: HeatingOfSweeps | None = None

    def predict(self, u: ArrayLike, initial: Initial = "negative") -> Array:
        """Outputs of the model, as ``Model.predict``."""
        return self.model.predict(u, initial)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the model, one or two sentences each."""
        return self.model.warnings

    @property
    def fit_verdict(self) -> ErrorVerdict:
        """How the error of the fit compares with the noise of the readings.

        A positive measure can follow any few points, so it is not judged by them if no curve could be held out.
        """
        hysteresis, rms = self.model.hysteresis, float(self.model.fit["rms"])
        travel = float(np.ptp(self.model.predict([hysteresis.lower, hysteresis.upper])))
        noise = self.model.noise_floor
        repeatability = Repeatability(noise.drift_per_cycle, noise.over_readings)
        found = error_verdict(rms, noise.value, rms / travel if travel else 0.0, repeatability)
        if found.level is ErrorLevel.GOOD and self.positive and not self.positive.held_out.curves:
            return ErrorVerdict(ErrorLevel.UNKNOWN, "", NOT_TESTED)
        return found

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line; errors in ``unit``, μ in unit per squared input unit."""
        model, d, choice = self.model, self.density, self.choice
        values = dict(zip(model.parameters, self.fit.values.tolist())) if self.fit else {}
        intervals = {name: [plain(v) for v in ends] for name, ends in model.intervals.items()}
        share = self.positive.reversible_share if self.positive else d.reversible_share
        return {
            "model": model.name,
            "surface": self.surface,
            "points": model.fit["points"],
            "curves": self.data.curves,
            **{key: model.fit[key] for key in ("rms", "norm2", "weighted_norm2")},
            "mu_min": plain(d.mu_min),
            "mu_max": plain(d.mu_max),
            "classes": {"M_PC": d.M_PC, "M_P": d.M_P},
            "fod_curves_cross": self.curves.cross,
            "unit": model.unit,
            "mu_unit": f"{model.unit}/{model.input.unit}^2",
            "mu_min_at": [plain(v) for v in d.mu_min_at],
            "g_min": plain(d.g_min),
            "reversible_share": plain(share),
            "parameters": {n: {"value": v, "ci95": intervals[n]} for n, v in values.items()},
            "fit": model.fit,
            "mirrored": model.mirrored,
            "range": [self.data.lower, self.data.upper],
            "exercised": self.curves.exercised,
            "noise_floor": model.noise_floor.model_dump(),
            "verdict": self.fit_verdict.level.value,
            "held_out_rms": choice.held_out_rms if choice else None,
            "held_out_interval": choice.held_out_interval if choice else None,
            "negative_share": choice.negative_share if choice else None,
            "twin": model.twin,
            "rows": [rows.to_json() for rows in self.rows],
            "warnings": list(self.warnings),
            **({"crossing_note": self.crossing_note} if self.crossing_note else {}),
            **({"load": self.load.to_json()} if self.load else {}),
            **({"heating": self.heating.to_json()} if self.heating else {}),
            **({"extension": self.extension.to_json()} if self.extension else {}),
        }

    @property
    def text(self) -> str:
        """The surface, its data and its error in a sentence."""
        fit, unit = self.model.fit, spaced(self.model.unit)
        where = f" on {self.data.curves} curves" if self.data.curves else ""
        words = f"{self.surface.capitalize()} surface from {fit['points']} points{where}: "
        words += f"rms error {fit['rms']:.3g}{unit}"
        if self.positive is not None and self.positive.held_out.curves:
            words += f", {self.positive.held_out.rms:.3g}{unit} on held-out curves"
        return f"{words}; {self._sign_of_density}."

    @property
    def _sign_of_density(self) -> str:
        """The sign of the surface's μ, and whether the data contradict it."""
        if not self.density.M_P:
            return "μ < 0 somewhere"
        if self.curves.cross:
            return "its μ ≥ 0 everywhere, although that of the data is not"
        return "μ ≥ 0 everywhere"

    def __repr__(self) -> str:
        d, fit = self.density, self.model.fit
        where = f"on {self.data.curves} curves" if self.data.curves else "without first-order curves"
        held_out = ""
        if self.positive is not None and self.positive.held_out.curves:
            p = self.positive
            held_out = (
                f", {p.held_out.rms:.3g} on held-out curves, "
                f"{p.null_space} of {p.cells} cells left to smoothness"
            )
        return (
            f"Identification({self.surface} from {fit['points']} points {where}: "
            f"rms {fit['rms']:.3g}{spaced(self.model.unit)}{held_out}; {d!r}; {len(self.warnings)} warning(s))"
        )


def model_of_runs(
    words: str,
    given: Sequence[Run],
    used: Sequence[Run],
    warnings: Iterable[str],
    *,
    varied: Collection[str] = (),
    **fields: Any,
) -> Model:
    """The model of runs as they were ``given``, and as they were ``used``; ``words`` follow its wire in its name.

    ``fields``: what was identified. ``varied``: the conditions of the runs that it depends on.
    """
    floor = noise_floor(used)
    return Model(
        name=f"{used[0].info.wire or used[0].name} {words}",
        noise_floor=noise_record(floor),
        provenance=tuple(provenance(run) for run in given),
        twin=any(run.twin for run in used),
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        warnings=(
            *early_end_warnings(given),
            *warnings,
            *floor.warnings,
            *pooled_conditions(used, varied),
        ),
        **fields,
        **model_metadata(used),
    )
