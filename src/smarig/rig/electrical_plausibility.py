"""Electrical plausibility of a reading: measured against ordered current, resistance, voltage.

Every other limit rests on the measured current. The voltage is the second witness: whatever the shunt reads, V/I must
be a resistance of this wire in its phase, and V no more than the largest current needs.
"""

import math
from typing import NamedTuple

from smarig.config import AmplifierFile, LimitsFile
from smarig.core import Quality, Sample
from smarig.plant import Actuator, largest_voltage_V
from smarig.rig.expected_resistance import ExpectedResistance, without_voltage_text
from smarig.rig.rig import Alarm

IN_A_ROW = 3  # consecutive samples that show a current: a single one may be wrong
GROSS = 1.3  # times an upper limit: a wire heats too fast to wait for a third sample
MIN_CURRENT_A = 0.05  # a smaller current does not determine a resistance
READ_BACK_TOLERANCE = 0.05  # of the largest current: set-point against read-back, and
NOISE_SDS = 6.0  # standard deviations of the reading: a true difference of the tolerance may be read larger

_NO_VOLTAGE = "The voltage is not measured any more. Check its leads and the source."
_SATURATED = int(Quality.SATURATED)  # a plain integer, because it is used every tick


def read_back_tolerance_A(limits: LimitsFile, amplifier: AmplifierFile) -> float:
    """Largest difference between the ordered current and a reading of it: as large as series diodes make it."""
    largest_A = max(limits.current_max_A, -limits.current_min_A)
    return READ_BACK_TOLERANCE * largest_A + NOISE_SDS * amplifier.current_noise_A


class ElectricalPlausibility:
    """``check`` returns an alarm when a fault has lasted; ``suspect`` tells whether the last sample shows one."""

    def __init__(self, limits: LimitsFile, amplifier: AmplifierFile, actuator: Actuator) -> None:
        self._tolerance_A = read_back_tolerance_A(limits, amplifier)
        self._saturation_A = amplifier.saturation_A
        self._resistance = ExpectedResistance(actuator, limits.resistance_tolerance)
        self._largest_V = largest_voltage_V(limits, actuator)
        self._evidence = 0  # samples with a fault since the last one that shows none
        self._phase_known = True
        self._has_voltage, self._without_voltage = False, 0  # samples with a current and no voltage
        self.suspect = False

    def rearmed(self) -> None:
        """A trip was cleared: a fault that persists must trip again."""
        self._evidence = 0

    def input_unsure(self) -> None:
        """The wire may be colder than the next input says: any phase is possible."""
        self._phase_known = False

    def check(self, s: Sample, input_K: float) -> list[Alarm]:
        """The alarm that this sample is the first to justify, as a list."""
        fault = self._fault(s, input_K)
        self._phase_known = True
        self.suspect = fault is not None
        if fault is None and math.isnan(s.voltage_V) and abs(s.current_A) >= MIN_CURRENT_A:
            self._without_voltage += 1
            if self._without_voltage == IN_A_ROW:
                return [Alarm("warning", "voltage", without_voltage_text(*self._resistance.any_phase_ohm))]
        if fault is None:
            # a smaller current shows nothing: one that pauses must trip too
            self._evidence = 0 if abs(s.current_A) >= MIN_CURRENT_A else self._evidence
            return []
        before, self._evidence = self._evidence, self._evidence + fault.weight
        return [Alarm("error", fault.kind, fault.text)] if before < IN_A_ROW <= self._evidence else []

    def _fault(self, s: Sample, input_K: float) -> "_Fault | None":
        """The first contradiction. A wrong current makes the resistance meaningless."""
        current_A, voltage_V, largest_A = s.current_A, s.voltage_V, self._saturation_A
        command_A = min(max(s.current_command_A, -largest_A), largest_A)
        saturated = bool(s.quality & _SATURATED)
        if self._differs(current_A, command_A, saturated=saturated):
            text = f"{current_A:.3g} A is measured, {command_A:.3g} A is set. Check amplifier and shunt."
            return _Fault("read_back", text)
        # a broken wire has the voltage of the supply, and heats nothing
        is_small = abs(current_A) < MIN_CURRENT_A
        if abs(voltage_V) > self._largest_V and not (saturated and is_small):
            text = (
                f"The voltage {voltage_V:.3g} V exceeds {self._largest_V:.3g} V, which no allowed current needs. "
                "Check shunt, amplifier and clamps."
            )
            return _Fault("voltage", text, _weight(abs(voltage_V) / self._largest_V))
        if is_small:
            return None
        if math.isnan(voltage_V):  # a source may have none; one that it had must not vanish
            return _Fault("voltage", _NO_VOLTAGE) if self._has_voltage else None
        self._has_voltage = True
        ohm = voltage_V / current_A
        expected = self._resistance
        low, high = expected.band_ohm(input_K, current_A) if self._phase_known else expected.any_phase_ohm
        if low <= ohm <= high:
            return None
        where = f", its limits at a predicted input of {input_K:.0f} K" if self._phase_known else ""
        text = (
            f"The wire's resistance {ohm:.4g} ohm is outside {low:.4g}…{high:.4g}{where}. Check clamps, wire and "
            "shunt (an ohmmeter on the cold wire tells which). If they are in order, correct the resistances in the "
            "actuator file, by hand or with smarig calibrate; else widen limits.resistance_tolerance and [protection]."
        )
        return _Fault("resistance", text, _weight(ohm / high))

    def _differs(self, current_A: float, command_A: float, *, saturated: bool) -> bool:
        """Whether the measured current is not the ordered one. Saturation explains too little current, never more."""
        if saturated and abs(current_A) < abs(command_A) and current_A * command_A >= 0:
            return False
        return abs(current_A - command_A) > self._tolerance_A


class _Fault(NamedTuple):
    """A contradiction in one sample: its kind, a sentence, and as how many samples it counts."""

    kind: str
    text: str
    weight: int = 1


def _weight(excess: float) -> int:
    return 2 if excess > GROSS else 1
