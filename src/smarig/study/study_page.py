"""The page of a study: what was measured, is the model good, what now; the evidence below."""

from collections.abc import Iterator, Sequence

import numpy as np

from smarig.core import spaced
from smarig.identification import ratio_text
from smarig.report import (
    Figure,
    Html,
    Section,
    branches_text,
    bullets,
    cards,
    display_unit,
    figure_with_text,
    figures_table,
    input_title,
    notice,
    number,
    output_title,
    page,
    paragraph,
    stress_figure,
    stress_table,
    summary_with_loop,
    tag,
    tangent_figure,
    titled,
)
from smarig.report import table as html_table
from smarig.study.column_guess import STATED
from smarig.study.heat_flow_page import heat_flow_figure, heat_flow_notes, heat_flow_table
from smarig.study.heat_flow_sentences import missing_sentences
from smarig.study.key_figures import key_figures, temperatures_by_run
from smarig.study.next_step import next_step
from smarig.study.study_figure import heating_figure, loop_figure, other_loops, run_title, shown_run
from smarig.study.study_files import VERDICT_LEVELS
from smarig.study.study_result import StudyResult
from smarig.study.table_guess import TableGuess
from smarig.transformation import RunFigures

_MOST_DRAWN = 8  # runs whose tangents are drawn


def study_page(result: StudyResult, *, library: str = "") -> str:
    """The HTML page of a study; ``library`` is the address of the script of the figures, "" to embed it."""
    has_model = result.evaluation is not None
    sections = [
        Section("", "Result", list(_summary(result))),
        *(
            [Section("Transformation temperatures", "Temperatures", list(_temperatures(result)))]
            if result.transformation
            else []
        ),
        *(
            [Section("Tangents and figures of each run", "Tangents", list(_each_run(runs)), folded=True)]
            if len(runs := result.transformation.runs if result.transformation else ()) > 1
            else []
        ),
        *(
            [Section("What the curve says", "Curve", list(heat_flow_notes(result.calorimetry)))]
            if result.calorimetry
            else []
        ),
        *(
            [Section("The model beside simple curves", "Comparison", list(_comparison(result)))]
            if has_model
            else []
        ),
        *([Section("Causes of the errors", "Causes", list(_causes(result)))] if has_model else []),
        Section("Columns and their meaning", "Columns", list(_columns(result))),
        Section("What looks wrong in the data", "Data quality", list(_quality(result))),
        Section("Files", "Files", list(_files(result))),
    ]
    run = shown_run(result)
    drawn = next((t.run for t in result.tables if run and str(t.run.path) == run.run), result.tables[0].run)
    about = summary_with_loop("study", next(iter(result.sentences())), _level(result), drawn)
    return page(_title(result), _lead(result), sections, library=library, summary=about)


def _title(result: StudyResult) -> str:
    """The wire and date where the files state them, else the name of the file or folder."""
    runs = [table.run for table in result.tables]
    return (
        titled("Study", runs)
        if any(run.info.wire for run in runs)
        else titled(f"Study of {result.name}", runs)
    )


def _level(result: StudyResult) -> str:
    if result.calorimetry is not None:
        return "warning" if any(c.why_not for c in result.calorimetry.cycles) else "good"
    if result.function is not None:
        return "good"
    return VERDICT_LEVELS[result.verdict] if result.evaluation else "warning"


def _lead(result: StudyResult) -> str:
    run = result.tables[0].run
    what = output_title(run) if run.has("position") else "Temperature"
    rows = sum(len(table.run) for table in result.tables)
    plural = "s" if len(result.tables) > 1 else ""
    return f"{what} against {input_title(run)}; {len(result.tables)} run{plural}, {rows} rows"


def _summary(result: StudyResult) -> Iterator[Html | Figure]:
    """The first screen: three sentences, and the loop with its figures and what explains the error beside it."""
    first, *rest = result.sentences()
    if result.calorimetry is not None:
        rest = [*missing_sentences(result.calorimetry), *rest[-1:]]  # the table has the temperatures
    further = " ".join(s for s in rest if s)
    step = next_step(result)
    parts = [paragraph(further)] if further else []
    parts += [paragraph(tag("b", "Next: "), step)] if step else []
    yield notice(_level(result), paragraph(tag("b", first)), *parts)
    if result.calorimetry is not None:
        yield heat_flow_figure(result.calorimetry, result.tables[0].run)
        yield heat_flow_table(result.calorimetry)
        return
    figure = loop_figure(result) or heating_figure([t.run for t in result.tables])
    if figure is None:
        return
    shown = shown_run(result)
    if shown is None:
        yield figure
        return
    run = next((t.run for t in result.tables if str(t.run.path) == shown.run), result.tables[0].run)
    yield figure_with_text(figure, *key_figures(result, run), bullets([*result.reasons, *result.hints()]))


def _temperatures(result: StudyResult) -> Iterator[Html | Figure]:
    """The transformation temperatures of all runs, their dependence on stress, and why runs have none."""
    found = result.transformation
    if found is None:
        return
    if found.correction:
        yield paragraph(found.correction)
    if found.result is not None:
        slopes = stress_figure(found.result.runs, found.result.stress)
        if slopes:
            yield from (slopes, stress_table(found.result.stress))
        if len(found.runs) > 1:
            yield temperatures_by_run(
                found.runs, caption="Figures of all runs, means over their cycles.", stacked=True
            )
        else:
            yield from _each_run(found.runs)
        yield from (branches_text(run) for run in found.result.runs if run.notes or run.unused)
    if found.left_out:
        yield html_table(
            ("Run", "Why it has none"),
            list(found.left_out.items()),
            "Runs without transformation temperatures.",
        )


