"""Tables of a diagnosis: competing explanations, single candidates, and visibility of effects."""

from collections.abc import Mapping

import numpy as np

from smarig.diagnosis import DETECTION_SD, IMITATION_THRESHOLD, Diagnosis
from smarig.plant import EffectType
from smarig.report.components.html import Html, table, tag
from smarig.report.components.numbers import number
from smarig.report.diagnosis.candidate_rows import candidate_name, nats_text, top_candidates
from smarig.report.diagnosis.verdict_text import explanation_text, unit_suffix


def explanations_table(d: Diagnosis) -> Html:
    """The explanations of the last level, with all parameters, nats and scores."""
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
        ("Explanation", "Nats behind the best", "Score"),
        [(tag("b", best), "0", _probability_text(effect_types.get(level.best.names))), *rivals],
        "Competing explanations, best first. All parameters are fitted to all readings jointly. The best explanation "
        f"gains {nats_text(level.gain)} nats over {_smaller_explanations(d)}.",
    )


def _smaller_explanations(d: Diagnosis) -> str:
    return "the best one with one effect fewer" if len(d.levels) > 1 else "the base model"


def _probability_text(p: float | None) -> str:
    if p is None:
        return "–"
    return "< 0.001" if p < 1e-3 else "> 0.999" if p > 0.999 else f"{p:.3f}"


def candidates_table(d: Diagnosis) -> Html:
    """The single candidates with the largest gains, with their gains by chance."""
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
            "Single candidate",
            "Gain above chance (nats)",
            "95 % point of nulls (nats)",
            "Standardised gain",
        ),
        rows,
        "The single candidates with the largest gains in the first critique. If a dependence of the position on a "
        "variable gains much more than any named effect, the cause is probably not in the catalogue.",
    )


def visibility_table(d: Diagnosis, effect_types: Mapping[str, EffectType]) -> Html:
    """All effects of the catalogue: size of the trace, smallest detectable strength, similar effects."""
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
                ", ".join(v.group(name)) or "none",
            )
        )
    return table(
        (
            "Effect",
            "Typical strength",
            "δ at typical strength",
            "Smallest detectable strength",
            "Similar effects",
        ),
        rows,
        "Visibility of the effects in these data. δ: size of an effect's trace in noise σ per reading (rms over "
        f"{d.first.refitted.data.size} readings), without the part that a density could explain. Smallest detectable "
        f"strength: the strength at which the trace exceeds the noise by {DETECTION_SD:g} σ, extrapolated from a weak "
        f"effect. Similar effects: those that could explain {100 * IMITATION_THRESHOLD:.0f} % or more of the evidence.",
    )
