"""The wire heats more slowly or faster than its constants predict.

τ ← τ (1 + l)        first order, so steady states do not change
"""

from collections.abc import Mapping

from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values


def _act(p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
    factor = 1 + p["change_percent"] / 100

    def lag(tau: float, _now: PlantState) -> float:
        return tau * factor

    return {Stage.LAG: lag}


wire_lag = EffectType(
    name="wire_lag",
    summary="The wire heats more slowly or faster than its constants predict.",
    number="E1",
    enters="transient",
    looks_like="all approaches are stretched by the same factor",
    confused_with=("latent_heat", "convection", "sensor_lag"),
    separated_by="positions logged at 5 Hz or more; steps up and down from the same state",
    remedy="hold each level longer, or use a thinner wire",
    parameters=(
        Parameter(
            "change_percent",
            "%",
            -80.0,
            400.0,
            40.0,
            "τ = 0.5–15 s, proportional to diameter to the power 1.5; c_p is typical only",
        ),
    ),
    act=_act,
    output_independent=True,
)
