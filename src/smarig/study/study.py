"""One study: from data files of a stranger to a mapping, runs, a model and a page."""

import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from smarig.core import DataError, SmarigError, UsageError, atomic_file
from smarig.diagnosis import MeasuredDiagnosis, diagnose
from smarig.exchange import unchanged
from smarig.identification import calibrate
from smarig.study.candidate_models import (
    EXTENDED,
    PROPORTIONAL_PART,
    Evaluation,
    evaluate,
    rms_without_cause,
    with_diagnosed,
)
from smarig.study.data_split import DataSplit, split_runs
from smarig.study.function_of_input import function_of_input
from smarig.study.heat_flow_study import calorimetry_of
from smarig.study.imported_runs import ImportedTable, file_title, import_tables
from smarig.study.input_correction import named_correction
from smarig.study.lagging_function import lagging_function
from smarig.study.mapping_draft import mapping_draft
from smarig.study.plane_model import refuse_plane_tables
from smarig.study.questions import StudyCommand, assumed_unit, other_columns
from smarig.study.study_files import STUDY_JSON, STUDY_MODEL, STUDY_PAGE
from smarig.study.study_options import StudyOptions, study_key
from smarig.study.study_page import study_page
from smarig.study.study_result import StudyResult
from smarig.study.transformation_figures import transformation_of
from smarig.study.understanding import Ask, UnsureError, understand
from smarig.study.undetermined_states import undetermined_states
from smarig.study.unpacked_files import with_unpacked

Progress = Callable[[str], None]


@threadpool_limits.wrap(limits=1, user_api="blas")  # small matrices: threads would wait for each other
def study(
    files: Sequence[str | Path],
    out: str | Path,
    options: StudyOptions | None = None,
    *,
    ask: Ask | None = None,
    progress: Progress = lambda _: None,
    name: str = "",
    library: str = "",
) -> StudyResult:
    """Read files, guess what their columns mean, identify and judge models, diagnose, and write ``out``.

    ``ask`` answers questions where a guess is not sure; without it such a guess is a UsageError, and the drafted
    mapping is written to ``out``. ``library`` is the address of the script of the figures for pages that share it.
    Raises UsageError, ConfigError, DataError or StorageError.
    """
    started, options = time.monotonic(), options or StudyOptions()
    paths, folder = tuple(Path(file) for file in files), Path(out)
    if not paths:
        raise UsageError("Name at least one file to study.")
    name = name or (file_title(paths[0]) if len(paths) == 1 else folder.name or "study")
    paths = with_unpacked(paths, folder)
    command = StudyCommand(paths, options, folder)
    with unchanged(paths):
        key = study_key(paths, options)
        folder.mkdir(parents=True, exist_ok=True)
        progress("reading")
        refuse_plane_tables(paths, folder, name, options.units)
        try:
            understood = understand(paths, options, ask, out=folder)
        except UnsureError as error:
            raise UsageError(f"{error} {_saved(mapping_draft(error.guess, name), folder)}") from None
        tables, left_out = import_tables(understood.guesses, folder, options.mapping, name)
    for table in tables:
        progress(f"{table.title}: {len(table.run)} rows")
    split, evaluation, heating, found = None, None, "", calorimetry_of(tables, understood.guesses)
    diagnosis, why_not, without_cause, undetermined, function = None, "", None, None, None
    if found is None and any(table.run.has("position") for table in tables):
        split = split_runs([t for t in tables if t.run.has("position")], options.split, folder)
        try:
            evaluation = evaluate(split, progress)
        except DataError as error:
            raise DataError(f"{error}{other_columns(understood.guesses[0], command)}") from None
        function = function_of_input(evaluation.best, split) or lagging_function(evaluation.best, split)
        diagnosis, why_not = (
            (None, "the output is a function of the input.")
            if function is not None
            else _diagnosed(evaluation, split, options, progress)
        )
        if diagnosis is not None and diagnosis.extended:
            evaluation = with_diagnosed(evaluation, EXTENDED, diagnosis.model, split)
        elif isinstance(diagnosis, MeasuredDiagnosis) and diagnosis.with_proportional_part:
            model = diagnosis.with_proportional_part.model
            evaluation = with_diagnosed(evaluation, PROPORTIONAL_PART, model, split)
        if isinstance(diagnosis, MeasuredDiagnosis) and diagnosis.verdict.word == "named":
            without_cause = rms_without_cause(evaluation, diagnosis.base_model, split)
        undetermined = undetermined_states(split, evaluation.by_history)
        evaluation.best.model.save(folder / STUDY_MODEL, force=True)
    elif found is None:
        heating = _heating(tables)
    result = StudyResult(
        name=name,
        folder=folder,
        files=paths,
        understood=understood,
        tables=tuple(tables),
        left_out=left_out,
        split=split,
        evaluation=evaluation,
        diagnosis=diagnosis,
        diagnosis_reason=why_not,
        without_cause=without_cause,
        undetermined=undetermined,
        heating=heating,
        transformation=transformation_of([table.run for table in tables], named_correction(diagnosis))
        if found is None
        else None,
        calorimetry=found,
        function=function,
        assumed=assumed_unit(understood.guesses[0], command),
        seconds=time.monotonic() - started,
        key=key,
        mapping=options.mapping,
    )
    _write(folder / STUDY_PAGE, study_page(result, library=library))
    _write(folder / STUDY_JSON, json.dumps(plain(result.to_json()), indent=1, ensure_ascii=False))
    return result


def _diagnosed(
    evaluation: Evaluation, split: DataSplit, options: StudyOptions, progress: Progress
) -> tuple[Any, str]:
    """The diagnosis, or None and the reason why there is none."""
    if not options.diagnose:
        return None, "it was not requested."
    progress("looking for the causes of the errors")
    select = split.select[0] if split.select else None
    held_out = () if split.select else split.held_out
    try:
        found = diagnose(evaluation.plain.model, list(split.train), list(held_out), select=select)
    except SmarigError as error:
        return None, str(error)
    return found, ""


def _heating(tables: Sequence[ImportedTable]) -> str:
    """What a record of heating without an output shows."""
    known = "These data have no output. They show how the temperature follows the heating, but no hysteresis."
    try:
        found = calibrate([table.run for table in tables])
        tau = found.to_json()["parameters"].get("tau")
    except (SmarigError, KeyError, AttributeError) as error:
        return f"{known} Its time constant was not found: {error}" if isinstance(error, DataError) else known
    if not tau:
        return known
    low, high = tau["ci95"]
    return f"{known} The time constant of the heating is {tau['value']:.3g} s ({low:.3g} to {high:.3g} s)."


def _saved(draft: str, folder: Path) -> str:
    path = folder / "mapping.toml"
    _write(path, draft)
    return f"The draft is in {path}."


def _write(path: Path, text: str) -> None:
    with atomic_file(path, force=True) as part:
        part.write_text(text, encoding="utf-8")


def plain(value: Any) -> Any:
    """A value without NaN and NumPy types, for JSON."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not np.isfinite(value) else value
