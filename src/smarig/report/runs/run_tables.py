"""Tables about runs: rig and conditions, data quality, steps, events, provenance."""

import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from smarig.core import NotToml, SmarigError, parsed_toml
from smarig.record import Run
from smarig.replay import condition_text, recorded_actuator, recorded_conditions
from smarig.report.components.html import Html, joined, paragraph, severity_mark, table, tag
from smarig.report.components.numbers import duration, number, signed, thousands, to_uncertainty
from smarig.report.components.run_description import (
    FLAG_NAMES,
    count_size,
    display_unit,
    duration_s,
    protocol_name,
    quality_counts,
    started,
)
from smarig.report.runs.derived_quantities import DerivedQuantities, derived_quantities

Row = Sequence[Any]
_WAITED = ("settled", "timed_out", "suspect")  # verdicts of steps that waited until the position settled


# --- rig and conditions ----------------------------------------------------------------------------------


def conditions_table(run: Run, derived: DerivedQuantities | None = None) -> Html:
    """Rig, conditions and constants of a run: quantity, value, unit, source. ``derived``: if already computed."""
    derived = derived or derived_quantities(run)
    rows = [*_run_rows(run), *_derived_rows(run, derived), *_rig_rows(run), *_actuator_rows(run)]
    return table(("Quantity", "Value", "Unit", "Source"), rows, "Rig and conditions.")


def _run_rows(run: Run) -> Iterable[Row]:
    info = run.info
    yield "Rig", info.rig or "not named", "", "run file"
    yield "Wire", info.wire or "not named", "", "run file"
    if info.instruments:
        yield "Instruments", "; ".join(dict.fromkeys(map(str, info.instruments))), "", "run file"
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
        source = f"n = {thousands(known.size)}"
        if info.ambient_from:
            source = f"{info.ambient_from}, not measured"
        yield "Ambient", f"{known.mean():.2f}{moved}", "°C", source
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


def _derived_rows(run: Run, derived: DerivedQuantities) -> Iterable[Row]:
    stress, energy = derived.stress, derived.energy
    if stress is not None:
        text = (
            f"{stress.least_MPa:.0f} to {stress.most_MPa:.0f} ({stress.change_percent:.1f} % from "
            f"{stress.cold_MPa:.0f} with both wires cold)"
        )
        source = "force balance of both wires, heated by the measured current: an upper bound, as for stress_max_MPa"
        yield "Stress in the wires", text, "MPa", source
    if energy is not None:
        heat = f"{number(energy.mean_resistance_J, 4)} (the energy differs by {signed(energy.difference_percent)} %)"
        yield "Electrical energy", number(energy.electrical_J, 4), "J", "∫ V i dt of the readings"
        yield (
            "Heat of the heating model",
            heat,
            "J",
            f"∫ R̄ i² dt with the mean resistance (5.1){_twin_heat(run)}",
        )


def _twin_heat(run: Run) -> str:
    """What heated a twin, which its readings alone do not tell."""
    if run.info.source != "twin":
        return ""
    actuator = recorded_actuator(run)
    if actuator is None:
        return ""
    if actuator.file.thermomechanical is not None:
        return "; this twin is heated by V i"
    by_phase = actuator.file.heating.twin_heat == "phase_resistance"
    return f"; this twin is heated by {'V i' if by_phase else 'it, as in the thesis'}"


def _rig_rows(run: Run) -> Iterable[Row]:
    try:
        rig = run.info.rig_values or parsed_toml(run.info.config or "")
    except NotToml:
        return
    for group in ("limits", "amplifier", "encoder"):
        part = rig.get(group)
        if not isinstance(part, dict):
            continue
        unused = (
            {"counts_per_rev", "noise_counts"} if part.get("resolution") else set()
        )  # those of an encoder
        of_preview = rig.get("kind") == "bench" and group != "limits"
        for key, value in part.items():
            if value is None or key in unused:  # a limit that was not set
                continue
            name, unit = _name_and_unit(key)
            unit = run.unit if key == "resolution" else unit
            yield (
                f"{group.capitalize()}: {name}",
                f"{value:g}" if isinstance(value, float) else value,
                unit,
                "rig file, for previews and checks" if of_preview and key != "resolution" else "rig file",
            )


