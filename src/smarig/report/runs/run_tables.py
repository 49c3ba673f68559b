"""Tables about runs: rig and conditions, data quality, steps, events, provenance."""

import hashlib
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from typing import Any

import numpy as np
from pydantic import ValidationError

from smarig.config import ActuatorFile
from smarig.core import SmarigError
from smarig.plant import Actuator
from smarig.preisach import thesis_surface
from smarig.record import AnyRun, Run
from smarig.replay import StressRange, condition_text, recorded_conditions, stress_over_run
from smarig.report.components.html import Html, joined, paragraph, table, tag
from smarig.report.components.numbers import duration, number, thousands
from smarig.report.components.run_description import (
    FLAG_NAMES,
    display_unit,
    duration_s,
    protocol_name,
    quality_counts,
)
from smarig.report.components.severity_mark import severity_mark

Row = Sequence[Any]


# --- rig and conditions ----------------------------------------------------------------------------------


def conditions_table(run: Run) -> Html:
    """Rig, conditions and constants of a run: quantity, value, unit, source."""
    rows = [*_run_rows(run), *_stress_rows(run), *_rig_rows(run), *_actuator_rows(run)]
    return table(("Quantity", "Value", "Unit", "Source"), rows, "Rig and conditions.")


def _run_rows(run: Run) -> Iterable[Row]:
    info = run.info
    yield "Rig", info.rig or "not named", "", "run file"
    yield "Wire", info.wire or "not named", "", "run file"
    if info.period_s:
        yield "Tick", f"{info.period_s:g}", "s", "run file"
    for signal, name in ((info.input, "Hysteresis input"), (info.output, "Output")):
        yield (
            name,
            (signal.quantity or "not named").replace("T1 - T2", "T₁ − T₂"),
            signal.unit,
            signal.from_ or "run file",
        )
    if info.output.per_count:
        yield "One count", f"{info.output.per_count:.4g}", run.unit, "run file"
    known = run["ambient_degC"][np.isfinite(run["ambient_degC"])]
    if known.size:
        moved = f" (from {known.min():.2f} to {known.max():.2f})" if np.ptp(known) >= 0.005 else ""
        yield "Ambient", f"{known.mean():.2f}{moved}", "°C", f"n = {thousands(known.size)}"
    if info.effects:
        yield "Injected effects", ", ".join(map(str, info.effects)), "", "twin settings"
    if info.wire_history:
        yield "Wire before this run", info.wire_history, "", "wire history"
    for key in ("initial", "encoder_zero", "seed", "notes"):
        if (value := getattr(info, key)) not in (None, ""):
            yield key.replace("_", " ").capitalize(), value, "", "run file"
    for key, own in recorded_conditions(run).items():
        source = "imported file" if info.imported else "run file"
        yield key.replace("_", " ").capitalize(), condition_text(own), display_unit(own.unit), source


def _stress_rows(run: Run) -> Iterable[Row]:
    stress = run_stress(run)
    if stress is not None:
        text = (
            f"{stress.least_MPa:.0f} to {stress.most_MPa:.0f} ({stress.change_percent:.1f} % from "
            f"{stress.cold_MPa:.0f} with both wires cold)"
        )
        yield (
            "Stress in the wires",
            text,
            "MPa",
            "force balance of both wires, heated by the measured current",
        )


def run_stress(run: AnyRun) -> StressRange | None:
    """The stress over a run of two wires; None for others, or if its actuator file is not available."""
    try:
        actuator = recorded_actuator(run)
        if (
            actuator is None or actuator.file.thermomechanical is not None
        ):  # its surface is not that of the wire
            return None
        return stress_over_run(run, actuator, thesis_surface(actuator.file.hysteresis.surface))
    except SmarigError:
        return None


def recorded_actuator(run: AnyRun) -> Actuator | None:
    """The actuator as it was in the run, else that of the file of this name. Raises SmarigError if there is none."""
    if run.info.actuator_values:
        with suppress(ValidationError):  # of another version
            return Actuator(ActuatorFile.model_validate(run.info.actuator_values))
    return Actuator.named(run.info.actuator) if run.info.actuator else None


def _rig_rows(run: Run) -> Iterable[Row]:
    try:
        rig = run.info.rig_values or tomllib.loads(run.info.config or "")
    except tomllib.TOMLDecodeError:
        return
    for group in ("limits", "amplifier", "encoder"):
        part = rig.get(group)
        for key, value in part.items() if isinstance(part, dict) else ():
            if value is None:  # a limit that was not set
                continue
            name, unit = _name_and_unit(key)
            yield (
                f"{group.capitalize()}: {name}",
                f"{value:g}" if isinstance(value, float) else value,
                unit,
                "rig file",
            )


