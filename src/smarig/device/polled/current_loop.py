"""A current loop on the host, for voltage and PWM sources that have none.

A wire's resistance changes slowly (with its phase, over seconds), so the loop needs no tuning: at every measurement

    R = V/I, kept within the wire's resistances,      V_set = I_set R,      |V_set| ≤ V_max

A step is therefore off by the error of R for one tick, then by the noise of R.
"""

import math
from typing import Any

from smarig.config import RigFile
from smarig.device.polled.readings import electrical_from
from smarig.device.roles.polled import Electrical, VoltageOutput
from smarig.plant import Actuator, largest_voltage_V

SHARE_MEASURED = 0.05  # of the largest current; below it, V/I is mostly noise
LEEWAY = 1.3  # leads and contacts besides the wire, and readings a little off


class CurrentLoop:
    """A current output made of a voltage output. Its accuracy is that of the output's measured current."""

    def __init__(self, output: VoltageOutput, rig: RigFile) -> None:
        actuator = Actuator.named(rig.actuator)
        low, high = actuator.resistance_range_ohm
        self._output, self._range_ohm = output, (low / LEEWAY, high * LEEWAY)
        self._largest_V = largest_voltage_V(rig.limits, actuator)
        self._measured_from_A = SHARE_MEASURED * max(rig.limits.current_max_A, -rig.limits.current_min_A)
        self._start_ohm = self._ohm = high / LEEWAY  # the first step is rather low than high
        self._set_A = 0.0

    @property
    def identity(self) -> str:
        """The instrument."""
        return self._output.identity

    @property
    def has_lease(self) -> bool:
        """That of the output."""
        return self._output.has_lease

    @property
    def line(self) -> Any:
        """That of the output, if it tells."""
        return getattr(self._output, "line", None)

    @property
    def tripped(self) -> str:
        """Why the output has switched itself off; "" if it has not."""
        return self._output.tripped

    def arm(self) -> None:
        """Zero voltage; the resistance is unknown again."""
        self._set_A, self._ohm = 0.0, self._start_ohm
        self._output.arm()

    def set_current(self, current_A: float) -> None:
        """Apply the voltage for a current at the last known resistance."""
        self._set_A = current_A
        self._apply()

    def measure(self) -> Electrical:
        """Measure, then correct the voltage for the next tick."""
        now = electrical_from(self._output)
        if self.tripped:
            return now
        if abs(now.current_A) >= self._measured_from_A and math.isfinite(now.voltage_V):
            low, high = self._range_ohm
            self._ohm = min(max(abs(now.voltage_V / now.current_A), low), high)
            if self._set_A:
                self._apply()
        return now

    def off(self) -> str:
        """Zero voltage."""
        self._set_A = 0.0
        return self._output.off()

    def close(self) -> None:
        """Close the line."""
        self._output.close()

    def _apply(self) -> None:
        voltage_V = self._set_A * self._ohm
        self._output.set_voltage(math.copysign(min(abs(voltage_V), self._largest_V), voltage_V))
