"""The transformation takes up heat, so the wire heats and cools more slowly inside the loop.

    τ(T, ξ) = τ [1 + δ (ξ − ½) + (L/c_p) dξ/dT]        L on heating, λ L on cooling; δ = (c_A − c_M)/c̄

ξ and T are those of each wire. dξ/dT is the slope of the present branch, averaged over some tenths of a
kelvin, because relays switch one by one. Heat that they take up beyond this is carried over to the next tick, so heat
is conserved for every slope and tick. Both phases have their own specific heats.
"""

from collections.abc import Mapping
from math import exp

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values

_LEAST_K = 1e-4  # least temperature change between two ticks for computing a slope
_SMOOTH_K = 0.5  # temperature range over which the slope is averaged
_LARGEST = 1e3  # lag of a wire that does not heat until the transformation heat is supplied


class _TransformationHeat:
    """Heat of one wire in kelvin: supplied through the lag, and taken up by the relays."""

    def __init__(self, p: Values, context: EffectContext) -> None:
        self._latent_heating_K = 1000 * p["latent_J_per_g"] / context.actuator.file.wire.specific_heat.value
        self._ratio, self._change = p["cooling_ratio"], p["specific_heat_change_percent"] / 100
        self._tau_s = context.actuator.tau_s
        self._before: float | None = None
        self._before_K = self._slope = self._deficit_K = self._latent_K = 0.0
        self._capacity = self._lag = 1.0

    def lag(self, now: PlantState) -> float:
        """Start a tick: complete the heat account of the last one and compute the lag of this one."""
        u = now.source_K
        self._account_last_tick(now)
        self._latent_K = self._latent_heating_K * (1.0 if abs(u) >= abs(now.input_K) else self._ratio)
        self._capacity = 1 + self._change * (now.austenite - 0.5)
        lag = self._capacity + self._latent_K * self._slope
        move_K = (u - now.input_K) * (1 - exp(-now.dt_s / (self._tau_s * lag)))
        if abs(move_K) > _LEAST_K:
            lag += self._deficit_K / move_K
        self._lag = min(max(lag, self._capacity), _LARGEST)
        return self._lag

    def _account_last_tick(self, now: PlantState) -> None:
        if self._before is not None:
            moved_K, transformed = now.input_K - self._before_K, now.austenite - self._before
            deficit_K = (
                self._deficit_K + self._latent_K * transformed - (self._lag - self._capacity) * moved_K
            )
            self._deficit_K = deficit_K * exp(-now.dt_s / self._tau_s)  # part of it is lost to the ambient
            if abs(moved_K) > _LEAST_K:
                here = max(transformed / moved_K, 0.0)
                self._slope += (here - self._slope) * (1 - exp(-abs(moved_K) / _SMOOTH_K))
        self._before_K, self._before = now.input_K, now.austenite


def _act(p: Values, context: EffectContext) -> Mapping[Stage, Hook]:
    wires = [_TransformationHeat(p, context) for _ in range(2)]

    def lag(tau: float, now: PlantState) -> float:
        return tau * wires[now.wire].lag(now)

    return {Stage.LAG: lag}


latent_heat = EffectType(
    name="latent_heat",
    summary="The transformation takes up heat, so the wire heats and cools more slowly inside the loop.",
    number="E6",
    enters="transient",
    looks_like="approaches two to four times slower inside the transformation, different in heating and cooling",
    confused_with=("wire_lag", "settling"),
    separated_by="pairs of small steps inside and outside the transformation",
    remedy="change the current more slowly within the transformation, or hold each level longer",
    parameters=(
        Parameter(
            "latent_J_per_g",
            "J/g",
            0.0,
            60.0,
            20.0,
            "24.2 J/g (Flexinol 1140); 12.2 heating, 4.1 cooling measured in a spring",
        ),
        Parameter(
            "cooling_ratio",
            "1",
            0.0,
            5.0,
            1.0,
            "heat released relative to heat taken up, 0.3–1",
            tries=(0.3, 1.0),
        ),
        Parameter("specific_heat_change_percent", "%", -60.0, 60.0, 0.0, "0.47–0.84 J/(g K) reported"),
    ),
    act=_act,
)
