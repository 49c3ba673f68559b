"""The page of a diagnosis: what the model misses, why, what could not have been seen, what was gained.

Puts figures, tables and sentences in order; decides nothing.
"""

from collections.abc import Iterator

from smarig.diagnosis.diagnose import Diagnosis
from smarig.model.planted import kinds
from smarig.report.conditions import exact_unit, label_of, protocol_of
from smarig.report.diagnosed import Replay
from smarig.report.diagnosis_next import next_experiment
from smarig.report.diagnosis_noise import noise_words
from smarig.report.diagnosis_summary import summary
from smarig.report.diagnosis_words import apart
from smarig.report.figure import Figure
from smarig.report.figures_detection import detection_figure
from smarig.report.figures_gain import gain_figure
from smarig.report.figures_lookalikes import lookalikes_figure
from smarig.report.figures_offset import temperature_figure
from smarig.report.figures_residuals import channel_figure, residual_figure
from smarig.report.figures_rivals import rivals_figure
from smarig.report.html import Html, bullets, notice, paragraph, tag
from smarig.report.numbers import duration
from smarig.report.page import Section, page
from smarig.report.run_page import endings, lead
from smarig.report.tables import conditions_table, marks_table, provenance_table
from smarig.report.tables_diagnosis import explanations_table, singles_table, visibility_table

Parts = Iterator[Html | Figure]


def diagnosis_page(d: Diagnosis) -> str:
    """One self-contained page (HTML) of a diagnosis, for ``write_page``."""
    replay = Replay.of(d)
    sections = [Section(title, short, list(parts(replay))) for title, short, parts in _SECTIONS]
    runs = d.story.runs
    return page(
        "Diagnosis: what the model misses",
        f"{lead(runs[0])}; model {d.model.name}",
        [section for section in sections if section.parts],
        label=label_of(*runs),
        notices=endings(list(runs)),
    )


def _summary(replay: Replay) -> Parts:
    yield from summary(replay.d)


def _residuals(replay: Replay) -> Parts:
    d = replay.d
    if replay.extended is None:
        yield paragraph("No effect was added to the model, so there is no picture after.")
    yield residual_figure(replay)
    for figure in (channel_figure(replay), temperature_figure(replay)):
        if figure:
            yield figure
    if d.error.base > 1.5 * d.error.given:
        yield notice(
            "warning",
            paragraph(
                f"The density identified anew by the diagnosis fits its own data less well than the model as given: "
                f"{d.error.base:.3g} against {d.error.given:.3g} {exact_unit(d.error.unit)} rms. Part of what is drawn "
                "above may be that density's. The verdict rests on the critic, which allows for any smooth density."
            ),
        )


def _rivals(replay: Replay) -> Parts:
    d = replay.d
    if d.levels:
        yield explanations_table(d)
    yield singles_table(d)
    yield rivals_figure(d)


def _detection(replay: Replay) -> Parts:
    yield detection_figure(replay.d)
    blind = [s.candidate.name for s in replay.d.first.scores if not s.candidate.traces.shape[1]]
    if blind:
        yield paragraph(f"Not judged, because these data cannot show them: {', '.join(blind)}.")


def _noise(replay: Replay) -> Parts:
    yield from noise_words(replay.d)


def _visibility(replay: Replay) -> Parts:
    d, v = replay.d, replay.d.visibility
    known = {k.name: k for k in kinds()}
    yield visibility_table(d, known)
    if v.invisible:
        yield paragraph(tag("b", "What these data cannot show at any strength, and what would show it:"))
        yield bullets(apart(known[n]) for n in v.invisible)
    else:
        yield paragraph(
            f"All {len(v.names)} effects of the catalogue would be seen in these data at some strength."
        )
    figure = lookalikes_figure(v, d)
    if figure:
        yield figure
    alike = [n for n in v.names if v.group(n)]
    if alike:
        yield paragraph(tag("b", "What tells look-alikes apart:"))
        yield bullets(apart(known[n]) for n in alike)


def _held_out(replay: Replay) -> Parts:
    d = replay.d
    if d.gain is None:
        yield paragraph(
            "No held-out run was given, so it is unknown what the effects gain outside their own data."
        )
        return
    yield gain_figure(d.gain, d)


def _next(replay: Replay) -> Parts:
    yield from next_experiment(replay.d)


def _provenance(replay: Replay) -> Parts:
    d = replay.d
    runs = {f"{k}. {protocol_of(run)}": run for k, run in enumerate(d.story.runs, start=1)}
    yield conditions_table(d.story.runs[0])
    yield marks_table(runs)
    yield provenance_table(runs)
    yield paragraph(
        f"Learned from the runs above; model {d.model.name}; {d.nulls} nulls, α = {d.alpha:g}. "
        f"Computed in {duration(d.seconds)}."
    )


_SECTIONS = (
    ("Verdict", "Verdict", _summary),
    ("What the model misses", "Residuals", _residuals),
    ("Rivals", "Rivals", _rivals),
    ("Is anything wrong at all?", "Detection", _detection),
    ("Noise floor and numerics", "Noise", _noise),
    ("What could not have been seen", "Visibility", _visibility),
    ("Gain on held-out blocks", "Gain", _held_out),
    ("The next experiment", "Next", _next),
    ("Rig, honest numbers, provenance", "Provenance", _provenance),
)
