"""A study as JSON."""

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from smarig.study.next_step import next_step
from smarig.study.table_guess import TableGuess

if TYPE_CHECKING:
    from smarig.study.study_result import StudyResult


def study_json(result: "StudyResult") -> dict[str, Any]:
    """The JSON object of the command line, which is also DIR/study.json."""
    j = result.evaluation
    return {
        "name": result.name,
        "out": str(result.folder),
        "page": str(result.folder / "index.html"),
        "files": [str(file) for file in result.files],
        "verdict": result.verdict or None,
        "sentences": result.sentences(),
        "next_step": next_step(result) or None,
        "reasons": result.reasons,
        "hints": result.hints(),
        "questions": result.understood.questions,
        "columns": {}
        if result.mapping
        else {table.title: _columns(g) for table, g in zip(result.tables, result.understood.guesses)},
        "left_out": result.left_out | result.understood.left_out,
        "split": result.split and {"kind": result.split.kind, "reason": result.split.reason},
        "runs": [str(table.run.path) for table in result.tables],
        "model": j and str(result.folder / "model.json"),
        "unit": result.unit or None,
        "held_out": j and {"rms": j.best.rms, "nrmse": result.nrmse, "noise_floor": result.noise},
        "unpredicted_share": j and result.unpredicted,
        "undetermined": result.undetermined and asdict(result.undetermined),
        "transformation": result.transformation and result.transformation.to_json(),
        "field_loops": [loops.to_json() for loops in result.field_loops],
        "calorimetry": result.calorimetry and result.calorimetry.to_json(),
        "function_of_input": result.function and result.function.to_json(),
        "models": j and {c.name: {"train_rms": c.train_rms, "held_out_rms": c.rms} for c in j.candidates},
        "models_that_failed": (j and j.failed) or {},
        "simple_curves": j and j.simple,
        "diagnosis": result.diagnosis
        and {"verdict": result.diagnosis.verdict.word, "text": result.diagnosis.text()},
        "diagnosis_reason": result.diagnosis_reason or None,
        "warnings": [w for table in result.tables for w in table.warnings],
        "seconds": round(result.seconds, 2),
        "key": result.key,
    }


def _columns(guess: TableGuess) -> dict[str, Any]:
    found = {}
    for c in guess.columns:
        if c.name in guess.roles:
            role = guess.shown_role(c.name)
            found[c.name] = {
                "role": role.role,
                "quantity": c.quantity or None,
                "unit": c.unit or None,
                "reason": role.reason,
                "unit_reason": c.unit_reason or None,
                "confidence": round(min(role.confidence, c.unit_confidence or 1.0), 2),
            }
    return found
