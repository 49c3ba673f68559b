"""A second, narrow transformation (R-phase) contributes its own stroke.

y = (1 − w) Γ[u] + w [y₋ + (y₊ − y₋)/(1 + exp(−(p(u) − T_R)/b))]        p: play of ± 1 K
"""

from collections.abc import Mapping
from math import tanh

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values

_HALF_K = 1.0


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    share, width, low, stroke = p["share_percent"] / 100, p["width_K"], context.y_lower, context.stroke
    h = context.hysteresis
    centre = h.lower + p["at"] * (h.upper - h.lower)
    played: float | None = None

    def output(y: float, now: PlantState) -> float:
        nonlocal played
        u = now.hysteresis_input_K
        played = u if played is None else min(max(played, u - _HALF_K), u + _HALF_K)
        second = low + stroke * 0.5 * (1 + tanh((played - centre) / (2 * width)))
        return y + share * (second - y)

    return {Stage.OUTPUT: output}


r_phase = EffectType(
    name="r_phase",
    summary="A second, narrow transformation (R-phase) contributes its own stroke.",
    number="E13",
    enters="adds relays in parallel",
    looks_like="a second step; nothing that steady states at one load can distinguish",
    confused_with=("end_conduction", "convection"),
    separated_by="the hump of the voltage on cooling; two loads",
    remedy="raise the load, or do not cool below the R-phase transformation",
    parameters=(
        Parameter("share_percent", "%", 0.0, 30.0, 12.0, "strain 0.3–1 % of 4 %"),
        Parameter("at", "range", 0.0, 1.0, 0.3, "position in the input range", tries=(0.15, 0.3, 0.5)),
        Parameter("width_K", "K", 0.5, 10.0, 2.0, "1–5 K, engineering estimate"),
    ),
    act=_act,
)
