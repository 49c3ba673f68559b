"""The result of a study as a value: what was read, how good the model is, and what to do now."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import spaced
from smarig.diagnosis import Diagnosis, MeasuredDiagnosis
from smarig.identification import BETTER, GOOD_RATIO, ErrorLevel, level_against_curves, ratio_text
from smarig.study.candidate_models import Evaluation
from smarig.study.data_split import DataSplit
from smarig.study.error_reasons import error_reasons
from smarig.study.imported_runs import ImportedTable
from smarig.study.understanding import Understanding

GOOD, FAIR, POOR = str(ErrorLevel.GOOD), str(ErrorLevel.FAIR), str(ErrorLevel.POOR)


@dataclass(frozen=True, eq=False)
class StudyResult:
    """What a study found.

    ``evaluation`` and ``split`` are None for data without an output; ``heating`` then describes the temperature record.
    ``diagnosis`` is None if it was not requested or failed, with ``diagnosis_reason``. ``mapping`` is a mapping file
    that was given, None if one was drafted.
    """

    name: str
    folder: Path
    files: tuple[Path, ...]
    understood: Understanding
    tables: tuple[ImportedTable, ...]
    left_out: dict[str, str]
    split: DataSplit | None
    evaluation: Evaluation | None
    diagnosis: Diagnosis | MeasuredDiagnosis | None
    diagnosis_reason: str
    heating: str
    seconds: float
    key: str
    mapping: str | None = None

    @property
    def unit(self) -> str:
        """Unit of the output."""
        return self.tables[0].run.unit

    @property
    def nrmse(self) -> float:
        """Rms error on held-out data over the range of their output."""
        if self.evaluation is None:
            return np.nan
        measured = np.concatenate([r.measured[r.counted] for r in self.evaluation.best.held_out])
        return self.evaluation.best.rms / float(np.ptp(measured)) if np.ptp(measured) else np.nan

    @property
    def noise(self) -> float | None:
        """The noise of one reading: from repeated readings, else as the diagnosis estimates it; None if unknown."""
        if self.evaluation is None:
            return None
        floors = [r.noise_floor for r in self.evaluation.best.held_out if r.noise_floor]
        if floors:
            return float(np.median(floors))
        return self.diagnosis.noise if isinstance(self.diagnosis, MeasuredDiagnosis) else None

    @property
    def gain(self) -> float:
        """Error of the best simple curve over that of the model."""
        if self.evaluation is None or not self.evaluation.simple:
            return np.nan
        return min(self.evaluation.simple.values()) / max(self.evaluation.best.rms, 1e-300)

    @property
    def at_noise(self) -> bool:
        """Whether the noise is known and the error on held-out data is hardly larger."""
        found, noise = self.evaluation, self.noise
        return bool(found and noise is not None and found.best.rms <= GOOD_RATIO * noise)

    @property
    def verdict(self) -> str:
        """ "good", "fair" or "poor"; "" without a model. The thresholds are those of ``verify``."""
        if self.evaluation is None:
            return ""
        found = self.evaluation.best
        unsteady = [r.repeatability for r in found.held_out if r.repeatability.over_readings is not None]
        return str(level_against_curves(found.rms, self.noise, self.nrmse, self.gain, *unsteady[:1]))

    @property
    def reasons(self) -> list[str]:
        """What the data say about an error that is not good: sentences, the most certain first."""
        if self.evaluation is None or self.split is None or self.verdict == GOOD:
            return []
        return error_reasons(self.split, self.evaluation.best)

    def sentences(self) -> list[str]:
        """Three sentences: how good the model is, against what, and what to do now."""
        if self.evaluation is None:
            return [self.heating]
        return [self._error_sentence(), self._simple_sentence(), self._next_sentence()]

    def hints(self) -> list[str]:
        """What would show more, one sentence each."""
        found = []
        timed = any(table.run.has("t_s") or table.run.settled for table in self.tables)
        if not timed and not self.understood.forc and self.evaluation is not None and self.verdict != GOOD:
            found.append(
                "No time is recorded, so lags, creep and rates cannot be tested. If the rows are equally spaced, give "
                "their period: period_s under [time] in mapping.toml, with --map."
            )
        return found

    def _error_sentence(self) -> str:
        best = self.evaluation.best if self.evaluation else None
        if best is None:
            return ""
        what = "fits the data" if self.split and self.split.kind == "none" else "predicts the held-out data"
        noise = f", {ratio_text(best.rms / self.noise)} × the noise of a reading" if self.noise else ""
        words = {GOOD: "good", FAIR: "usable, with errors to explain", POOR: "poor"}[self.verdict]
        return (
            f"The model ({best.name}) {what} with {best.rms:.3g}{spaced(self.unit)} rms, {100 * self.nrmse:.2g} % of "
            f"the output's range{noise}: {words}."
        )

    def _simple_sentence(self) -> str:
        if self.evaluation is None or not self.evaluation.simple:
            return ""
        name, error = min(self.evaluation.simple.items(), key=lambda item: item[1])
        if self.gain >= BETTER:
            return f"The best simple curve ({name}) leaves {self.gain:.2g} × as much, {error:.3g}{spaced(self.unit)}."
        if self.gain >= 1:
            return f"A simple curve ({name}) does nearly as well: {error:.3g}{spaced(self.unit)}."
        return f"A simple curve ({name}) does better: {error:.3g}{spaced(self.unit)}. Do not use the model as it is."

    def _next_sentence(self) -> str:
        d = self.diagnosis
        if d is None:
            return f"No diagnosis: {self.diagnosis_reason}"
        lines = d.text().splitlines()
        shifted = [line for line in lines if "is shifted by" in line][:1]
        return " ".join([_finding(d.verdict.word, d.verdict.depends_on, lines[0], self.at_noise), *shifted])

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line, which is also DIR/study.json."""
        j = self.evaluation
        return {
            "name": self.name,
            "out": str(self.folder),
            "page": str(self.folder / "index.html"),
            "files": [str(file) for file in self.files],
            "verdict": self.verdict or None,
            "sentences": self.sentences(),
            "reasons": self.reasons,
            "hints": self.hints(),
            "questions": self.understood.questions,
            "columns": {}
            if self.mapping
            else {table.title: _columns(g) for table, g in zip(self.tables, self.understood.guesses)},
            "left_out": self.left_out | self.understood.left_out,
            "split": self.split and {"kind": self.split.kind, "reason": self.split.reason},
            "runs": [str(table.run.path) for table in self.tables],
            "model": j and str(self.folder / "model.json"),
            "unit": self.unit or None,
            "held_out": j and {"rms": j.best.rms, "nrmse": self.nrmse, "noise_floor": self.noise},
            "models": j and {c.name: {"train_rms": c.train_rms, "held_out_rms": c.rms} for c in j.candidates},
            "models_that_failed": (j and j.failed) or {},
            "simple_curves": j and j.simple,
            "diagnosis": self.diagnosis
            and {"verdict": self.diagnosis.verdict.word, "text": self.diagnosis.text()},
            "diagnosis_reason": self.diagnosis_reason or None,
            "warnings": [w for table in self.tables for w in table.warnings],
            "seconds": round(self.seconds, 2),
            "key": self.key,
        }


def _finding(word: str, depends_on: str | None, first_line: str, at_noise: bool) -> str:
    """What the diagnosis says of the errors that are left; they look like noise only if they are as small."""
    if word == "silent":
        left = "look like noise" if at_noise else "have no cause that it knows"
        return f"The diagnosis finds nothing: the errors {left}."
    if word == "unknown" and depends_on:
        return f"The errors that are left go with the variable '{depends_on}'; no known effect explains them."
    if word == "unknown":
        return "The errors that are left are more than noise, but no known effect explains them."
    return first_line if first_line.endswith(".") else f"{first_line}."


def _columns(guess: Any) -> dict[str, Any]:
    found = {}
    for c in guess.columns:
        role = guess.roles.get(c.name)
        if role is not None:
            found[c.name] = {
                "role": role.role,
                "quantity": c.quantity or None,
                "unit": c.unit or None,
                "reason": role.reason,
                "unit_reason": c.unit_reason or None,
                "confidence": round(min(role.confidence, c.unit_confidence or 1.0), 2),
            }
    return found
