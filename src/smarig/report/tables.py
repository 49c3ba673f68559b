"""Tables of a page: conditions, constants with sources, parameters with intervals, errors, provenance."""

import hashlib
from typing import Any

from smarig.config import ActuatorFile, Quantity, Section, load_actuator
from smarig.errors import SmarigError
from smarig.identification.calibrate import Calibration
from smarig.record import Run
from smarig.report.evidence import Evidence
from smarig.report.html import Html, table, tag
from smarig.report.words import duration, interval, number

_KEYS = (
    ("rig", "Rig"),
    ("wire", "Wire"),
    ("actuator", "Actuator"),
    ("protocol", "Protocol"),
    ("source", "Source"),
    ("seed", "Seed of the noise"),
    ("period_s", "Tick (s)"),
    ("encoder_zero", "Encoder zero"),
    ("notes", "Notes"),
)


def description(run: Run) -> Html:
    """What a run says of itself."""
    rows: list[tuple[Any, ...]] = [
        (label, run.meta[key]) for key, label in _KEYS if run.meta.get(key) not in (None, "")
    ]
    rows.append(("Samples", len(run)))
    if run.has("t_s") and len(run):
        rows.append(("Duration", duration(float(run["t_s"][-1] - run["t_s"][0]))))
    if run.has("ambient_degC"):
        rows.append(("Ambient (°C)", number(float(run["ambient_degC"][0]))))
    rows.append(("Ending", run.cause))
    return table(("What", "Value"), rows, f"Description of {run.path.name}.")


def constants(actuator: str) -> Html:
    """An actuator's constants: value, unit, source. Empty where the parameter set is not at hand."""
    try:
        file = load_actuator(actuator)
    except SmarigError:
        return Html("")
    rows = [(name, number(q.value, 5), q.unit, q.source) for name, q in _quantities(file)]
    return table(("Constant", "Value", "Unit", "Source"), rows, f"Constants of {file.name}. {file.source}.")


def _quantities(file: ActuatorFile) -> list[tuple[str, Quantity]]:
    found = []
    for name in type(file).model_fields:
        part = getattr(file, name)
        if isinstance(part, Section):
            inner = [(key, getattr(part, key)) for key in type(part).model_fields]
            found += [(key.replace("_", " "), value) for key, value in inner if isinstance(value, Quantity)]
    return found


def calibration(found: Calibration) -> Html:
    """The wire's own constants as this data gives them, and what it cannot give."""
    rows = [
        (name, number(e.value, 4), interval(e.ci95), e.unit, e.n, e.source) for name, e in found.parameters.items()
    ]
    given = table(("Constant", "Value", "95 %", "Unit", "n", "From"), rows, "Calibration from these runs.") if rows else ""
    missing = tag("ul", *(tag("li", sentence) for sentence in found.not_available.values()))
    return Html(f"{given}{missing if found.not_available else ''}")


def parameters(evidence: Evidence) -> Html:
    """Parameters of the chosen surface with 95 % intervals."""
    best = evidence.best
    if best.fit is None:
        return Html("")
    rows = [
        (name, number(value, 5), interval(best.model.intervals[name], 5))
        for name, value in zip(best.fit.names, best.fit.values.tolist(), strict=True)
    ]
    return table(("Parameter", "Value", "95 % interval"), rows, f"Surface (5.5), {best.surface} f(α), fitted.")


def errors(evidence: Evidence) -> Html:
    """Every surface's errors in the manner of Table 5.1, its class, and what it does on held-out data."""
    rows = []
    for name, result in evidence.identifications.items():
        fit, d = result.model.fit, result.density
        verified = evidence.verifications.get(name)
        judged = verified.runs[0].settled.rms if verified and verified.runs else None
        rows.append(
            (
                name + (" (chosen)" if name == evidence.chosen else ""),
                number(fit["rms"]),
                number(fit["norm2"]),
                number(fit["weighted_norm2"]),
                number(d.mu_min),
                number(d.mu_max),
                "yes" if d.M_P else "no",
                number(judged),
            )
        )
    unit = evidence.best.data.unit
    head = ("Surface", "rms", "2-norm", "weighted 2-norm", "min μ", "max μ", "M_P", "validation rms")
    return table(head, rows, f"Errors in {unit} (as in Table 5.1), classes (Table 5.2), and error on the validation run.")


def provenance(evidence: Evidence) -> Html:
    """Run files with their hashes, versions, command."""
    rows = [
        (
            name,
            run.path.name,
            len(run),
            duration(float(run["t_s"][-1] - run["t_s"][0])) if len(run) else "–",
            tag("code", hashlib.sha256(run.path.read_bytes()).hexdigest()[:16]),
        )
        for name, run in evidence.runs.items()
    ]
    versions = next(iter(evidence.runs.values())).meta.get("versions", {})
    said = ", ".join(f"{name} {version}" for name, version in versions.items())
    caption = f"Made by “{evidence.command}” with {said}."
    return table(("Run", "File", "Samples", "Duration", "SHA-256 (first 16)"), rows, caption)
