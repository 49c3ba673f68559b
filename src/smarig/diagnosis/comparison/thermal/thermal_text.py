"""The sentences of a diagnosis of a thermal record."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from smarig.diagnosis.comparison.verdict_rules import RULES
from smarig.diagnosis.comparison.verdict_sentences import verdict_lines
from smarig.diagnosis.diagnosis_text import parameter_text
from smarig.diagnosis.variable_words import variable_experiment

if TYPE_CHECKING:
    from smarig.diagnosis.comparison.thermal.thermal_diagnosis import ThermalDiagnosis


def thermal_lines(d: "ThermalDiagnosis") -> Iterator[str]:
    """The findings, one or two sentences per line; the verdict first."""
    yield from verdict_lines(d.verdict, d.findings, d.causes, _silence(d))
    for effect in () if d.findings else d.candidates:
        values = ", ".join(parameter_text(n, v) for n, v in effect.parameters.items())
        yield f"Candidate, not proved: {effect.name} ({values})."
    yield adequacy_text(d)
    yield _balance(d)
    if d.verdict.depends_on:
        yield variable_experiment(d.verdict.depends_on)
    transients = d.evidence.problem.transients
    if transients < RULES["least_blocks"].value and d.verdict.stands_out:
        count = f"{transients} transients" if transients > 1 else "one transient"
        need = f"{RULES['least_blocks'].value:.0f}"
        yield f"The record has {count}. A cause is named from {need} on: repeat steps of the drive in one run."
    if d.not_testable:
        yield f"Effects that these data cannot show: {', '.join(d.not_testable)}."


def _silence(d: "ThermalDiagnosis") -> str:
    size = 100 * d.gain.base / d.record.span
    return f"Nothing stands out: one heat balance predicts blocks left out of the fit to {size:.2f} % of the range."


def adequacy_text(d: "ThermalDiagnosis") -> str:
    """How far the plain and the extended balance miss the record, against the noise of a reading."""
    gain, extended = d.gain, ""
    if d.candidates:
        names = " and ".join(f.name for f in d.candidates)
        extended = f", with {names} by {gain.extended:.3g} K"
    ratio = gain.base / d.noise if d.noise else float("inf")
    size = f" ({ratio:.0f} × the noise)" if ratio > RULES["adequate"].value else ""
    return (
        f"On {gain.blocks} blocks left out of the fit in turn, a plain heat balance misses the temperature by "
        f"{gain.base:.3g} K rms{size}{extended}; noise of a reading {d.noise:.2g} K."
    )


def _balance(d: "ThermalDiagnosis") -> str:
    effects = {name for f in d.candidates for name in f.parameters}
    values = [parameter_text(n, v) for n, v in d.parameters().items() if n not in effects]
    return f"Heat balance: {', '.join(values)}."
