"""Every movement continues slowly, in proportion to the logarithm of time.

    y(t) ← y(t) + c ∫ log₁₀(1 + (t − s)/t₀) dy(s),    t₀ = 1 s

computed as a sum of exponentials, two per decade (0.3 s … 28 h).
"""

from collections.abc import Mapping
from math import exp

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values

_TIMES_S = [10 ** (k / 2) for k in range(-1, 11)]  # log(1 + t) = ∫ (1 − e^(−t/τ)) e^(−1/τ) dτ/τ
_WEIGHTS = [exp(-1 / tau_s) / 2 for tau_s in _TIMES_S]
_ALL = sum(_WEIGHTS)


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    strength = p["percent_per_decade"] / 100
    late = [0.0] * len(_TIMES_S)
    last = rest = None

    def added(y: float, now: PlantState) -> float:
        nonlocal last, rest
        if last is None or rest is None:
            last = rest = y  # assume that all earlier creep is complete and part of the output
        step, last = y - last, y
        for k, tau_s in enumerate(_TIMES_S):
            late[k] = (late[k] + step) * exp(-now.dt_s / tau_s)
        return y + strength * (_ALL * (y - rest) - sum(w * x for w, x in zip(_WEIGHTS, late)))

    return {Stage.ADDITIVE: added}


creep = EffectType(
    name="creep",
    summary="Every movement continues slowly, in proportion to the logarithm of time.",
    number="E20",
    enters="additive",
    looks_like="after each movement, in its direction, growing with the logarithm of the hold time",
    confused_with=("settling", "backlash"),
    separated_by="holds ten times as long, inside and outside the transformation (settling follows the power)",
    remedy="hold every level for the same time, or much longer",
    parameters=(
        Parameter(
            "percent_per_decade",
            "%/decade",
            0.0,
            5.0,
            1.0,
            "0.2–3 % of the step per decade, engineering estimate",
        ),
    ),
    act=_act,
)
