"""The page of a diagnosis of a thermal record: verdict, temperatures, errors, what was compared, and provenance."""

from collections.abc import Iterator

from smarig.diagnosis import ThermalDiagnosis
from smarig.report.components.figure import Figure, Panel, axis, dots, line
from smarig.report.components.html import Html, bullets, cards, notice, paragraph, tag
from smarig.report.components.numbers import duration, number
from smarig.report.components.page import PageSummary, Section, page
from smarig.report.components.run_description import protocol_name, source_label
from smarig.report.components.style import COOLING, INK, MODEL
from smarig.report.diagnosis.compared_causes import compared_causes
from smarig.report.diagnosis.verdict_levels import SEVERITY_LEVELS
from smarig.report.run_page import run_lead
from smarig.report.runs.run_tables import conditions_table, provenance_table, quality_table


def thermal_diagnosis_page(d: ThermalDiagnosis) -> str:
    """The self-contained HTML page, for ``write_page``."""
    compared = list(compared_causes(d.evidence.weights, d.probabilities, source_label(d.run)))
    sections = [
        Section("Verdict", "Verdict", list(_summary(d))),
        Section("Measured and predicted temperatures", "Temperatures", [_trace_figure(d)]),
        Section("Errors on blocks left out", "Errors", [_errors_figure(d)]),
        Section("Effects and variables that were compared", "Compared", compared),
        Section("Data quality, provenance", "Provenance", list(_provenance(d))),
    ]
    return page(
        "Diagnosis of a wire temperature",
        run_lead(d.run),
        sections,
        label=source_label(d.run),
        summary=PageSummary("diagnosis", d.lines()[0], SEVERITY_LEVELS[d.verdict.word]),
    )


def _summary(d: ThermalDiagnosis) -> Iterator[Html]:
    first, *rest = d.lines()
    yield notice(SEVERITY_LEVELS[d.verdict.word], paragraph(tag("b", first)))
    after = f" → {number(d.gain.extended)}" if d.candidates else ""
    yield cards(
        [
            (
                "Error on blocks left out, rms (K)",
                f"{number(d.gain.base)}{after}",
                f"noise {number(d.noise, 2)}",
            ),
            ("Transients", str(d.evidence.problem.transients), f"of {d.gain.blocks} blocks"),
        ]
    )
    yield bullets(rest)


def _trace_figure(d: ThermalDiagnosis) -> Figure:
    x = d.record
    data = [
        line(x.t, x.temperature, "measured", INK),
        line(x.t, x.temperature - d.base.error, "plain balance", COOLING),
    ]
    if d.candidates:
        data.append(line(x.t, x.temperature - d.extended.error, "extended balance", MODEL))
    layout = {"xaxis": axis(_time(d)), "yaxis": axis("Temperature (°C)")}
    drive = Panel(
        [line(x.t, x.bin_drive, "drive", INK)],
        {"xaxis": axis(_time(d)), "yaxis": axis("Drive (recorded unit)")},
    )
    caption = [f"Means over {x.t.size} bins; the balances are fitted to all of them."]
    return Figure(
        [Panel(data, layout, wide=True), drive], "Temperature and drive.", caption, source_label(d.run)
    )


def _errors_figure(d: ThermalDiagnosis) -> Figure:
    data = [dots(d.record.t, d.gain.base_error, "plain balance", COOLING)]
    if d.candidates:
        data.append(dots(d.record.t, d.gain.extended_error, "extended balance", MODEL))
    layout = {"xaxis": axis(_time(d)), "yaxis": axis("Measured − predicted (K)")}
    caption = [f"Each of {d.gain.blocks} blocks is predicted from the others."]
    return Figure([Panel(data, layout, wide=True)], "Errors of both balances.", caption, source_label(d.run))


def _time(d: ThermalDiagnosis) -> str:
    return f"Time ({d.record.unit})" if d.record.unit == "s" else "Sample"


def _provenance(d: ThermalDiagnosis) -> Iterator[Html]:
    runs = {protocol_name(d.run): d.run}
    yield conditions_table(d.run)
    yield quality_table(runs)
    yield provenance_table(runs)
    yield paragraph(f"Computed in {duration(d.seconds)}.")
