"""Plausibility of readings: trips and warnings from derived quantities, computed once per tick.

The tolerances refer to the wire's own constants and to the travel of its hysteresis.
"""

import math

from smarig.config import RigFile
from smarig.core import Quality, Sample
from smarig.plant import Actuator, load_of, thermomechanical_travel
from smarig.preisach import thesis_surface
from smarig.rig.electrical_plausibility import ElectricalPlausibility
from smarig.rig.rig import Alarm

REST_TAUS = 12.0  # until the wire is at rest, from any state and including sensor lags
MAX_JUMP = 0.25  # of the travel within one tick: no wire is faster,
MAX_JUMP_TAUS = 3.0  # unless the time is long: factor on the relative change of temperature in it
MIN_TRAVEL = 0.03  # of the travel: less is no motion
SLIP_LIMIT = 0.25  # of the travel, at constant input
STEADY_INPUT_BAND = 0.05  # of the range, or of the transformation's width
COLD, HOT = 0.2, 0.8  # of the range: fully cooled, fully heated
TWIN_TOLERANCE = (
    0.4  # of the resistance of a twin in process, whose effects may change it and whose shunt is right
)
TEMPERATURE_TOLERANCE = 0.25  # of the range: measured against predicted temperature,
TEMPERATURE_TAUS = 3.0  # once it has lasted for so long

MAX_STALE_SAMPLES = 20  # samples without a current reading: more than a late host causes

_STALE = int(Quality.STALE)  # plain integers, because they are used every tick
_UNRELIABLE = _STALE | int(Quality.TRIPPED)


