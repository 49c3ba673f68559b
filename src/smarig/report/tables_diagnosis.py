"""Tables of a diagnosis: rival explanations, single candidates, what could have been seen.

Knows nothing of figures and of the page's order.
"""

from collections.abc import Mapping

import numpy as np

from smarig.diagnosis.candidates import SEEN
from smarig.diagnosis.diagnose import Diagnosis
from smarig.diagnosis.visibility import SAME
from smarig.model.effect import Kind
from smarig.report.candidate_rows import called, nats, singles
from smarig.report.diagnosis_words import explanation, unit_of
from smarig.report.html import Html, table, tag
from smarig.report.numbers import number


def explanations_table(d: Diagnosis) -> Html:
    """The explanations that competed last, all their parameters, nats and probabilities."""
    level, known = d.levels[-1], dict(d.verdict.explanations)
    rivals = [
        (explanation(r.effects, {}), nats(level.lead(k)), _chance(known.get(r.names)))
        for k, r in enumerate(level.explanations)
        if k > 0
    ]
    best = explanation(level.best.effects, level.best.spread)
    return table(
        ("Explanation", "Nats behind the best", "Probability"),
        [(tag("b", best), "0", _chance(known.get(level.best.names))), *rivals],
        "Explanations that competed last, best first, every parameter fitted to all readings at once. The best gains "
        f"{nats(level.gain)} nats over {_smaller(d)}.",
    )


def _smaller(d: Diagnosis) -> str:
    return "the best with one effect less" if len(d.levels) > 1 else "the base model"


def _chance(p: float | None) -> str:
    if p is None:
        return "–"
    return "< 0.001" if p < 1e-3 else "> 0.999" if p > 0.999 else f"{p:.3f}"


def singles_table(d: Diagnosis) -> Html:
    """The candidates that gain most by themselves, beside what chance gains."""
    rows = [
        (
            called(s),
            nats(s.net),
            nats(s.high - s.median),
            nats(s.standard),
        )
        for s in singles(d)
    ]
    return table(
        (
            "Candidate by itself",
            "Gain beyond chance (nats)",
            "Chance: 95 % of nulls stay below (nats)",
            "In spreads",
        ),
        rows,
        "The candidates that gain most by themselves, on the first critique. A generic one that gains much more than "
        "any name is the sign of a cause that is not in the catalogue.",
    )


def visibility_table(d: Diagnosis, known: Mapping[str, Kind]) -> Html:
    """Every effect of the catalogue: size of its trace, least strength found, who imitates it."""
    v = d.visibility
    rows = []
    for k in np.argsort(-v.delta).tolist():
        name = v.names[k]
        p = known[name].primary
        seen = v.delta[k] > 0
        unit = unit_of(p.unit)
        rows.append(
            (
                name,
                f"{number(abs(p.typical))}{unit}",
                number(float(v.delta[k])) if seen else "0",
                f"{number(float(v.least[k]), 2)}{unit}" if seen else "none",
                ", ".join(v.group(name)) or "no one",
            )
        )
    return table(
        ("Effect", "Typical strength", "δ at typical strength", "Least strength seen", "Who imitates it"),
        rows,
        f"What these data could have shown. δ: size of an effect's trace in noise σ per reading (rms over "
        f"{d.first.refitted.data.size} readings), after everything a density could explain has been taken out. Least: "
        f"the strength that would stand {SEEN:g} σ out of the noise, in proportion from a weak trace. Imitates: could "
        f"take {100 * SAME:.0f} % or more of the evidence.",
    )
