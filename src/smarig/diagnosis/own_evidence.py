"""Which effects remain candidates where the model is wrong with the effects too.

A wire that is no Preisach operator leaves errors with a structure, and effects with enough freedom follow a part of it.
So a likelihood alone speaks for no effect there. What speaks for one is:

* evidence in the readings that show it (``EffectType.shown_by``), at least as large as in other positions, which a
  density fits: of a lag in moving positions, of an amplifier in the measured current. An effect that is a part of a
  classical density has none at one load;
* for an effect on the positions themselves: a gain that a flexible dependence on one variable does not have too, and
  held-out runs that lose most of their removable error.
"""

from smarig.diagnosis.explain.separate_evidence import SeparateEvidence
from smarig.plant import POSITIONS

OWN_NATS = 25.0  # at least, in the readings that show an effect
OWN_SHARE = (
    0.5  # of its gain in positions and these readings, or of all beside a discrepancy: the larger part
)
LEAST_R = 0.5  # removable share of the error on held-out runs


def own_evidence_failure(one: SeparateEvidence, removable_share: float | None) -> str:
    """Why an effect is no candidate, as a clause; empty if it is one. ``removable_share``: R on held-out runs."""
    name, shown_by = one.effect.kind.name, one.effect.kind.shown_by
    if not shown_by:
        return (
            f"{name} is a part of a classical density, so at one load only errors of the density speak for it"
        )
    if shown_by != POSITIONS:
        if one.own >= max(OWN_NATS, OWN_SHARE * one.whole):
            return ""
        readings = " and ".join(_READINGS.get(kind, kind) for kind in shown_by)
        return f"little of what {name} explains is in the {readings}, which alone can show it"
    if one.over_discrepancy < max(OWN_NATS, OWN_SHARE * one.nats):
        return f"a flexible dependence on one variable explains most of what {name} explains"
    if removable_share is not None and removable_share < LEAST_R:
        return f"with {name}, most of the error of the held-out runs remains (R = {removable_share:.2f})"
    return ""


_READINGS = {"moving": "moving positions", "current": "measured current", "resistance": "resistance"}
