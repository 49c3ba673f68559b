"""The largest voltage that a wire may need: what a supply is limited to, and a reading is checked against."""

from smarig.config import LimitsFile
from smarig.plant.actuator import Actuator


def largest_voltage_V(limits: LimitsFile, actuator: Actuator) -> float:
    """The largest voltage across the wire: ``voltage_max_V``, or what the largest current needs, with the tolerance."""
    if limits.voltage_max_V is not None:
        return limits.voltage_max_V
    ohm = actuator.resistance_range_ohm[1]
    return (1 + limits.resistance_tolerance) * ohm * max(limits.current_max_A, -limits.current_min_A)