class Plausibility:
    """``check(sample, input_K)`` returns alarms, the worst first; errors are reasons to trip.

    ``suspect``: whether the last sample contradicts the command, the wire, or the sample before.
    """

    def __init__(self, rig: RigFile, actuator: Actuator) -> None:
        limits = rig.limits
        if rig.kind == "twin" and limits.resistance_tolerance < TWIN_TOLERANCE:
            limits = limits.model_copy(update={"resistance_tolerance": TWIN_TOLERANCE})
        self._electrical = ElectricalPlausibility(limits, rig.amplifier.saturation_A, actuator)
        h = thesis_surface(actuator.file.hysteresis.surface)
        self._range_K = h.upper - h.lower
        self._lower_K = h.lower
        thermomechanical = actuator.file.thermomechanical
        travel = abs(h.y_upper - h.y_lower) if thermomechanical is None else thermomechanical_travel(actuator)
        # a narrow transformation moves a wire far within a small share of the range
        width_K = thermomechanical.width_K if thermomechanical else self._range_K
        self._steady_K = STEADY_INPUT_BAND * min(width_K, self._range_K)
        self._travel = travel / actuator.resolution(rig.encoder)
        self._period_taus = rig.period_s / actuator.tau_s
        self._jump = self._largest_motion(1)
        self._last: int | None = None
        self._last_tick = 0
        self._ticks_in_a_row = {"blind": 0, "temperature": 0}
        self._temperature_ticks = round(TEMPERATURE_TAUS * actuator.tau_s / rig.period_s)
        self._two_wire = actuator.two_wire
        load = load_of(rig, actuator)
        self._load_moves = load is not None and load.changes
        self.suspect = False
        self._max_stale = max(MAX_STALE_SAMPLES, round(rig.lease_s / rig.period_s))
        self._last_end = ""  # last end reached, cold or hot; below: extent of the position since then
        self._extent = (0, 0)
        self._rest_point = (0.0, 0)  # input and counts at the start of rest
        self._settle_ticks = self._settling_ticks = round(REST_TAUS * actuator.tau_s / rig.period_s)  # ticks

    def zeroed(self) -> None:
        """The encoder was zeroed: discard earlier counts."""
        self._last, self._last_end = None, ""

    def input_unsure(self) -> None:
        """The wire may be colder than the input says: from a hot start that is assumed, it need not move."""
        self._last_end = ""
        self._electrical.input_unsure()

    def rearmed(self) -> None:
        """A trip was cleared: a fault that persists must trip again."""
        self._ticks_in_a_row = dict.fromkeys(self._ticks_in_a_row, 0)
        self._electrical.rearmed()
        self.zeroed()

    def check(self, sample: Sample, input_K: float) -> list[Alarm]:
        """Errors and warnings that this sample is the first to show."""
        self.suspect = False
        if self._persists("blind", bool(sample.quality & _STALE), self._max_stale):
            text = f"The amplifier returned no current reading for {self._max_stale} samples. Check its converter."
            return [Alarm("error", "blind", text)]
        if sample.quality & _UNRELIABLE or math.isnan(sample.current_A):
            self._last, self._last_tick = sample.counts, sample.tick
            return []
        found = [
            *self._electrical.check(sample, input_K),
            *self._check_temperature(sample, input_K),
            *self._check_motion(sample, input_K),
        ]
        self.suspect = self._electrical.suspect or any(alarm.level == "error" for alarm in found)
        self._last, self._last_tick = sample.counts, sample.tick
        return found

    def _check_temperature(self, s: Sample, input_K: float) -> list[Alarm]:
        """A thermometer on the wire, where there is one, must follow the predicted temperature."""
        measured_K = s.temperature_degC - s.ambient_degC
        if self._two_wire or math.isnan(measured_K):
            return []
        off = abs(measured_K - input_K) > TEMPERATURE_TOLERANCE * self._range_K
        if not self._persists("temperature", off, self._temperature_ticks):
            return []
        text = (
            f"The wire is measured at {measured_K:.0f} K above ambient; its current gives {input_K:.0f} K. Check "
            "thermometer, shunt and cooling."
        )
        return [Alarm("error", "temperature", text)]

    def _persists(self, name: str, wrong: bool, often: int) -> bool:
        """Whether a condition has just lasted for ``often`` consecutive samples."""
        self._ticks_in_a_row[name] = self._ticks_in_a_row[name] + 1 if wrong else 0
        return self._ticks_in_a_row[name] == often

    def _largest_motion(self, ticks: int) -> float:
        """Counts that no wire exceeds in so many ticks."""
        return max(MAX_JUMP, -MAX_JUMP_TAUS * math.expm1(-ticks * self._period_taus)) * self._travel

    def _check_motion(self, sample: Sample, input_K: float) -> list[Alarm]:
        """A jump, also over lost samples; then motion between cold and hot, and slip."""
        counts, ticks = sample.counts, sample.tick - self._last_tick
        moved = 0 if self._last is None else counts - self._last
        if abs(moved) > self._jump and (ticks <= 1 or abs(moved) > self._largest_motion(ticks)):
            time = "one tick" if ticks <= 1 else f"{ticks} ticks"
            self._rest_point = (input_K, counts)
            return [
                Alarm(
                    "error", "jump", f"The encoder jumped by {moved} counts in {time}. Check cable and disc."
                )
            ]
        found = self._check_travel(counts, (input_K - self._lower_K) / self._range_K)
        return found + self._check_slip(counts, input_K)

    def _check_slip(self, counts: int, input_K: float) -> list[Alarm]:
        """After the settling time of wire and sensors, the position must stay while the input stays."""
        if self._last is None or abs(input_K - self._rest_point[0]) > self._steady_K:
            self._rest_point, self._settling_ticks = (input_K, counts), self._settle_ticks
        if self._settling_ticks > 0:
            self._settling_ticks -= 1
            self._rest_point = (self._rest_point[0], counts)
        moved = counts - self._rest_point[1]
        if self._load_moves or abs(moved) <= SLIP_LIMIT * self._travel:
            return []
        self._rest_point = (input_K, counts)
        text = f"The position moved by {moved} counts without heating. Check whether the wire slips."
        return [Alarm("error", "slip", text)]

    def _check_travel(self, counts: int, share: float) -> list[Alarm]:
        """Between cold and hot the wire must move."""
        low, high = self._extent
        self._extent = low, high = min(low, counts), max(high, counts)
        end = "cold" if share < COLD else "hot" if share >= HOT else ""
        if not end:
            return []
        crossed = self._last_end not in ("", end)
        self._last_end, self._extent = end, (counts, counts)
        if not crossed or high - low >= MIN_TRAVEL * self._travel:
            return []
        how = "heated" if end == "hot" else "cooled"
        text = f"The wire was fully {how} and did not move. Check the encoder and the wire."
        return [Alarm("error", "still", text)]
