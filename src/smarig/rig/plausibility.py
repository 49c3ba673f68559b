"""Plausibility of readings: trips and warnings from derived quantities, computed once per tick.

The tolerances refer to the wire's own constants and to the travel of its hysteresis.
"""

import math

from smarig.config import RigFile
from smarig.core import Quality, Sample
from smarig.plant import Actuator, load_of, thermomechanical_travel
from smarig.rig.channel_checks import (
    AS_IN_FILES,
    COUNT_STEP,
    LEAST_STEP_COUNTS,
    ChannelChecks,
    RigReadings,
    tolerance_of,
)
from smarig.rig.electrical_plausibility import ElectricalPlausibility
from smarig.rig.response import MIN_TRAVEL, UNIT_REMEDY, Response
from smarig.rig.rig import Alarm

REST_TAUS = 12.0  # until the wire is at rest, from any state and including sensor lags
SLIP_LIMIT = 0.25  # of the travel, at constant input
STEADY_INPUT_BAND = 0.05  # of the range, or of the transformation's width
COLD, HOT = 0.2, 0.8  # of the range: fully cooled, fully heated
TWIN_TOLERANCE = (
    0.4  # of the resistance of a twin in process, whose effects may change it and whose shunt is right
)

MAX_STALE_SAMPLES = 20  # samples without a current reading: more than a late host causes

_STALE = int(Quality.STALE)  # plain integers, because they are used every tick
_UNRELIABLE = _STALE | int(Quality.TRIPPED)