def _name_and_unit(key: str) -> tuple[str, str]:
    """``current_rate_A_per_s`` → ("current rate", "A/s"): the name of a setting ends in its unit."""
    units = {
        "_A_per_s": "A/s",
        "_MPa": "MPa",
        "_A": "A",
        "_V": "V",
        "_K": "K",
        "_s": "s",
        "_counts": "counts",
    }
    for ending, unit in units.items():
        if key.endswith(ending):
            return key.removesuffix(ending).replace("_", " "), unit
    return key.replace("_", " "), ""


def _actuator_rows(run: Run) -> Iterable[Row]:
    try:
        actuator = recorded_actuator(run)
    except SmarigError:
        yield "Actuator", run.info.actuator, "", "parameter file not available"
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
                    display_unit(quantity.unit),
                    quantity.source,
                )
    yield "Thermal time constant τ", f"{actuator.tau_s:.3g}", "s", "derived: ρ c_p V/(hA)"
    yield "Heat loss hA", f"{actuator.hA_W_per_K:.3g}", "W/K", "derived: R I²/T"


# --- data quality -------------------------------------------------------------------------------------------


def quality_table(runs: Mapping[str, Run]) -> Html:
    """Numbers of steps and samples of each run, and how many of them have a mark. A mark of none has no column."""
    counts = [quality_counts(run) for run in runs.values()]
    seen = [key for key in FLAG_NAMES if any(getattr(c, key) for c in counts)]
    unseen = [key.replace("_", " ") for key in FLAG_NAMES if key not in seen]
    rows = []
    for (name, run), c in zip(runs.items(), counts):
        ended = run.cause.partition(":")[0]  # all of it stands at the top of the page
        state = ended if run.complete else tag("b", ended)
        marked = [str(getattr(c, key)) for key in seen]
        rows.append(
            (name, duration(duration_s(run)), thousands(c.samples), c.steps, c.settled, *marked, state)
        )
    header = [key.replace("_", " ").capitalize() for key in seen]
    none = f" Marks of no step and no sample: {', '.join(unseen)}." if unseen else ""
    return table(
        ("Run", "Duration", "Samples", "Steps", "Settled", *header, "Ended"),
        rows,
        "Data quality: steps by verdict, samples by quality mark. Initialisation holds for a fixed time, so its "
        f"steps need not settle.{none}",
    )


# --- provenance, events and steps ---


def provenance_table(runs: Mapping[str, Run]) -> Html:
    """The files of a page: name, protocol, source, start, seed, versions, hash."""
    rows = []
    for run in runs.values():
        versions = ", ".join(f"{k} {v}" for k, v in run.info.versions.items())
        seed = run.info.seed
        rows.append(
            (
                run.path.name,
                protocol_name(run),
                run.info.source or "unknown",
                _start(run),
                "" if seed is None else seed,
                versions,
                tag("code", sha256(run)),
            )
        )
    return table(
        ("Run file", "Protocol", "Source", "Session start", "Seed", "Versions", "SHA-256"),
        rows,
        "Files from which this page was made.",
    )


def _start(run: Run) -> str:
    epoch = run.info.start_epoch
    return datetime.fromtimestamp(epoch, UTC).strftime("%Y-%m-%d %H:%M:%S UTC") if epoch else "unknown"


def sha256(run: Run) -> str:
    """Hash of the run file, or "file not found"."""
    try:
        with run.path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return "file not found"


def events_table(run: Run, most: int = 60) -> Html:
    """The first ``most`` events of a run."""
    rows = [(f"{e.t_s:g}", severity_mark(e.severity), e.kind, e.text) for e in run.events[:most]]
    more = f" The first {most} of {len(run.events)}." if len(run.events) > most else ""
    return table(("t (s)", "Severity", "Kind", "Event"), rows, f"Events.{more}") if rows else Html("")


def steps_table(run: Run, most: int = 400) -> Html:
    """The first ``most`` recorded steps."""
    rows = [
        (
            s.index,
            s.branch,
            number(s.target, 4),
            number(s.position, 5),
            s.n,
            s.verdict.replace("_", " "),
            "void" if s.void else "",
        )
        for s in run.steps[:most]
    ]
    more = f" The first {most} of {len(run.steps)}." if len(run.steps) > most else ""
    header = ("Step", "Branch", f"Target ({run.input_unit})", f"Position ({run.unit})", "n", "Verdict", "")
    words = f"Steps. The position is the mean of the last n samples.{more}"
    return (
        tag("details", tag("summary", f"{len(run.steps)} steps"), table(header, rows, words))
        if rows
        else Html("")
    )


def settings_text(run: Run) -> Html:
    """The settings of a run in one line."""
    settings = run.info.settings
    return (
        paragraph("Settings: ", joined([tag("code", f"{k}={v}") for k, v in settings.items()], ", "), ".")
        if settings
        else Html("")
    )
