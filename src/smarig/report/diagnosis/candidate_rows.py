"""Rows of candidates in figures: names, gains in nats, and an axis that is linear near 0 and logarithmic beyond."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from smarig.diagnosis import CandidateScore, Diagnosis
from smarig.report.components.figure import axis
from smarig.report.components.numbers import thousands
from smarig.report.components.style import FIRST, SECOND
from smarig.report.diagnosis.diagnosis_predictions import Array

NAMED, GENERIC = FIRST, SECOND  # an effect of the catalogue; a smooth function of a variable


def top_candidates(d: Diagnosis, named: int = 6, plain: int = 4) -> list[CandidateScore]:
    """The single candidates with the largest gains above chance, named and generic; at least three, best first."""
    by_net = sorted(d.first.scores, key=lambda s: -s.net)
    named_effects = [s for s in by_net if not s.candidate.generic][:named]
    found = [*named_effects, *[s for s in by_net if s.candidate.generic][:plain]]
    found.sort(key=lambda s: -s.net)
    return found[: max(3, sum(s.net > 0.5 for s in found))]


def candidate_name(score: CandidateScore) -> str:
    """A candidate's displayed name: "resistance depends on time" for a generic one."""
    name, _, of = score.candidate.name.lstrip("?").partition(" of ")
    return f"{of or 'position'} depends on {name}" if score.candidate.generic else name


def nats_text(value: float) -> str:
    """A gain rounded to a tenth, from 100 to an integer.

    >>> nats_text(2653.9), nats_text(6.28), nats_text(-0.002), nats_text(-2.5)
    ('2\u202f654', '6.3', '0', '−2.5')
    """
    if abs(value) < 0.05:
        return "0"
    return (f"{value:.1f}" if abs(value) < 100 else thousands(round(value))).replace("-", "−")


def row_positions(count: int) -> Array:
    """Positions of rows from top to bottom."""
    return np.arange(float(count))[::-1]


def rows_layout(names: Sequence[str], rows: Array, title: str, values: Sequence[float]) -> dict[str, Any]:
    """A layout with a name on each row and an axis that is linear near 0 and logarithmic beyond."""
    upright = axis("", tickvals=rows.tolist(), ticktext=list(names), range=[-0.7, len(names) - 0.3], ticks="")
    return {"xaxis": arcsinh_axis(title, min(values), max(values)), "yaxis": upright, "showlegend": False}


def arcsinh_axis(title: str, low: float, high: float) -> dict[str, Any]:
    """An axis for arcsinh of a quantity, with the values of the quantity at its ticks."""
    sizes = np.array([1.0, 3.0]) * 10.0 ** np.arange(0, 9)[:, None]
    every = np.concatenate([-sizes.ravel()[::-1], [0.0], sizes.ravel()])
    ends = np.arcsinh([min(low, 0.0), max(high, 1.0)])
    room = 0.3 * float(np.ptp(ends))
    ends = [float(ends[0]) - (room if low < 0 else 0.0), float(ends[1]) + room]
    shown = [v for v in every.tolist() if ends[0] <= np.arcsinh(v) <= ends[1]]
    shown = [v for v in shown if v == 0 or len(shown) < 9 or abs(v) in sizes[:, 0]]
    texts = [_tick_text(v) for v in shown]
    return axis(title, tickvals=np.arcsinh(shown).tolist(), ticktext=texts, tickangle=0, range=ends)


def _tick_text(value: float) -> str:
    """A round number, with powers of ten from 10 000."""
    power = int(np.log10(max(abs(value), 1.0)) + 1e-9)
    plain = f"{value:g}" if power < 4 else f"{value / 10**power:g}·10<sup>{power}</sup>"
    return plain.replace("-", "−").replace("1·10<", "10<")