def _reads_length(run: Run) -> bool:
    """Whether the rig's sensor measures a length itself, without a pulley that turns an encoder."""
    encoder = (run.info.rig_values or {}).get("encoder")
    return isinstance(encoder, dict) and bool(encoder.get("resolution")) and run.unit != "deg"


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
    pulley = [] if _reads_length(run) else [actuator.file.transmission]
    for group in (actuator.file.wire, actuator.file.heating, *pulley):
        for key, quantity in group:
            if hasattr(quantity, "source"):
                yield (
                    key.replace("_", " ").capitalize(),
                    f"{quantity.value:g}",
                    display_unit(quantity.unit),
                    "template: of another wire" if quantity.of_template else quantity.source,
                )
    yield "Thermal time constant τ", f"{actuator.tau_s:.3g}", "s", "derived: ρ c_p V/(hA)"
    yield "Heat loss hA", f"{actuator.hA_W_per_K:.3g}", "W/K", "derived: R I²/T"


# --- data quality -------------------------------------------------------------------------------------------


def quality_table(runs: Mapping[str, Run]) -> Html:
    """Numbers of steps and samples of each run, and how many of them have a mark. A mark of none has no column."""
    counts = [quality_counts(run) for run in runs.values()]
    seen = [key for key in FLAG_NAMES if any(getattr(c, key) for c in counts)]
    gaps = ["gaps"] if any(c.gaps for c in counts) else []
    marks = {key: key.removesuffix("_steps").replace("_", " ") for key in FLAG_NAMES}
    unseen = list(dict.fromkeys(m for m in marks.values() if m not in {marks[key] for key in seen}))
    rows = []
    for (name, run), c in zip(runs.items(), counts):
        state = tag("b", "incomplete") if run.early_end else "done"  # why stands at the top of the page
        marked = [str(getattr(c, key)) for key in (*seen, *gaps)]
        settled = "–" if run.info.protocol == "initialise" else c.settled
        rows.append((name, duration(duration_s(run)), thousands(c.samples), c.steps, settled, *marked, state))
    header = [key.replace("_", " ").capitalize() for key in (*seen, *gaps)]
    none = f" No step and no sample is marked {_any_of(unseen)}." if unseen else ""
    return table(
        ("Run", "Duration", "Samples", "Steps", "Settled", *header, "Ended"),
        rows,
        "Data quality: steps by verdict, samples by quality mark. Initialisation holds for a fixed time and "
        f"gives no settled points.{' At each gap, samples were lost.' if gaps else ''}{none}",
    )


def _any_of(words: Sequence[str]) -> str:
    """The words as an alternative: "stale, void or tripped"."""
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


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
                started(run, "%Y-%m-%d %H:%M:%S UTC") or "unknown",
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


def record_parts(runs: Sequence[Run], words: str) -> Iterator[Html]:
    """Conditions of the first run, data quality and provenance of all, and a last sentence."""
    several = len(runs) > 1
    named = {f"{f'{k}. ' if several else ''}{protocol_name(run)}": run for k, run in enumerate(runs, start=1)}
    yield conditions_table(runs[0])
    yield quality_table(named)
    yield provenance_table(named)
    yield paragraph(words)


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
    """The first ``most`` recorded steps. A mean resolves a tenth of a count."""
    resolution = count_size(run)
    rows = [
        (
            s.index,
            s.branch,
            number(s.target, 4),
            to_uncertainty(s.position, resolution / 10) if s.verdict in _WAITED else "–",
            s.n,
            s.verdict.replace("_", " "),
            "void" if s.void else "",
        )
        for s in run.steps[:most]
    ]
    more = f" The first {most} of {len(run.steps)}." if len(run.steps) > most else ""
    header = (
        "Step",
        "Branch",
        f"Target ({run.input_unit})",
        f"Position ({run.unit})",
        "n",
        "Verdict",
        "Mark",
    )
    words = (
        "Steps. The position is the mean of the last n samples of a step that waited until it settled. A step that is "
        f"not 'settled' may have ended elsewhere.{more}"
    )
    return (
        tag("details", tag("summary", f"{len(run.steps)} steps"), table(header, rows, words))
        if rows
        else Html("")
    )


def _short(value: Any) -> str:
    """A number with four digits, a hash with twelve; other texts as they are."""
    text = str(value)
    if re.fullmatch(r"-?\d+\.\d+(e-?\d+)?", text):
        return number(float(text), 4)
    return f"{text[:12]}…" if re.fullmatch(r"[0-9a-f]{64}", text) else text


def settings_text(run: Run) -> Html:
    """The settings of a run in one line."""
    settings = run.info.settings
    return (
        paragraph(
            "Settings: ", joined([tag("code", f"{k}={_short(v)}") for k, v in settings.items()], ", "), "."
        )
        if settings
        else Html("")
    )
