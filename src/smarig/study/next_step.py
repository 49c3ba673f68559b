"""What to do after a study: the run that would tell most, or what the model can be used for."""

from typing import TYPE_CHECKING

from smarig.diagnosis import CommandedDiagnosis, MeasuredDiagnosis, variable_experiment
from smarig.identification import ErrorLevel
from smarig.measurement import measurement_effect_types
from smarig.plant import effect_types
from smarig.study.data_split import LOAD
from smarig.study.runs_by_condition import differing

if TYPE_CHECKING:
    from smarig.study.study_result import StudyResult

_USE = "Use model.json with smarig simulate, verify or track"
_WAY_BACK = "Record the way back, too: without it the data hold no loop."
_INNER = "Record first-order reversal curves: inner loops were not tested."


def next_step(result: "StudyResult") -> str:
    """A sentence; "" where the others have said it: for curves, calorimetry, and missing knowledge."""
    if result.evaluation is None or result.function is not None or result.undetermined is not None:
        return ""
    if result.goes_one_way:
        return _WAY_BACK
    d, step = result.diagnosis, ""
    if d is not None and d.verdict.word in ("named", "ambiguous"):
        step = _of_causes(d)
    elif result.verdict != ErrorLevel.GOOD and (names := _pooled(result)):
        words = " and ".join(name.replace("_", " ") for name in names)
        step = f"Study the runs of each {words} by themselves: one model cannot follow them all."
    elif d is not None and d.verdict.word == "unknown" and d.verdict.depends_on:
        step = variable_experiment(d.verdict.depends_on)
    if step or result.verdict != ErrorLevel.GOOD:
        return step or _of_unexplained(result)
    return f"{_USE}." if result.inner_loops == "fitted" else _INNER


def _pooled(result: "StudyResult") -> list[str]:
    """The conditions in which the runs of one model differ; none for a stress, which models can depend on."""
    names = differing([table.run for table in result.tables])
    return [] if LOAD in names else names


def _of_causes(d: CommandedDiagnosis | MeasuredDiagnosis) -> str:
    """What confirms a cause, or separates those of a set."""
    kinds = {k.name: k.separated_by for k in (*effect_types(), *measurement_effect_types())}
    tests = "; or ".join(dict.fromkeys(kinds[n] for n in d.verdict.names if kinds.get(n)))
    if not tests:
        return ""
    if d.verdict.word == "ambiguous":
        return f"To separate these causes: {tests}."
    if isinstance(d, MeasuredDiagnosis) and d.measured_once:
        again = " and ".join(d.measured_once)
        return f"Repeat the first {again}: another change from run to run would look the same."
    return f"{_USE}: it contains the cause." if d.extended else f"To confirm the cause: {tests}."


def _of_unexplained(result: "StudyResult") -> str:
    """What would tell whether an error without a cause is scatter, or what else it goes with."""
    if result.inner_loops == "none":
        return _INNER
    return "Repeat the run unchanged: the difference is what no model can predict."
