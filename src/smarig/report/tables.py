"""The tables of a page: rig and conditions, honest counts, parameters, errors, classes, provenance."""

import hashlib
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np

from smarig.errors import SmarigError
from smarig.identification.calibrate import Calibration
from smarig.identification.identify import Identification
from smarig.identification.verify import Verification
from smarig.model.actuator import Actuator
from smarig.record import Run
from smarig.report.conditions import BLEMISHES, duration, duration_s, marks, protocol_of, thousands
from smarig.report.figures_density import density_unit, signed
from smarig.report.html import Html, joined, paragraph, table, tag
from smarig.report.identified import report_of

Row = Sequence[Any]


# --- rig and conditions ----------------------------------------------------------------------------------


def conditions_table(run: Run) -> Html:
    """What was measured, on what, and where every constant comes from: quantity, value, unit, source."""
    rows = [*_of_run(run), *_of_rig(run), *_of_actuator(run)]
    return table(("Quantity", "Value", "Unit", "Source"), rows, "Rig and conditions.")


def _of_run(run: Run) -> Iterable[Row]:
    meta = run.meta
    yield "Rig", meta.get("rig") or "not named", "", "run file"
    yield "Wire", meta.get("wire") or "not named", "", "run file"
    if meta.get("period_s"):
        yield "Tick", f"{meta['period_s']:g}", "s", "run file"
    for key, name in (("input", "Hysteresis input"), ("output", "Output")):
        part = meta.get(key) or {}
        yield name, part.get("quantity") or "not named", part.get("unit", ""), part.get("from") or "run file"
    size = (meta.get("output") or {}).get("per_count")
    if size:
        yield "One count", f"{size:.4g}", run.unit, "run file"
    known = run["ambient_degC"][np.isfinite(run["ambient_degC"])]
    if known.size:
        yield (
            "Ambient",
            f"{known.mean():.2f} (from {known.min():.2f} to {known.max():.2f})",
            "°C",
            f"n = {thousands(known.size)}",
        )
    for key in ("initial", "encoder_zero", "seed", "notes"):
        if meta.get(key) not in (None, ""):
            yield key.replace("_", " ").capitalize(), meta[key], "", "run file"
    for key, value in (meta.get("conditions") or {}).items():
        yield str(key).replace("_", " ").capitalize(), value, "", "imported file"


def _of_rig(run: Run) -> Iterable[Row]:
    try:
        rig = tomllib.loads(run.meta.get("config") or "")
    except tomllib.TOMLDecodeError:
        return
    for group in ("limits", "amplifier", "encoder"):
        part = rig.get(group)
        for key, value in part.items() if isinstance(part, dict) else ():
            name, unit = _name_and_unit(key)
            yield f"{group.capitalize()}: {name}", value, unit, "rig file"


def _name_and_unit(key: str) -> tuple[str, str]:
    """``current_rate_A_per_s`` → ("current rate", "A/s"): names end in their unit."""
    units = {"_A_per_s": "A/s", "_A": "A", "_V": "V", "_K": "K", "_s": "s", "_counts": "counts"}
    for ending, unit in units.items():
        if key.endswith(ending):
            return key.removesuffix(ending).replace("_", " "), unit
    return key.replace("_", " "), ""


def _of_actuator(run: Run) -> Iterable[Row]:
    try:
        actuator = Actuator.named(run.meta["actuator"]) if run.meta.get("actuator") else None
    except SmarigError:
        yield "Actuator", run.meta["actuator"], "", "its parameter file is not here"
        return
    if actuator is None:
        return
    yield "Actuator", actuator.name, "", actuator.file.source
    for group in (actuator.file.wire, actuator.file.heating, actuator.file.transmission):
        for key, quantity in group:
            if hasattr(quantity, "source"):
                yield (
                    key.replace("_", " ").capitalize(),
                    f"{quantity.value:g}",
                    quantity.unit,
                    quantity.source,
                )
    yield "Thermal time constant τ", f"{actuator.tau_s:.3g}", "s", "derived: ρ c_p V/(hA)"
    yield "Heat loss hA", f"{actuator.hA_W_per_K:.3g}", "W/K", "derived: R I²/T"


