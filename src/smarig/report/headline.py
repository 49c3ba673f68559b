"""The five numbers that matter of a characterisation, each with what it means."""

import numpy as np

from smarig.report.conditions import count_size, duration_s, marks
from smarig.report.evidence import Evidence
from smarig.report.figures_density import density_unit
from smarig.report.html import Html, cards, joined
from smarig.report.identified import report_of
from smarig.report.numbers import duration, number
from smarig.report.tables_model import M_P, M_PC, pooled_rms

_Card = tuple[str, str | Html, str | Html]


def headline(e: Evidence) -> Html:
    """Travel, held-out error with its noise floor, class of μ, duration, points."""
    return cards([_travel(e), _error(e), _class(e), _duration(e), _points(e)])


def _travel(e: Evidence) -> _Card:
    outputs = [run.points()[1] for run in e.runs.values() if len(run.settled) >= 2]
    if not outputs:
        return "Travel", "unknown", "no settled points"
    run = next(r for r in e.runs.values() if len(r.settled) >= 2)
    # Runs of one sitting may be zeroed differently: the widest single run counts.
    travel = max(float(np.ptp(y)) for y in outputs)
    size = count_size(run)
    counts = f"{travel / size:.0f} counts, " if size else ""
    return "Travel", f"{travel:.4g} {run.unit}", f"{counts}settled points, widest run"


def _error(e: Evidence) -> _Card:
    judged = e.verifications.get(e.chosen)
    rms = pooled_rms(judged)
    if judged is None or rms is None:
        return "Model error on held-out data, rms", "unknown", "no held-out run"
    floors = [r.noise_floor for r in judged.runs if r.noise_floor]
    floor = f"noise floor {max(floors):.2g} {judged.unit}" if floors else "noise floor unknown"
    share = max(r.settled.nrmse for r in judged.runs)
    n = sum(r.settled.n for r in judged.runs)
    return (
        "Model error on held-out data, rms",
        f"{rms:.3g} {judged.unit}",
        f"{floor}; {100 * share:.2f} % of travel, n = {n}",
    )


def _class(e: Evidence) -> _Card:
    if e.best is None:
        return "Class of μ", "unknown", "no model"
    d = report_of(e.best)
    run = next(iter(e.runs.values()))
    name = joined(["in ", M_P]) if d.M_P else joined(["not in ", M_P])
    wider = joined(["in ", M_PC, "; "]) if d.M_PC and not d.M_P else ""
    least = f"{e.chosen} surface, min μ = {number(d.mu_min)} {density_unit(run)}"
    return "Class of μ", name, joined([wider, least])


def _duration(e: Evidence) -> _Card:
    total = float(np.nansum([duration_s(run) for run in e.runs.values()]))
    return "Rig time", duration(total), f"{len(e.runs)} runs; computed in {e.seconds:.1f} s"


def _points(e: Evidence) -> _Card:
    late = sum(marks(run).timed_out for run in e.runs.values())
    n = sum(len(run.settled) for run in e.runs.values())
    used = f"{len(e.best.data)} FOD points on {e.best.data.curves} curves; " if e.best else ""
    return "Settled points", str(n - late), f"{used}{late or 'no'} hold{'' if late == 1 else 's'} timed out"
