"""What a diagnosis names of the thermometer, its lag or its drift, and runs whose input is corrected for it."""

from dataclasses import replace

from smarig.core import spaced
from smarig.diagnosis import CommandedDiagnosis, Finding, MeasuredDiagnosis
from smarig.measurement import changed, input_records, measurement_effects
from smarig.record import Run

CORRECTED = {"input_lag": "lag", "input_drift": "drift"}  # what a wire's temperatures do not follow


def named_correction(diagnosis: CommandedDiagnosis | MeasuredDiagnosis | None) -> Finding | None:
    """The lag or the drift of the input, if a diagnosis of records with a measured input names it."""
    if not isinstance(diagnosis, MeasuredDiagnosis) or diagnosis.verdict.word != "named":
        return None
    return next((finding for finding in diagnosis.findings if finding.name in CORRECTED), None)


def corrected_run(run: Run, finding: Finding) -> Run:
    """The run with the input that acted instead of the recorded one; settled points stay, for they do not lag."""
    values = {name: parameter["value"] for name, parameter in finding.parameters.items()}
    effects = measurement_effects([{"name": finding.name, "parameters": values}])
    u = run["input"].copy()
    for record in [] if run.settled else input_records([run]):
        u[record.row] = changed(record, effects).input
    return replace(run, columns={**run.columns, "input": u})


def correction_sentence(finding: Finding) -> str:
    """What was corrected in the transformation temperatures."""
    (parameter,) = finding.parameters.values()
    unit = spaced(parameter["unit"])
    between = " ({:.3g} to {:.3g}{})".format(*parameter["ci95"], unit) if parameter["ci95"] else ""
    return (
        f"These temperatures are corrected for the {CORRECTED[finding.name]} of the thermometer, "
        f"{parameter['value']:.3g}{unit}{between}; their intervals do not contain its uncertainty."
    )