# --- honest numbers -----------------------------------------------------------------------------------------


def marks_table(runs: Mapping[str, Run]) -> Html:
    """Steps and samples of each run, and how many of them are marked."""
    rows = []
    for name, run in runs.items():
        m = marks(run)
        counted = [str(getattr(m, key)) for key in BLEMISHES]
        state = run.cause if run.complete else tag("b", run.cause)
        rows.append(
            (name, duration(duration_s(run)), thousands(m.samples), m.steps, m.settled, *counted, state)
        )
    header = ("Run", "Duration", "Samples", "Steps", "Settled", "Timed out", "Interrupted", "Void")
    return table(
        (*header, "Retried", "Stale", "Saturated", "Tripped", "Ended"),
        rows,
        "Honest numbers: steps by verdict, samples by quality mark. Initialisation holds for a fixed time, so its steps "
        "need not settle.",
    )


# --- models ---------------------------------------------------------------------------------------------------


def errors_table(
    found: Mapping[str, Identification], held_out: Mapping[str, Verification], chosen: str
) -> Html:
    """Errors over the identification points (as Table 5.1) and on held-out data, by surface."""
    rows = []
    for name, one in found.items():
        fit = one.model.fit
        judged = pooled_rms(held_out.get(name))
        row = [f"{fit[key]:.4g}" for key in ("rms", "norm2", "weighted_norm2")]
        row += [f"{judged:.3g}" if judged is not None else "—", f"{fit['points']} on {fit['curves']} curves"]
        rows.append((tag("b", f"{name} (chosen)") if name == chosen else name, *row))
    unit = next(iter(found.values())).model.unit
    return table(
        (
            "Surface",
            f"rms ({unit})",
            f"‖e‖₂ ({unit})",
            f"weighted ‖e‖₂ ({unit})",
            f"held-out rms ({unit})",
            "points",
        ),
        rows,
        "Errors of each surface over the identification points, in the manner of Table 5.1 (2-norms over the points; major "
        "loop weighted twice), and on the held-out run. A table meets its points exactly, so only held-out data judges it.",
    )


def pooled_rms(verification: Verification | None) -> float | None:
    """rms over all points of all runs of a verification."""
    if verification is None or not verification.runs:
        return None
    n = sum(r.settled.n for r in verification.runs)
    return float(np.sqrt(sum(r.settled.n * r.settled.rms**2 for r in verification.runs) / n)) if n else None


def parameters_table(found: Identification) -> Html:
    """Fitted parameters with 95 % intervals; nothing for tables."""
    if found.fit is None:
        return paragraph(
            f"The {found.surface} model has no fitted parameters: it interpolates the measured points."
        )
    units = _units(found)
    rows = []
    for name, value in zip(found.fit.names, found.fit.values):
        low, high = found.fit.intervals[name]
        known = np.isfinite([low, high]).all()
        interval = f"{signed5(low)} to {signed5(high)}" if known else "not determined by this data"
        rows.append((_pretty(name), signed5(float(value)), interval, units.get(name, "")))
    converged = "" if found.fit.converged else " The fit did not converge."
    return table(
        ("Parameter", "Value", "95 % interval", "Unit"),
        rows,
        f"The {found.surface} surface (5.5), {found.fit.points} points on {found.fit.curves} curves. Intervals assume equal "
        f"independent noise at every point (residual σ {found.fit.sigma:.3g} {found.model.unit}).{converged}",
    )


def signed5(value: float) -> str:
    """Five digits with a true minus sign."""
    return f"{value:.5g}".replace("-", "−")


def _units(found: Identification) -> dict[str, str]:
    u, y = found.model.input.unit, found.model.unit
    units = {"x2": f"1/{u}", "x3": u, "x4": f"1/{u}", "y_upper": y, "y_lower": y}
    return units | {
        "constant": {"x5": u},
        "parabolic": {"x5": f"1/{u}", "x6": "1", "x7": u},
        "exponential": {"x5": u, "x6": f"1/{u}", "x7": u},
    }.get(found.surface, {})


