"""The page of an identified material: loops with the model, parameters, phase diagram, errors, method."""

from smarig.identification import Estimate, MaterialIdentification, parameter_cells, quantity_name
from smarig.report.components.html import Html, bullets, joined, paragraph, table, tag, with_subscripts
from smarig.report.components.numbers import interval_text, number, to_interval
from smarig.report.components.page import Section, page
from smarig.report.components.run_description import source_label
from smarig.report.material.material_figures import all_loops, each_loop, phase_diagram
from smarig.report.runs.run_summary import summary_with_loop
from smarig.report.runs.run_title import titled


def material_page(found: MaterialIdentification) -> str:
    """The HTML page of an identified material."""
    runs = [r.record.run for r in found.records]
    sections = [
        Section("", "Summary", [_opening(found), all_loops(found)]),
        Section("Parameters", "Parameters", [_parameters(found), _missing(found)]),
        Section("Stress dependence", "Stress", [phase_diagram(found)]),
        Section("Each record", "Records", [_records(found), each_loop(found)]),
        Section("Method", "Method", _method(found)),
    ]
    lead = f"One constitutive model of {len(runs)} records"
    about = summary_with_loop("material", f"{lead}.", "", runs[0])
    return page(titled("Material", runs), lead, sections, label=source_label(*runs), summary=about)


def _opening(found: MaterialIdentification) -> Html:
    left = [r for r in found.records if r.left_out_rms is not None]
    worst = max(left, key=lambda r: r.left_out_rms or 0.0) if left else None
    predicted = (
        f" A load that was left out is predicted within {_percent(worst.left_out_rms)} (rms) or better; the worst is "
        f"{worst.record.condition}."
        if worst
        else ""
    )
    twin = found.twin
    words = "" if twin is None else f" {twin if isinstance(twin, str) else twin.sentence}"
    return paragraph(
        f"The model leaves {_percent(found.rms)} of strain (rms) over {found.n} readings of {len(found.records)} "
        f"records.{predicted}{words}"
    )


def _percent(value: float | None) -> str:
    return f"{number(None if value is None else 100 * value, 2)} %"


def _parameters(found: MaterialIdentification) -> Html:
    rows = []
    for name, estimate in found.parameters.items():
        symbol, words = quantity_name(name)
        value, ci95, unit = parameter_cells(name, estimate)
        rows.append([_symbol(symbol), to_interval(value, ci95), interval_text(*ci95), unit, words])
    for stress, estimate in found.strains:
        value, ci95, unit = parameter_cells("strain_", estimate)
        words = "transformation strain" + (" and elastic change" if found.strain_is_sum else "")
        rows.append([f"at {stress:.4g} MPa", to_interval(value, ci95), interval_text(*ci95), unit, words])
    if isinstance(found.latent_heat, Estimate):
        e = found.latent_heat
        rows.append(
            ["L", to_interval(e.value, e.ci95), interval_text(*e.ci95), e.unit, "latent heat, from power"]
        )
    return table(
        ["Parameter", "Value", "95 % interval", "Unit", "Meaning"],
        rows,
        with_subscripts(
            f"Parameters of the law. C_A and C_M are slopes at {found.law.reference_stress:.4g} MPa."
        ),
    )


def _symbol(symbol: str) -> Html:
    """A symbol with its subscript."""
    letter, _, below = symbol.partition("_")
    return joined([letter, tag("sub", below)]) if below else joined([letter])


def _missing(found: MaterialIdentification) -> Html:
    """What the records do not determine, and why."""
    items: list[Html] = []
    for why in dict.fromkeys(found.not_determined.values()):
        symbols = [quantity_name(n)[0] for n, reason in found.not_determined.items() if reason == why]
        items.append(joined([joined([_symbol(s) for s in symbols], ", "), ": ", with_subscripts(why), "."]))
    if not isinstance(found.latent_heat, Estimate):
        items.append(joined([f"Latent heat: {found.latent_heat}"]))
    return paragraph("Not determined by these records:", bullets(items)) if items else paragraph("")


def _records(found: MaterialIdentification) -> Html:
    rows = [
        [
            r.record.name,
            r.record.condition,
            str(r.record.strain.size),
            number(100 * r.rms, 2),
            "–" if r.left_out_rms is None else number(100 * r.left_out_rms, 2),
        ]
        for r in found.records
    ]
    header = ["Record", "Held", "Readings", "Error (% of strain, rms)", "Predicted from the other loads (%)"]
    return table(header, rows, "Errors of the model.", stacked=True)


def _method(found: MaterialIdentification) -> list[Html]:
    parts = (
        " A share w of the material transforms over a range q times as wide: with one width the error is larger than "
        "the two parameters are worth (criterion of Schwarz)."
        if found.two_parts
        else ""
    )
    return [
        paragraph(
            "The law is that of Lagoudas et al. (Int. J. Plasticity 32–33, 2012, 155–183) in one dimension, with "
            "smooth hardening: transformation starts and finishes on surfaces in temperature and stress, on which the "
            f"fraction of martensite follows from the temperature.{parts} All records are fitted at once by least "
            "squares from several starting values."
        ),
        paragraph(
            "Intervals count errors that last over several readings once: the correlation of the residuals along each "
            "record is estimated by restricted likelihood and propagated. They contain the noise and the misfit of the "
            "law, not the error of the thermometer or of the load."
        ),
    ]
