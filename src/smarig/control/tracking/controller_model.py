"""What a controller is given of the wire: the rig's setup and a model, but not the rig itself."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from smarig.core import Sample
from smarig.plant import Plant, SupportsHooks
from smarig.preisach import Everett, Initial, Preisach
from smarig.protocols import Setup

ReferenceFunction = Callable[[float], float]  # position at a time (s) on the clock of the samples
Controller = Generator[float, Sample, None]  # yields currents in A; receives the sample of the tick


@dataclass(frozen=True)
class ControllerModel:
    """Setup, hysteresis (output in the rig's unit) and effects that the controller assumes.

    Positions of samples count from the encoder's zero, which is the initial state with output ``origin``.
    """

    setup: Setup
    hysteresis: Everett
    position_per_count: float
    effects: Sequence[SupportsHooks] = field(default=())

    @property
    def initial(self) -> Initial:
        """The state after ``initialise``: cold for one wire, B* for two wires (§5.2.2)."""
        return "anhysteretic" if self.setup.two_wire else "negative"

    @cached_property
    def origin(self) -> float:
        """Model output at the encoder's zero."""
        return self.plant().position

    @cached_property
    def reach(self) -> tuple[float, float]:
        """Positions that can be reached within the rig's limits, counted from the encoder's zero."""
        operator = Preisach(self.hysteresis, "negative")
        ends = operator.simulate([self.setup.upper_K, self.setup.lower_K])
        return float(ends[1]) - self.origin, float(ends[0]) - self.origin

    def plant(self) -> Plant:
        """The model at rest in its initial state, to be stepped by currents."""
        return Plant(self.setup.actuator, self.hysteresis, self.initial, self.setup.period_s, self.effects)

    def with_effects(self, effects: Sequence[SupportsHooks]) -> "ControllerModel":
        """The same model with effects, for example those named by a diagnosis."""
        return replace(self, effects=tuple(effects))


ControllerFactory = Callable[[ControllerModel, ReferenceFunction], Controller]