def _pretty(name: str) -> str:
    return {"y_upper": "y(u₊, u₊)", "y_lower": "y(u₊, u₋)"}.get(
        name, name.translate(str.maketrans("234567", "₂₃₄₅₆₇"))
    )


def classes_table(found: Mapping[str, Identification], run: Run) -> Html:
    """Classes of μ as in Table 5.2, with its extremes and the reversible part."""
    rows = []
    for name, one in found.items():
        d = report_of(one)
        share = f"{100 * d.reversible_share:.1f} %" if np.isfinite(d.reversible_share) else "—"
        cells = f"; {d.negative_cells} of {d.cells} cells negative" if d.cells else ""
        at = f"({signed(d.mu_min_at[0])}, {signed(d.mu_min_at[1])})"
        rows.append(
            (
                name,
                "yes" if d.M_PC else "no",
                ("yes" if d.M_P else "no") + cells,
                signed(d.mu_min),
                at,
                signed(d.mu_max),
                share,
            )
        )
    unit = density_unit(run)
    header = (
        "Surface",
        "M_PC",
        "M_P",
        f"min μ ({unit})",
        f"at (α, β) ({run.input_unit})",
        f"max μ ({unit})",
        "reversible share",
    )
    return table(
        header,
        rows,
        "Class of the weighting function (Table 5.2). M_PC: bounded, piecewise continuous. M_P: besides, μ ≥ 0 everywhere; "
        "passivity and the stability theorems need it.",
    )


# --- the rest ----------------------------------------------------------------------------------------------


def calibration_table(found: Calibration) -> Html:
    """The wire's own constants with intervals, and what the data cannot give."""
    rows = [
        (name, f"{e.value:.4g}", f"{e.ci95[0]:.4g} to {e.ci95[1]:.4g}", e.unit, e.source, thousands(e.n))
        for name, e in found.parameters.items()
    ]
    rows += [(name, "—", "—", "", why, "") for name, why in found.not_available.items()]
    return table(
        ("Constant", "Value", "95 % interval", "Unit", "From", "n"),
        rows,
        "Constants of the wire, calibrated.",
    )


def provenance_table(runs: Mapping[str, Run]) -> Html:
    """Which files this page was made from: name, protocol, hash, start, versions."""
    rows = []
    for run in runs.values():
        versions = ", ".join(f"{k} {v}" for k, v in (run.meta.get("versions") or {}).items())
        seed = run.meta.get("seed")
        rows.append(
            (
                run.path.name,
                protocol_of(run),
                run.meta.get("source") or "unknown",
                _start(run),
                "" if seed is None else seed,
                versions,
                tag("code", sha256(run)),
            )
        )
    return table(
        ("Run file", "Protocol", "Source", "Sitting began", "Seed", "Versions", "SHA-256"),
        rows,
        "Where it all comes from.",
    )


def _start(run: Run) -> str:
    epoch = run.meta.get("start_epoch")
    return datetime.fromtimestamp(epoch, UTC).strftime("%Y-%m-%d %H:%M:%S UTC") if epoch else "unknown"


def sha256(run: Run) -> str:
    """Hash of the run file; says so when it is no longer there."""
    try:
        with run.path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return "file not found"


def events_table(run: Run, most: int = 60) -> Html:
    """What happened in a run; the first ``most`` events."""
    rows = [(f"{e.t_s:g}", e.level, e.kind, e.text) for e in run.events[:most]]
    more = f" The first {most} of {len(run.events)}." if len(run.events) > most else ""
    return table(("t (s)", "Level", "Kind", "What"), rows, f"Events.{more}") if rows else Html("")


def settings_words(run: Run) -> Html:
    """A run's settings in a line."""
    settings = run.meta.get("settings") or {}
    return (
        paragraph("Settings: ", joined([tag("code", f"{k}={v}") for k, v in settings.items()], ", "), ".")
        if settings
        else Html("")
    )