def _each_run(runs: Sequence[RunFigures]) -> Iterator[Html | Figure]:
    """The tangents of each run on its loop, and its figures with intervals."""
    for k, run in enumerate(runs):
        if k < _MOST_DRAWN:
            yield tangent_figure(run)
        yield figures_table(run)


def _comparison(result: StudyResult) -> Iterator[Html | Figure]:
    evaluation = result.evaluation
    if evaluation is None:
        return
    unit = f" ({display_unit(result.unit)})" if spaced(result.unit) else ""
    noise = f"noise {number(result.noise, 2)}" if result.noise else "noise not known: nothing repeats"
    simple = min(evaluation.simple.values(), default=np.nan)
    where = " on left-out blocks" if result.compared_on_left_out else ""
    yield cards(
        [
            (f"Error, rms{unit}", number(evaluation.best.rms), noise),
            ("Of the output's range", f"{number(100 * result.nrmse, 2)} %", "rms error"),
            (
                f"Best simple curve, rms{unit}",
                number(simple),
                f"{ratio_text(result.gain)} × the model's{where}",
            ),
        ]
    )
    rows = [(c.name, "model", number(c.train_rms), number(c.rms)) for c in evaluation.candidates]
    rows += [
        (name, "simple curve", "", number(rms))
        for name, rms in sorted(evaluation.simple.items(), key=lambda i: i[1])
    ]
    header = ("Name", "Kind", f"Fitted data, rms{unit}", f"Held-out data, rms{unit}")
    if result.split and result.split.kind == "none":  # nothing is held out: one column of errors
        header, rows = header[:3], [(name, kind, rms) for name, kind, _, rms in rows]
    yield html_table(header, rows, "Errors.")
    others = other_loops(result)
    if others is not None:
        yield others
    per_run = [
        (
            run_title(r),
            str(r.settled.n),
            number(r.settled.rms),
            number(100 * r.settled.rms / (np.ptp(r.measured[r.counted]) or np.nan), 2),
            "fitted" if r.offset_kind == "fitted" else "of the model",
        )
        for r in evaluation.best.held_out
    ]
    yield html_table(
        ("Run", "Points", f"rms{unit}", "% of range", "Zero"), per_run, "The best model, run by run."
    )
    yield bullets([f"Not fitted: {name}. {why}" for name, why in evaluation.failed.items()])
    yield bullets(_remarks(result))


def _remarks(result: StudyResult) -> list[str]:
    """What the fit and the test found, each once; curves of one run that the fit has not seen are not fitted ones."""
    if result.evaluation is None:
        return []
    best = result.evaluation.best
    found = dict.fromkeys([*best.warnings, *(w for r in best.held_out for w in r.warnings)])
    apart = result.split is not None and result.split.select is not None
    return [w for w in found if not (apart and w.startswith("The model was fitted to this run"))]


def _causes(result: StudyResult) -> Iterator[Html]:
    if result.diagnosis is None:
        yield paragraph(f"No diagnosis: {result.diagnosis_reason}")
        return
    yield paragraph(tag("b", result.sentences()[-1]))
    yield bullets(result.diagnosis.lines()[1:])


def _columns(result: StudyResult) -> Iterator[Html]:
    if result.understood.forc:
        yield paragraph("A file of reversal curves states its own columns and units.")
        return
    if result.mapping is not None:
        yield paragraph(f"The columns are used as the given mapping {result.mapping} describes them.")
        return
    guess = result.understood.guesses[0]
    yield html_table(
        ("Column", "Used as", "Quantity", "Unit", "Range", "Step", "Course", "Why"),
        list(_rows(guess)),
        "Columns of the file.",
        stacked=True,
    )
    if guess.sign:
        yield paragraph(f"Sign of the output: {guess.sign}.")
    yield paragraph(
        "Wrong? Correct mapping.toml in this folder and give it with --map, or name a column with --input, "
        "--output, or --unit NAME=UNIT."
    )


def _rows(guess: TableGuess) -> Iterator[Sequence[str]]:
    for c in guess.columns:
        role, f = guess.shown_role(c.name), c.facts
        unit = f"{display_unit(c.unit)}" + (" (assumed)" if c.unit_is_assumed else "")
        why = role.reason + (
            f"; unit: {c.unit_reason}" if c.unit_reason and c.unit_confidence < STATED else ""
        )
        extent = f"{number(f.low, 5)} … {number(f.high, 5)}" if f.known.size else ""
        yield (
            c.name,
            role.role,
            c.quantity,
            unit,
            extent,
            number(f.step, 2) if f.known.size else "",
            f.looks(),
            why,
        )


def _quality(result: StudyResult) -> Iterator[Html]:
    found = [f"{table.title}: {sentence}" for table in result.tables for sentence in table.warnings]
    yield bullets(found) if found else paragraph("Nothing looks wrong.")


def _files(result: StudyResult) -> Iterator[Html]:
    rows = [(table.title, str(len(table.run)), table.run.path.name) for table in result.tables]
    yield html_table(("Table", "Rows", "Run"), rows, "Tables that were used.")
    left_out = result.left_out | result.understood.left_out
    if left_out:
        yield html_table(("File or table", "Why it was left out"), list(left_out.items()), "Left out.")
    made = (
        "runs/, study.json" if result.mapping else "mapping.toml (what the columns mean), runs/, study.json"
    )
    made += ", model.json (for smarig verify, simulate and diagnose)" if result.evaluation else ""
    yield paragraph(f"In this folder: {made}. Computed in {number(result.seconds, 2)} s.")
