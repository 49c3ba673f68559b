"""The page of a study: what was measured, is the model good, what now; the evidence below."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.core import spaced
from smarig.identification import RunVerification
from smarig.report import (
    Figure,
    Html,
    Panel,
    Section,
    axis,
    bullets,
    cards,
    display_unit,
    dots,
    input_title,
    line,
    notice,
    number,
    output_title,
    page,
    paragraph,
    path,
    style,
    summary_with_loop,
    tag,
)
from smarig.report import table as html_table
from smarig.study.column_guess import STATED
from smarig.study.study_result import FAIR, GOOD, StudyResult
from smarig.study.table_guess import TableGuess

Array = NDArray[np.float64]
_MOST_LOOPS = 4
_PALE = 0.45
_BOX = {GOOD: "good", FAIR: "warning"}


def study_page(result: StudyResult, *, library: str = "") -> str:
    """The HTML page of a study; ``library`` is the address of the script of the figures, "" to embed it."""
    sections = [
        Section("Result", "Result", list(_summary(result))),
        *(
            [Section("The model beside simple curves", "Comparison", list(_comparison(result)))]
            if result.evaluation
            else []
        ),
        *([Section("Causes of the errors", "Causes", list(_causes(result)))] if result.evaluation else []),
        Section("Columns and their meaning", "Columns", list(_columns(result))),
        Section("What looks wrong in the data", "Data quality", list(_quality(result))),
        Section("Files", "Files", list(_files(result))),
    ]
    level = _BOX.get(result.verdict, "bad") if result.evaluation else "warning"
    about = summary_with_loop("study", next(iter(result.sentences())), level, result.tables[0].run)
    return page(f"Study of {result.name}", _lead(result), sections, library=library, summary=about)


def _lead(result: StudyResult) -> str:
    run = result.tables[0].run
    what = output_title(run) if run.has("position") else "Temperature"
    rows = sum(len(table.run) for table in result.tables)
    plural = "s" if len(result.tables) > 1 else ""
    return f"{what} against {input_title(run)}; {len(result.tables)} run{plural}, {rows} rows"


def _summary(result: StudyResult) -> Iterator[Html | Figure]:
    first, *rest = [
        s.replace(result.unit, display_unit(result.unit)) if "^" in result.unit else s
        for s in result.sentences()
    ]
    yield notice(
        _BOX.get(result.verdict, "bad") if result.evaluation else "warning", paragraph(tag("b", first))
    )
    yield bullets([*rest, *result.reasons, *result.hints()])
    if result.evaluation is not None:
        yield _loops_figure(result)
        yield paragraph(result.split.reason if result.split else "")


def _loops_figure(result: StudyResult) -> Figure:
    """Measured and predicted loops of the held-out runs."""
    best = result.evaluation.best if result.evaluation else None
    runs = best.held_out[:_MOST_LOOPS] if best else ()
    run = result.tables[0].run
    layout = {"xaxis": axis(input_title(run)), "yaxis": axis(output_title(run))}
    panels = [Panel(_traces(r), layout, 460, wide=len(runs) == 1) for r in runs]
    more = len(best.held_out) - len(runs) if best else 0
    held = (
        "Data that were fitted."
        if result.split and result.split.kind == "none"
        else "Data that the fit has not seen."
    )
    further = "1 further run is" if more == 1 else f"{more} further runs are"
    caption = [held, f"{further} not drawn." if more else ""]
    return Figure(panels, "Measured and predicted output.", caption, "")


def _traces(r: RunVerification) -> list[dict]:
    """The measured loop and the model over it, as continuous paths."""
    if not r.counted.all() and _scattered(r.counted):  # curves of a selection: each is a path of its own
        return _curves(r)
    keep = path(r.input, r.measured)
    shown = np.where(r.counted, r.predicted, np.nan)[keep]
    u = r.input[keep]
    many = r.input.size > 300
    measured = line(u, r.measured[keep], "measured", style.INK, width=1.6, opacity=_PALE)
    if not many:
        return [
            measured,
            dots(r.input, r.measured, "readings", style.INK, size=4),
            line(u, shown, "model", style.MODEL, width=1.3),
        ]
    return [measured, line(u, shown, "model", style.MODEL, width=1.3)]


def _scattered(counted: NDArray[np.bool_]) -> bool:
    return int(np.sum(np.diff(counted.astype(int)) != 0)) > 4


def _curves(r: RunVerification) -> list[dict]:
    """Some of the selected curves, apart from each other."""
    edges = np.flatnonzero(np.diff(r.counted.astype(int)) != 0) + 1
    parts = [p for p in np.split(np.arange(r.counted.size), edges) if r.counted[p[0]]]
    chosen = [parts[k] for k in np.unique(np.linspace(0, len(parts) - 1, 25).astype(int))]
    gap = np.array([np.nan])

    def joined(values: Array) -> Array:
        return np.concatenate([np.concatenate([values[p], gap]) for p in chosen])

    u = joined(r.input)
    return [
        line(u, joined(r.measured), "measured", style.INK, width=1.6, opacity=_PALE),
        line(u, joined(r.predicted), "model", style.MODEL, width=1.1),
    ]


def _comparison(result: StudyResult) -> Iterator[Html]:
    evaluation = result.evaluation
    if evaluation is None:
        return
    unit = f" ({display_unit(result.unit)})" if spaced(result.unit) else ""
    noise = f"noise {number(result.noise, 2)}" if result.noise else "noise not known: nothing repeats"
    simple = min(evaluation.simple.values(), default=np.nan)
    yield cards(
        [
            (f"Error, rms{unit}", number(evaluation.best.rms), noise),
            ("Of the output's range", f"{number(100 * result.nrmse, 2)} %", "rms error"),
            (f"Best simple curve, rms{unit}", number(simple), f"{number(result.gain, 2)} × the model's"),
        ]
    )
    rows = [(c.name, "model", number(c.train_rms), number(c.rms)) for c in evaluation.candidates]
    rows += [
        (name, "simple curve", "", number(rms))
        for name, rms in sorted(evaluation.simple.items(), key=lambda i: i[1])
    ]
    held = "fitted data" if result.split and result.split.kind == "none" else "held-out data"
    yield html_table(
        ("Name", "Kind", f"Fitted data, rms{unit}", f"{held.capitalize()}, rms{unit}"), rows, "Errors."
    )
    per_run = [
        (
            _title(r),
            str(r.settled.n),
            number(r.settled.rms),
            number(100 * r.settled.rms / (np.ptp(r.measured[r.counted]) or np.nan), 2),
            "fitted" if r.offset_kind == "fitted" else "known",
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


def _title(r: RunVerification) -> str:
    return r.run.rsplit("/", 1)[-1].removesuffix(".run.sqlite")


def _causes(result: StudyResult) -> Iterator[Html]:
    if result.diagnosis is None:
        yield paragraph(f"No diagnosis: {result.diagnosis_reason}")
        return
    lines = result.diagnosis.text().splitlines()
    yield paragraph(tag("b", result.sentences()[-1]))
    yield bullets(lines[1:])


def _columns(result: StudyResult) -> Iterator[Html]:
    if result.understood.forc:
        yield paragraph("A file of reversal curves states its own columns and units.")
        return
    if result.mapping is not None:
        yield paragraph(f"The columns are used as the given mapping {result.mapping} describes them.")
        return
    guess = result.understood.guesses[0]
    yield html_table(
        ("Column", "Used as", "Quantity", "Unit", "Range", "Step", "Looks", "Why"),
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
        role, f = guess.roles[c.name], c.facts
        unit = f"{display_unit(c.unit)}" + (" (assumed)" if c.unit and c.unit_confidence <= 0.5 else "")
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
