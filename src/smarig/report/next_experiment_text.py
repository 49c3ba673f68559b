"""The next experiment in words: the run that separates what is left, or what each effect needs to be told apart.

Proposes nothing by itself; knows nothing of figures.
"""

from collections.abc import Iterator

from smarig.diagnosis.diagnose import Diagnosis
from smarig.plant.effect_catalogue import effect_types
from smarig.report.diagnosis_text import distinguishing_text
from smarig.report.html import Html, bullets, notice, paragraph, tag
from smarig.report.numbers import duration


def next_experiment(d: Diagnosis) -> Iterator[Html]:
    """The run asked for, or advice by verdict."""
    run = d.separating_run
    if run is not None:
        hours = run.get("rig_hours")
        time = f", {duration(3600 * float(hours))} on the rig" if hours is not None else ""
        yield notice("good", paragraph(tag("b", f"{run['protocol']}{time}")), paragraph(str(run["why"])))
        return
    yield from _advice(d)


def _advice(d: Diagnosis) -> Iterator[Html]:
    types = {t.name: t for t in effect_types()}
    word, names = d.verdict.word, d.verdict.names
    if word == "unknown":
        yield paragraph(
            f"Change {d.verdict.depends_on} alone, with everything else as it was: what that changes in the "
            "residuals is the effect by itself."
        )
    elif word == "silent" and not d.first.silent:
        yield paragraph("The same run once more: what is no noise comes again.")
    elif word == "silent":
        yield paragraph(
            "Nothing asks for an experiment. Section “What could not have been seen” says what might still hide."
        )
    elif word == "not_identifiable":
        yield paragraph("A run that can show something at all: see what would show each effect above.")
    else:
        yield paragraph(
            "What would settle it:" if word == "ambiguous" else "What would confirm it independently:"
        )
    if names and word in ("named", "ambiguous"):
        yield bullets(distinguishing_text(types[n]) for n in names)
    elif names:
        yield paragraph("What would confirm or rule out the nearest names:")
        yield bullets(distinguishing_text(types[n]) for n in names)
