"""What a controller may know of the wire it drives: the rig's setup and a model of it. Never the rig itself."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from smarig.core import Sample
from smarig.plant import Plant, SupportsHooks
from smarig.preisach import Everett, Initial, Preisach
from smarig.protocols import Setup

ReferenceFunction = Callable[[float], float]  # position at a time of the samples' clock, s
Controller = Generator[float, Sample, None]  # yields currents, A; is sent the sample of the tick


@dataclass(frozen=True)
class ControllerModel:
    """Setup, hysteresis (output in the rig's unit) and effects, as a controller believes them to be.

    Positions of samples count from where the encoder was zeroed: the initial state, at whose output ``origin`` lies.
    """

    setup: Setup
    hysteresis: Everett
    counts_per_rev: int
    effects: Sequence[SupportsHooks] = field(default=())

    @property
    def initial(self) -> Initial:
        """The state after ``initialise``: cold for one wire, B* for two (§5.2.2)."""
        return "anhysteretic" if self.setup.two_wire else "negative"

    @cached_property
    def origin(self) -> float:
        """Model output at the encoder's zero."""
        return self.plant().position

    @cached_property
    def reach(self) -> tuple[float, float]:
        """Positions that the rig's limits leave within reach, counted from the encoder's zero."""
        operator = Preisach(self.hysteresis, "negative")
        ends = operator.simulate([self.setup.upper_K, self.setup.lower_K])
        return float(ends[1]) - self.origin, float(ends[0]) - self.origin

    def plant(self) -> Plant:
        """The model, at rest in its initial state, ready to follow currents tick by tick."""
        return Plant(self.setup.actuator, self.hysteresis, self.initial, self.setup.period_s, self.effects)

    def with_effects(self, effects: Sequence[SupportsHooks]) -> "ControllerModel":
        """The same with effects, such as a diagnosis found."""
        return replace(self, effects=tuple(effects))


ControllerFactory = Callable[[ControllerModel, ReferenceFunction], Controller]
