"""Transforming takes heat: inside the loop the wire warms and cools more slowly.

    τ(T, ξ) = τ [1 + δ (ξ − ½) + (L/c_p) dξ/dT]        L on heating, λ L on cooling; δ = (c_A − c_M)/c̄

dξ/dT is the slope of the hysteresis where it stands; the phases have specific heats of their own.
"""

from collections.abc import Mapping

from smarig.model.effect import Hook, Kind, Moment, Parameter, Setup, Stage, Values

_LEAST_K = 1e-4  # of temperature between two ticks, for a slope


def _act(p: Values, setup: Setup) -> Mapping[Stage, Hook]:
    kelvin = 1000 * p["latent_J_per_g"] / setup.actuator.file.wire.specific_heat.value
    ratio, change = p["cooling_ratio"], p["specific_heat_change_percent"] / 100
    before_K, before, slope = 0.0, None, 0.0

    def lag(tau: float, now: Moment) -> float:
        nonlocal before_K, before, slope
        if before is not None and abs(now.felt_K - before_K) > _LEAST_K:
            slope = abs((now.austenite - before) / (now.felt_K - before_K))
        if before is None or abs(now.felt_K - before_K) > _LEAST_K:
            before_K, before = now.felt_K, now.austenite
        heat = kelvin * (1.0 if abs(now.source_K) >= abs(now.input_K) else ratio)
        return tau * (1 + change * (now.austenite - 0.5) + heat * slope)

    return {Stage.LAG: lag}


latent_heat = Kind(
    name="latent_heat",
    summary="Transforming takes heat: inside the loop the wire warms and cools more slowly.",
    number="E6",
    enters="transient",
    looks_like="approaches two to four times slower inside the transformation, unlike in heating and cooling",
    confused_with=("wire_lag", "settling"),
    separated_by="pairs of small steps inside and outside the transformation",
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
            "cooling_ratio", "1", 0.0, 5.0, 1.0, "heat given back over heat taken up, 0.3–1", tries=(0.3, 1.0)
        ),
        Parameter("specific_heat_change_percent", "%", -60.0, 60.0, 0.0, "0.47–0.84 J/(g K) reported"),
    ),
    act=_act,
)
