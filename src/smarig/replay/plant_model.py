"""Who lives through a story: what is believed of the wire, and of the state it begins in. Knows no story."""

from dataclasses import dataclass

from smarig.plant.actuator import Actuator
from smarig.plant.effect import Effect, SupportsHooks
from smarig.preisach.everett import Everett
from smarig.preisach.operator import Initial


@dataclass(frozen=True, eq=False)
class PlantModel:
    """Constants, hysteresis, the state the story begins in, known effects; output units per count, 0 where unknown.

    ``signed``: whether its density is believed to be negative somewhere, as surfaces of Table 5.1 are (Prop. 4.6).
    """

    actuator: Actuator
    hysteresis: Everett
    initial: Initial
    effects: tuple[SupportsHooks, ...] = ()
    per_count: float = 0.0
    signed: bool = False

    @property
    def planted(self) -> tuple[Effect, ...]:
        """Its effects that the catalogue knows."""
        return tuple(e for e in self.effects if isinstance(e, Effect))

    @property
    def stroke(self) -> float:
        """Output between both saturations."""
        h = self.hysteresis
        return h.everett(h.upper, h.lower) or 1.0
