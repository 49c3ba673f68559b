"""PI with its zero at the wire's own lag (``setpoint_pi``)."""

from smarig.control.regulation.setpoint_pi import SetpointPI
from smarig.preisach import Everett
from smarig.protocols import Setup


def pi(
    setup: Setup, hysteresis: Everett, count: float, *, gain: float | None = None, band: float | None = None
) -> SetpointPI:
    """PI that holds a set-point, gentle on the steepest branch of the model.

    gain (K/unit): kelvin of steady temperature per unit of position
    band (unit): errors within it count as zero; half a count unless given
    """
    found = SetpointPI.for_model(setup, hysteresis, count / 2 if band is None else band)
    found.gain = found.gain if gain is None else gain
    return found
