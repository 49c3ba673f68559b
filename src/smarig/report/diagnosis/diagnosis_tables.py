"""Tables of a diagnosis: rival explanations, single candidates, what could have been seen.

Knows nothing of figures and of the page's order.
"""

from collections.abc import Mapping

import numpy as np

from smarig.diagnosis import DETECTION_SD, IMITATION_THRESHOLD, Diagnosis
from smarig.plant import EffectType
from smarig.report.components.html import Html, table, tag
from smarig.report.components.numbers import number
from smarig.report.diagnosis.candidate_rows import candidate_name, nats_text, top_candidates
from smarig.report.diagnosis.diagnosis_text import explanation_text, unit_suffix


def explanations_table(d: Diagnosis) -> Html:
    """The explanations that competed last, all their parameters, nats and probabilities."""
    level, effect_types = d.levels[-1], dict(d.verdict.explanations)
    rivals = [
        (
            explanation_text(r.effects, {}),
            nats_text(level.lead(k)),
            _probability_text(effect_types.get(r.names)),
        )
        for k, r in enumerate(level.explanations)
        if k > 0
    ]
    best = explanation_text(level.best.effects, level.best.spread)
    return table(
        ("Explanation", "Nats behind the best", "Probability"),
        [(tag("b", best), "0", _probability_text(effect_types.get(level.best.names))), *rivals],
        "Explanations that competed last, best first, every parameter fitted to all readings at once. The best gains "
        f"{nats_text(level.gain)} nats over {_smaller_explanations(d)}.",
    )


def _smaller_explanations(d: Diagnosis) -> str:
    return "the best with one effect less" if len(d.levels) > 1 else "the base model"


def _probability_text(p: float | None) -> str:
    if p is None:
        return "–"
    return "< 0.001" if p < 1e-3 else "> 0.999" if p > 0.999 else f"{p:.3f}"


def candidates_table(d: Diagnosis) -> Html:
    """The candidates that gain most by themselves, beside what chance gains."""
    rows = [
        (
            candidate_name(s),
            nats_text(s.net),
            nats_text(s.high - s.median),
            nats_text(s.standard),
        )
        for s in top_candidates(d)
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


def visibility_table(d: Diagnosis, effect_types: Mapping[str, EffectType]) -> Html:
    """Every effect of the catalogue: size of its trace, least strength found, who imitates it."""
    v = d.visibility
    rows = []
    for k in np.argsort(-v.delta).tolist():
        name = v.names[k]
        p = effect_types[name].primary
        detectable = v.delta[k] > 0
        unit = unit_suffix(p.unit)
        rows.append(
            (
                name,
                f"{number(abs(p.typical))}{unit}",
                number(float(v.delta[k])) if detectable else "0",
                f"{number(float(v.least_strength[k]), 2)}{unit}" if detectable else "none",
                ", ".join(v.group(name)) or "no one",
            )
        )
    return table(
        ("Effect", "Typical strength", "δ at typical strength", "Least strength seen", "Who imitates it"),
        rows,
        f"What these data could have shown. δ: size of an effect's trace in noise σ per reading (rms over "
        f"{d.first.refitted.data.size} readings), after everything a density could explain has been taken out. Least: "
        f"the strength that would stand {DETECTION_SD:g} σ out of the noise, in proportion from a weak trace. "
        "Imitates: could "
        f"take {100 * IMITATION_THRESHOLD:.0f} % or more of the evidence.",
    )
