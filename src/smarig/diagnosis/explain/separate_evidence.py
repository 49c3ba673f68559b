"""What each effect of an explanation explains by itself, in each kind of readings, and beside a flexible discrepancy.

    log L = Σ_kinds log p(readings of the kind | kinds before) = Σ_k −½ w_k² − log(L_kk s_k)

w are the whitened readings, L the Cholesky factor of their covariance, s their scales. An effect explains the
difference to the likeliest model without it, whose density and noise are found again. Beside a discrepancy both models
have the likeliest one: what it also explains does not count.
"""

from dataclasses import dataclass, replace

import numpy as np

from smarig.diagnosis.explain.discrepancy import Discrepancy, likeliest_discrepancy
from smarig.diagnosis.explain.explanation import Explanation
from smarig.diagnosis.explain.joint_density import joint_density
from smarig.diagnosis.refit.refit import Refit
from smarig.plant import POSITIONS, Effect
from smarig.replay import OUTPUT_DEPENDENT_KINDS, Timeline


@dataclass(frozen=True)
class SeparateEvidence:
    """The gain of one effect over the same explanation without it, in nats.

    ``nats``: of all readings; ``by_kind``: of each kind, given the kinds before it, in the order of the stack;
    ``over_discrepancy``: of all readings, beside the likeliest discrepancy of each model.
    """

    effect: Effect
    nats: float
    by_kind: dict[str, float]
    over_discrepancy: float

    @property
    def own(self) -> float:
        """The part of the gain that no density can make up for: that of the kinds of readings that show the effect."""
        return sum(nats for kind, nats in self.by_kind.items() if kind in self.effect.kind.shown_by)

    @property
    def whole(self) -> float:
        """The gain in positions and in the readings that show the effect."""
        return sum(n for kind, n in self.by_kind.items() if kind in (*POSITIONS, *self.effect.kind.shown_by))


def separate_evidence(
    timeline: Timeline, best: Explanation, remaining: Discrepancy
) -> tuple[SeparateEvidence, ...]:
    """The evidence of each effect of an explanation. ``remaining`` is the likeliest discrepancy with all of them."""
    with_all = nats_by_kind(timeline, best.refitted)
    found = []
    for effect in best.effects:
        others = tuple(e for e in best.plant_model.effects if e is not effect)
        model, refitted = joint_density(timeline, replace(best.plant_model, effects=others), best.refitted)
        without = nats_by_kind(timeline, refitted)
        nats = best.evidence - refitted.log_evidence
        over_discrepancy = nats + remaining.gain - likeliest_discrepancy(timeline, model, refitted).gain
        found.append(
            SeparateEvidence(effect, nats, {k: with_all[k] - without[k] for k in with_all}, over_discrepancy)
        )
    return tuple(found)


def nats_by_kind(timeline: Timeline, refitted: Refit) -> dict[str, float]:
    """The log likelihood of the readings of each kind, given those of the kinds before (without constants)."""
    terms = -0.5 * refitted.data**2 - np.log(np.diag(refitted.factor) * refitted.scale)
    found, at = {}, 0
    for readings in sorted(timeline.all_readings, key=lambda r: r.kind not in OUTPUT_DEPENDENT_KINDS):
        found[readings.kind] = float(terms[at : at + len(readings)].sum())
        at += len(readings)
    return found
