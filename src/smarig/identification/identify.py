"""Runs in, model out (§5.4): find the first-order curves, fit or tabulate them, say what is known of it.

Puts the parts of this folder together. Refuses to know rigs, and judges nothing on validation runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

import numpy as np

from smarig.catalogue import suggestion
from smarig.errors import DataError, UsageError
from smarig.identification.choose import Choice, choose
from smarig.identification.curve_report import CurveReport, curve_report
from smarig.identification.density import DensityReport, density_report
from smarig.identification.fod_data import FORC_PROTOCOL, FodData, fod_data
from smarig.identification.fod_data import select as selected
from smarig.identification.fod_table_data import table
from smarig.identification.forc_curves import curves_from_run
from smarig.identification.model_file import Model, NoiseRecord
from smarig.identification.noise_floor import noise_floor
from smarig.identification.origin import description, file_hash, provenance
from smarig.identification.surface_fit import ROOT_WEIGHT, SurfaceFit, Weights, fit_surface
from smarig.preisach.fod_surface import FORMS, FodSurface
from smarig.preisach.fod_table import FodTable
from smarig.preisach.forc_table import ForcTable
from smarig.preisach.mirrored import Mirrored
from smarig.record import Run, load_run

Kind = Literal["constant", "parabolic", "exponential", "table", "best"]
_BEYOND = 1e30
KINDS: tuple[str, ...] = (*FORMS, "table", "best")


@dataclass(frozen=True, eq=False)
class Identification:
    """A model and the evidence for it. ``surface`` is the kind used, ``fit`` None for tables.

    ``choice`` says how "best" was found, None when the kind was asked for by name.
    """

    model: Model
    surface: str
    data: FodData
    fit: SurfaceFit | None
    density: DensityReport
    curves: CurveReport
    choice: Choice | None

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to know before the model is used, plain sentences."""
        return self.model.warnings

    def to_json(self) -> dict[str, Any]:
        """The CLI's JSON object; figures in ``unit``, μ in unit per squared input unit."""
        model, d = self.model, self.density
        values = dict(zip(model.parameters, self.fit.values.tolist())) if self.fit else {}
        intervals = {name: [_plain(v) for v in ends] for name, ends in model.intervals.items()}
        return {
            "model": model.name,
            "surface": self.surface,
            "points": len(self.data),
            "curves": self.data.curves,
            **{key: model.fit[key] for key in ("rms", "norm2", "weighted_norm2")},
            "mu_min": _plain(d.mu_min),
            "mu_max": _plain(d.mu_max),
            "classes": {"M_PC": d.M_PC, "M_P": d.M_P},
            "fod_curves_cross": self.curves.cross,
            "unit": model.unit,
            "mu_unit": f"{model.unit}/{model.input.unit}^2",
            "mu_min_at": [_plain(v) for v in d.mu_min_at],
            "g_min": _plain(d.g_min),
            "reversible_share": _plain(d.reversible_share),
            "parameters": {n: {"value": v, "ci95": intervals[n]} for n, v in values.items()},
            "fit": model.fit,
            "mirrored": model.mirrored,
            "range": [self.data.lower, self.data.upper],
            "exercised": self.curves.exercised,
            "noise_floor": model.noise_floor.model_dump(),
            "held_out_rms": self.choice.held_out_rms if self.choice else None,
            "twin": model.twin,
            "warnings": list(self.warnings),
        }

    def __repr__(self) -> str:
        d, fit = self.density, self.model.fit
        return (
            f"Identification({self.surface} from {len(self.data)} points on {self.data.curves} curves: "
            f"rms {fit['rms']:.3g} {self.model.unit}; {d!r}; {len(self.warnings)} warning(s))"
        )