class Plausibility:
    """``check(sample, input_K)`` returns alarms, the worst first; errors are reasons to trip.

    ``suspect``: whether the last sample contradicts the command, the wire, or the sample before.
    """

    def __init__(self, rig: RigFile, actuator: Actuator, readings: RigReadings = AS_IN_FILES) -> None:
        limits = rig.limits
        if rig.kind == "twin" and limits.resistance_tolerance < TWIN_TOLERANCE:
            limits = limits.model_copy(update={"resistance_tolerance": TWIN_TOLERANCE})
        self._electrical = ElectricalPlausibility(limits, rig.amplifier, actuator)
        h = actuator.hysteresis
        self._range_K = h.upper - h.lower
        self._lower_K = h.lower
        thermomechanical = actuator.file.thermomechanical
        travel = actuator.stroke if thermomechanical is None else thermomechanical_travel(actuator)
        # a narrow transformation moves a wire far within a small share of the range
        width_K = thermomechanical.width_K if thermomechanical else self._range_K
        self._steady_K = STEADY_INPUT_BAND * min(width_K, self._range_K)
        load = load_of(rig, actuator)
        self._load_moves = load is not None and load.changes
        known = readings.own_wire and thermomechanical is None and not self._load_moves
        self._response = Response(rig, actuator) if known else None
        self._rest_point: tuple[float, int] | None = None  # input and counts at the start of rest
        self._settling_ticks = 0
        self._travel = travel / actuator.resolution(rig.encoder)
        step = max(COUNT_STEP * self._travel, LEAST_STEP_COUNTS)
        # a wire within the tolerance moves no further, whatever its temperature was
        self._longest = (1 + tolerance_of(rig)) * self._travel + 2 * step if readings.own_wire else math.inf
        self._unsure_extent: tuple[int, int] | None = None
        self._channels = ChannelChecks(rig, actuator, readings)
        self._by_host = not readings.counter
        self._last_tick: int | None = None
        self._unsure_until = 0
        self._rest_ticks = round(REST_TAUS * actuator.tau_s / rig.period_s)
        self._stale_in_a_row = 0
        self.suspect = False
        self._max_stale = max(MAX_STALE_SAMPLES, round(rig.lease_s / rig.period_s))
        self._last_end = ""  # last end reached, cold or hot; below: extent of the position since then
        self._extent = (0, 0)

    @property
    def stroke_counts(self) -> float:
        """Counts of the whole stroke."""
        return self._travel

    def zeroed(self) -> None:
        """The encoder was zeroed: discard earlier counts."""
        self._rest_point, self._last_end, self._unsure_extent = None, "", None
        self._channels.zeroed()
        self._forget_response()

    def input_unsure(self) -> None:
        """The wire may be colder than the input says: from a hot start that is assumed, it need not move."""
        self._last_end = ""
        self._electrical.input_unsure()
        self._channels.forget()
        self._forget_response()

    def rearmed(self) -> None:
        """A trip was cleared: a fault that persists must trip again."""
        self._stale_in_a_row = 0
        self._electrical.rearmed()
        self._channels.rearmed()
        self.zeroed()

    def check(self, sample: Sample, input_K: float, heating_A: float | None = None) -> list[Alarm]:
        """Errors and warnings that this sample is the first to show. ``heating_A``: the current that is assumed to have
        heated the wire since the last sample; else the measured one.
        """
        self.suspect = False
        ticks = self._ticks_since(sample.tick)
        self._channels.pass_ticks(sample.current_A if heating_A is None else heating_A, ticks)
        stale = bool(sample.quality & _STALE)
        self._stale_in_a_row = self._stale_in_a_row + 1 if stale else 0
        if self._stale_in_a_row == self._max_stale:
            text = f"The amplifier returned no current reading for {self._max_stale} samples. Check its converter."
            return [Alarm("error", "blind", text)]
        if sample.quality & _UNRELIABLE or math.isnan(sample.current_A):
            return []
        found = self._electrical.check(sample, input_K)
        found += self._channels.check(sample, input_K)
        found += self._check_slip(sample.counts, input_K)
        found += self._check_travel(sample.counts, (input_K - self._lower_K) / self._range_K)
        if self._response is not None:
            found += self._response.add(sample.counts, input_K, ticks, self._channels.transformation.started)
        if sample.tick < self._unsure_until:
            found += self._check_whole_travel(sample.counts)
            self._channels.forget()
            self._forget_response()
        self.suspect = self._electrical.suspect or self._channels.suspect
        if found:
            found.sort(key=lambda alarm: alarm.level != "error")
            self.suspect = self.suspect or found[0].level == "error"
        return found

    def _forget_response(self) -> None:
        if self._response is not None:
            self._response.forget()

    def _ticks_since(self, tick: int) -> int:
        """Ticks since the last sample. A rig that ran before is in a state that only rest makes known; a clock of the
        host does not tell whether it did.
        """
        before, self._last_tick = self._last_tick, tick
        if before is None:
            self._unsure_until = tick + self._rest_ticks if tick > 1 or self._by_host else 0
            return 1
        return max(tick - before, 1)

    def _check_slip(self, counts: int, input_K: float) -> list[Alarm]:
        """After the settling time of wire and sensors, the position must stay while the input stays."""
        if self._rest_point is None or abs(input_K - self._rest_point[0]) > self._steady_K:
            self._rest_point, self._settling_ticks = (input_K, counts), self._rest_ticks
        if self._settling_ticks > 0:
            self._settling_ticks -= 1
            self._rest_point = (self._rest_point[0], counts)
        moved = counts - self._rest_point[1]
        if self._load_moves or abs(moved) <= SLIP_LIMIT * self._travel:
            return []
        self._rest_point = (input_K, counts)
        text = f"The position moved by {moved} counts without heating. Check whether the wire slips."
        return [Alarm("error", "slip", text)]

    def _check_whole_travel(self, counts: int) -> list[Alarm]:
        """However hot the wire was, it moves no further than its whole stroke."""
        low, high = self._unsure_extent or (counts, counts)
        self._unsure_extent = low, high = min(low, counts), max(high, counts)
        if self._load_moves or high - low <= self._longest:
            return []
        self._unsure_extent = (counts, counts)
        text = (
            f"The position moved by {high - low} counts, and the whole stroke of the wire is {self._travel:.0f}. "
            f"Check encoder and wire, {UNIT_REMEDY}."
        )
        return [Alarm("error", "contradiction", text)]

    def _check_travel(self, counts: int, share: float) -> list[Alarm]:
        """Between cold and hot the wire must move."""
        low, high = self._extent
        if not low <= counts <= high:
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
