"""A page about one run of any kind: finished, interrupted, imported, without time or without current."""

import numpy as np

from smarig.errors import DataError
from smarig.identification.representation import congruency, wiping_out
from smarig.record import Run
from smarig.report.figure import Figure
from smarig.report.figures_representation import superposed
from smarig.report.figures_run import hysteresis_graph, swing, time_series
from smarig.report.html import Html, bullets, notice, paragraph, table
from smarig.report.page import Section, page
from smarig.report.tables import constants, description
from smarig.report.words import number

_TESTS = {"wiping_out": wiping_out, "congruency": congruency}


def run_page(run: Run) -> str:
    """The page as HTML text; never fails on an empty or interrupted run."""
    sections = [Section("Description", "Description", [description(run), constants(run.meta.get("actuator", ""))])]
    if len(run):
        sections.append(Section("Record", "Record", [time_series(run)]))
        sections += _graphs(run)
    if run.steps:
        sections.append(Section("Steps", "Steps", [_steps(run)]))
    if run.events:
        sections.append(Section("Events", "Events", [_events(run)]))
    title = f"{run.meta.get('protocol') or 'Run'}: {run.path.name}"
    return page(title, repr(run), sections, twin=_simulated(run), notices=notices(run))


def notices(run: Run) -> list[Html]:
    """What must be known before anything else."""
    found = []
    if not run.complete:
        found.append(notice("bad", paragraph(f"This run is incomplete: {run.cause.removeprefix('incomplete: ')}.")))
    elif run.cause != "done":
        found.append(notice("bad", paragraph(f"This run is incomplete: {run.cause}.")))
    if not len(run):
        found.append(notice("warning", paragraph("This run holds no samples.")))
    warnings = run.meta.get("warnings") or []
    if warnings:
        found.append(notice("warning", paragraph("Found in the data:"), bullets(warnings)))
    return found


def _simulated(run: Run) -> bool:
    return run.meta.get("source") in ("twin", "simulation")


def _graphs(run: Run) -> list[Section]:
    sections = []
    inputs, outputs = run.points()
    if inputs.size > 1 and np.ptp(inputs) > 0 and np.isfinite(outputs).any():
        sections.append(Section("Hysteresis", "Hysteresis", [hysteresis_graph(run)]))
    if run.meta.get("protocol") == "initialise" and run.has("input"):
        sections.append(Section("Initialisation", "Initialisation", [swing(run)]))
    test = _TESTS.get(run.meta.get("protocol", ""))
    if test is not None:
        sections.append(Section("Test of representation", "Test", [_tested(run, test)]))
    return sections


def _tested(run: Run, test) -> Figure | Html:
    try:
        return superposed(test(run), _simulated(run))
    except DataError as error:
        return notice("warning", paragraph(str(error)))


def _steps(run: Run) -> Html:
    rows = [
        (s.index, s.branch, number(s.target, 4), number(s.position, 5), s.n, s.verdict.replace("_", " "))
        for s in run.steps[:400]
    ]
    more = f" The first 400 of {len(run.steps)}." if len(run.steps) > 400 else ""
    unit_in, unit = run.input_unit or "1", run.unit or "1"
    head = ("Step", "Branch", f"Target ({unit_in})", f"Position ({unit})", "n", "Verdict")
    return table(head, rows, f"Position is the mean over the last n samples.{more}")


def _events(run: Run) -> Html:
    rows = [(number(e.t_s, 6), e.level, e.kind, e.text) for e in run.events[:300]]
    return table(("Time (s)", "Level", "Kind", "What"), rows, "What happened during the run.")