def identify(
    runs: Run | str | Path | Sequence[Run | str | Path],
    surface: Kind | str = "best",
    *,
    select: str | None = None,
    anchor: bool = False,
    weights: Weights = "residual",
) -> Identification:
    """Identify a Preisach model from runs (or paths) that hold first-order curves, by any protocol.

    ``surface``: a form of (5.5), a "table" without a fit, or the "best" by held-out curves; ``select``
    keeps the points where an expression on curve, alpha, beta holds; ``anchor`` and ``weights`` as in
    ``fit_surface``. Ascending data and magnetic reversal curves are fitted in the mirror (−u, −y).
    Raises UsageError for unknown names, DataError when the runs hold too little.
    """
    if surface not in KINDS:
        raise UsageError(f"No surface '{surface}'{suggestion(surface, list(KINDS))}.")
    if weights not in ROOT_WEIGHT:
        raise UsageError(f"Weights '{weights}' are not one of {', '.join(ROOT_WEIGHT)}.")
    given = _loaded(runs)
    if len({file_hash(run) or id(run) for run in given}) < len(given):
        raise UsageError("The same run was given twice: its points would count double; name each run once.")
    everything = fod_data(given)
    _usable(everything)
    data = everything if select is None else selected(everything, select)
    choice = choose(data, anchor=anchor, weights=weights) if surface == "best" else None
    kind = choice.kind if choice else surface
    fit = fit_surface(data, kind, anchor=anchor, weights=weights) if kind in FORMS else None
    image = fit.surface if fit else _tabulated(given, data, select)
    density, curves = density_report(image), curve_report(everything)  # a selection says nothing of the range
    hysteresis = Mirrored(image) if data.mirrored else image
    floor = noise_floor(given)
    model = Model(
        name=f"{given[0].meta.get('wire') or given[0].path.name.split('.')[0]} {kind}",
        hysteresis=hysteresis,
        mirrored=data.mirrored,
        fit=_figures(image, data, fit, weights, select),
        noise_floor=NoiseRecord(value=floor.value, unit=floor.unit, source=floor.source),
        provenance=tuple(provenance(run) for run in given),
        twin=any(run.twin for run in given),
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        parameters=fit.names if fit else (),
        covariance=fit.covariance if fit else np.empty((0, 0)),
        intervals=fit.intervals if fit else {},
        warnings=(*curves.warnings, *_warnings(given, data, image, fit, density)),
        **description(given),
    )
    return Identification(model, kind, data, fit, density, curves, choice)


def _loaded(runs: Run | str | Path | Sequence[Run | str | Path]) -> list[Run]:
    several = [runs] if isinstance(runs, Run | str | Path) else list(runs)
    return [run if isinstance(run, Run) else load_run(run) for run in several]


def _tabulated(runs: Sequence[Run], data: FodData, select: str | None) -> FodTable | ForcTable:
    """A table of the data; whole reversal curves go in as their reader cleans them."""
    if select is not None or any(run.meta.get("protocol") != FORC_PROTOCOL for run in runs):
        return table(data)
    return ForcTable.from_curves([c for run in runs for c in curves_from_run(run)], unit=data.unit)


def _usable(data: FodData) -> None:
    """DataError where no hysteresis can be seen: nothing moves, or a number is beyond all measure."""
    y = data.y
    if not (np.isfinite(y).all() and np.abs(y).max() < _BEYOND and np.abs(data.alpha).max() < _BEYOND):
        raise DataError("The first-order curves hold values that are not finite or beyond all measure.")
    if np.ptp(y) == 0:
        raise DataError(
            f"The output is {y[0]:g} {data.unit} at every point: nothing moves, nothing to identify."
        )


def _figures(
    image: FodSurface | FodTable | ForcTable,
    data: FodData,
    fit: SurfaceFit | None,
    weights: Weights,
    select: str | None,
) -> dict[str, Any]:
    """Errors over the FOD points under their own names: rms, √Σe², Σe², and the weighted ones."""
    squares = (image.y(data.alpha, data.beta) - data.y) ** 2
    weighted = float(np.sum(squares * np.where(data.major, ROOT_WEIGHT[weights] ** 2, 1.0)))
    sse = float(np.sum(squares))
    return {
        "rms": float(np.sqrt(sse / len(data))),
        "norm2": float(np.sqrt(sse)),
        "weighted_norm2": float(np.sqrt(weighted)),
        "sse": sse,
        "weighted_sse": weighted,
        "points": len(data),
        "curves": data.curves,
        "weights": weights,
        "select": select,
        "anchored": fit.anchored if fit else False,
        "converged": fit.converged if fit else None,
        "starts": fit.starts if fit else 0,
        "sigma": _plain(fit.sigma) if fit else None,
    }


def _warnings(
    runs: Sequence[Run],
    data: FodData,
    image: FodSurface | FodTable | ForcTable,
    fit: SurfaceFit | None,
    density: DensityReport,
) -> list[str]:
    found = []
    if fit and not fit.converged:
        found.append("The surface fit did not converge; compare with another surface before using it.")
    if fit and not fit.determined:
        found.append("The data does not determine all parameters of the surface; intervals cannot be given.")
    if isinstance(image, ForcTable) and not data.mirrored:
        found.append("The curves do not share one partition; between them the table is interpolated.")
    if fit is None and density.negative_cells:
        found.append(
            f"{density.negative_cells} of the table's {density.cells} cells have negative mass; noise of the "
            "readings does that too, so this alone does not prove μ < 0."
        )
    late = sum(
        runs[r].settled[k].verdict != "settled" for r, k in zip(data.run, data.point) if runs[r].settled
    )
    if late:
        found.append(f"{late} of {len(data)} points are from steps that did not settle in time.")
    return found


def _plain(value: float) -> float | None:
    return value if np.isfinite(value) else None
