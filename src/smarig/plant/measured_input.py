"""A wire whose hysteresis input was measured: the measured values drive the hysteresis, without a heating model.

It replaces the actuator and its heating in a plant. No constant of the wire is known, so effects that need one cannot
be tested.
"""

from smarig.config import ActuatorFile
from smarig.core import UsageError
from smarig.plant.actuator import Actuator
from smarig.plant.effect import EffectContext, EffectType, Stage
from smarig.plant.heating import JouleHeating
from smarig.preisach import Everett

AFTER_INPUT = (
    Stage.INPUT,
    Stage.OUTPUT,
    Stage.ADDITIVE,
    Stage.SENSOR,
)  # stages after the measured input
CLOCK_DEPENDENT = ("creep", "cross_talk", "sensor_lag", "settling", "slip")  # meaningless without a clock


class WireConstantsUnknown(UsageError):
    """An effect needs a constant of the wire, but only the input of the wire is known."""


class PassThroughActuator(Actuator):
    """Replaces an actuator: the drive is the input, in any unit. One wire, no time constant."""

    def __init__(self) -> None:
        pass

    @property
    def file(self) -> ActuatorFile:  # pyrefly: ignore [bad-override]
        """Not available."""
        raise WireConstantsUnknown("Only the input of this wire was measured. Its constants are not known.")

    @property
    def two_wire(self) -> bool:
        """One wire, or one sample."""
        return False

    @property
    def tau_s(self) -> float:
        """Irrelevant here: the input is measured after all heating."""
        return 1.0

    def resistance_at_ohm(self, austenite: float) -> float:  # noqa: ARG002
        """Not available; the resistance is not measured."""
        return 1.0

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PassThroughActuator)

    def __hash__(self) -> int:
        return hash(PassThroughActuator)

    def __repr__(self) -> str:
        return "PassThroughActuator()"


class PassThroughHeating(JouleHeating):
    """Replaces the heating: the given input passes through unchanged at any time.

    >>> PassThroughHeating(0.1).step(35.0)
    35.0
    """

    def __init__(self, dt_s: float) -> None:
        self.two_wire, self.wire_K = False, [0.0, 0.0]
        self.tick(dt_s)

    def source(self, current_A: float) -> float:
        """The given input, in place of a current."""
        return current_A

    def tick(self, dt_s: float) -> None:
        """Set the length of a tick."""
        self.dt_s = dt_s

    def relax(self, source_K: float, lag: float = 1.0, second_lag: float = 1.0) -> float:  # noqa: ARG002
        """Set the input without lag."""
        self.wire_K[0] = source_K
        return source_K


def heating_for(actuator: Actuator, dt_s: float) -> JouleHeating:
    """The heating of an actuator: by a current, or the given input unchanged."""
    return (
        PassThroughHeating(dt_s)
        if isinstance(actuator, PassThroughActuator)
        else JouleHeating(actuator, dt_s)
    )


def is_testable(kind: EffectType, hysteresis: Everett, *, clock: bool) -> bool:
    """Whether an effect can be tested on measured inputs: it acts after the input and needs no constant of the wire.

    Without a clock, effects that depend on time cannot be tested.
    """
    try:
        hooks = kind().hooks(EffectContext(PassThroughActuator(), hysteresis, "negative"))
    except WireConstantsUnknown:
        return False
    return set(hooks) <= set(AFTER_INPUT) and (clock or kind.name not in CLOCK_DEPENDENT)
