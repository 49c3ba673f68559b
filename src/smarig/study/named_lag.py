"""The lag of the thermometer that a diagnosis names, and runs whose input is corrected for it."""

from dataclasses import replace

from smarig.core import spaced
from smarig.diagnosis import CommandedDiagnosis, Finding, MeasuredDiagnosis
from smarig.measurement import changed, input_records, measurement_effects
from smarig.record import Run

_LAG = "input_lag"


def named_lag(diagnosis: CommandedDiagnosis | MeasuredDiagnosis | None) -> Finding | None:
    """The lag of the input, if a diagnosis of records with a measured input names it."""
    if not isinstance(diagnosis, MeasuredDiagnosis) or diagnosis.verdict.word != "named":
        return None
    return next((finding for finding in diagnosis.findings if finding.name == _LAG), None)


def without_lag(run: Run, lag: Finding) -> Run:
    """The run with the input that acted instead of the recorded one; settled points do not lag."""
    values = {name: parameter["value"] for name, parameter in lag.parameters.items()}
    effects = measurement_effects([{"name": lag.name, "parameters": values}])
    u = run["input"].copy()
    for record in [] if run.settled else input_records([run]):
        u[record.row] = changed(record, effects).input
    return replace(run, columns={**run.columns, "input": u})


def lag_sentence(lag: Finding) -> str:
    """What was corrected in the transformation temperatures."""
    (parameter,) = lag.parameters.values()
    unit = spaced(parameter["unit"])
    between = " ({:.3g} to {:.3g}{})".format(*parameter["ci95"], unit) if parameter["ci95"] else ""
    return (
        f"These temperatures are corrected for the lag of the thermometer, {parameter['value']:.3g}{unit}{between}; "
        "their intervals do not contain its uncertainty."
    )
