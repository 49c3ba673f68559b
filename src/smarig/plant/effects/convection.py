"""The heat loss grows faster than the temperature.

    h u = h₀ u (u/u_ref)ⁿ   ⇒   u_∞ = u_ref (u_lin/u_ref)^(1/(1+n))
    τ(u) = τ (u − u_∞)/(u (u/u_ref)ⁿ − u_∞ (u_∞/u_ref)ⁿ)

u_lin is the steady temperature of (5.3) and u_ref the temperature of that measurement. The lag is that of the secant,
for each wire separately. Below 1 K the heat loss is linear.
"""

from collections.abc import Mapping
from math import copysign

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values

_COLD_K = 1.0  # below this, h is that of 1 K


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    n, reference_K = p["exponent"], context.actuator.file.heating.reference_temperature.value

    def loss(u: float) -> float:
        return u * (max(u, _COLD_K) / reference_K) ** n

    def source(u: float, _now: PlantState) -> float:
        return copysign(reference_K * (abs(u) / reference_K) ** (1 / (1 + n)), u)

    def lag(tau: float, now: PlantState) -> float:
        end, here = abs(now.source_K), abs(now.input_K)
        if abs(here - end) < 1e-3:
            slope = (1 + n) * (max(end, _COLD_K) / reference_K) ** n
        else:
            slope = (loss(here) - loss(end)) / (here - end)
        return tau / max(slope, 1e-2)

    return {Stage.SOURCE: source, Stage.LAG: lag}


convection = EffectType(
    name="convection",
    summary="The heat loss grows faster than the temperature.",
    number="E4",
    enters="input map (monotone) and transient",
    looks_like="nothing in steady states; faster approaches at high temperature",
    confused_with=("resistance_phase", "wire_lag", "amplifier_gain"),
    separated_by="transients at several levels; the wire's own temperature; a second ambient temperature",
    remedy="calibrate the heating at several levels, or measure the temperature of the wire",
    parameters=(
        Parameter(
            "exponent",
            "1",
            -0.3,
            0.5,
            0.15,
            "0.10–0.16 for thin wires (Churchill–Chu, Morgan), 0.25 above Ra = 1e4",
        ),
    ),
    act=_act,
    output_independent=True,
)
