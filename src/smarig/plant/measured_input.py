"""The wire where its input itself was measured: nothing is heated, and the hysteresis is driven by what was measured.

Takes the place of the actuator and its heating in a plant. No constant of the wire is known, so an effect that needs
one cannot be tested.
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
)  # what acts after the input was measured
CLOCK_DEPENDENT = ("creep", "cross_talk", "sensor_lag", "settling", "slip")  # of no meaning without a clock


class WireConstantsUnknown(UsageError):
    """An effect asked for a constant of a wire of which only the input is known."""


class PassThroughActuator(Actuator):
    """In place of an actuator: the drive is the input, in whatever unit; one wire, no time constant."""

    def __init__(self) -> None:
        pass

    @property
    def file(self) -> ActuatorFile:  # pyright: ignore[reportIncompatibleVariableOverride]
        """There is none."""
        raise WireConstantsUnknown("Only the input of this wire was measured: its constants are not known.")

    @property
    def two_wire(self) -> bool:
        """One wire, or one sample."""
        return False

    @property
    def tau_s(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """None that would matter: the input is measured after all heating."""
        return 1.0

    def resistance_at_ohm(self, austenite: float) -> float:  # noqa: ARG002
        """No resistance is read."""
        return 1.0

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PassThroughActuator)

    def __hash__(self) -> int:
        return hash(PassThroughActuator)

    def __repr__(self) -> str:
        return "PassThroughActuator()"


class PassThroughHeating(JouleHeating):
    """In place of the heating: the given input passes through, whatever the time.

    >>> PassThroughHeating(0.1).step(35.0)
    35.0
    """

    def __init__(self, dt_s: float) -> None:
        self.two_wire, self.wire_K = False, [0.0, 0.0]
        self.tick(dt_s)

    def source(self, current_A: float) -> float:
        """What is given, in place of a current."""
        return current_A

    def tick(self, dt_s: float) -> None:
        """Set the length of a tick."""
        self.dt_s = dt_s

    def relax(self, source_K: float, lag: float = 1.0, second_lag: float = 1.0) -> float:  # noqa: ARG002
        """At once what is given."""
        self.wire_K[0] = source_K
        return source_K


def heating_for(actuator: Actuator, dt_s: float) -> JouleHeating:
    """Of a wire: heating by a current, or the given input as it is."""
    return (
        PassThroughHeating(dt_s)
        if isinstance(actuator, PassThroughActuator)
        else JouleHeating(actuator, dt_s)
    )


def is_testable(kind: EffectType, hysteresis: Everett, *, clock: bool) -> bool:
    """Whether an effect can show where the input was measured: it acts later, and asks for no constant of the wire.

    Without a clock nothing can be said of effects of time.
    """
    try:
        hooks = kind().hooks(EffectContext(PassThroughActuator(), hysteresis, "negative"))
    except WireConstantsUnknown:
        return False
    return set(hooks) <= set(AFTER_INPUT) and (clock or kind.name not in CLOCK_DEPENDENT)
