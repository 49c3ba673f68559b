"""Heat without response: the model of the wire has moved far, and the position next to nothing.

A wire within the tolerance of its file may do that once, so it is a warning and no trip; a sensor in another unit than
the rig file says does it always.
"""

from smarig.config import RigFile
from smarig.plant import Actuator
from smarig.preisach import Preisach
from smarig.rig.rig import Alarm
from smarig.rig.wire_bounds import BEATS_PER_TAU

MIN_TRAVEL = 0.03  # of the travel: less is no motion
MOTION_MARGIN = (
    10  # times more or less than its model: no calibrated wire deviates that far, but a wrong unit does
)
UNIT_REMEDY = "the unit of the driver, and encoder.resolution of the rig file"


class Response:
    """``add`` returns a warning when the position has moved ``MOTION_MARGIN`` times less than its model, which has
    moved by as many times ``MIN_TRAVEL`` of the stroke. One warning until ``forget``.
    """

    def __init__(self, rig: RigFile, actuator: Actuator) -> None:
        self._operator = Preisach(actuator.hysteresis, actuator.file.hysteresis.initial)
        self._actuator, self._per_count = actuator, actuator.resolution(rig.encoder)
        self._enough = MOTION_MARGIN * MIN_TRAVEL * actuator.stroke / self._per_count
        self._beat = max(1, round(actuator.tau_s / BEATS_PER_TAU / rig.period_s))
        self.forget()

    def forget(self) -> None:
        """The encoder was zeroed, or the wire may be in another state than assumed."""
        self._ticks, self._warned = 0, False
        self._counts: tuple[int, int] | None = None
        self._model: tuple[float, float] | None = None

    def add(self, counts: int, input_K: float, ticks: int, started: bool | None = None) -> list[Alarm]:
        """The next sample. ``started``: whether the wire has begun to transform by its resistance, if that tells.

        A wire that has not need not move, whatever its model does.
        """
        low, high = self._counts or (counts, counts)
        if counts < low or counts > high or self._counts is None:
            self._counts = low, high = min(low, counts), max(high, counts)
        self._ticks += ticks
        if self._ticks < self._beat:
            return []
        self._ticks = 0
        by_model = self._operator.step(input_K) / self._per_count
        least, largest = self._model or (by_model, by_model)
        self._model = least, largest = min(least, by_model), max(largest, by_model)
        expected = largest - least
        moves = high - low >= expected / MOTION_MARGIN
        if self._warned or expected < self._enough or moves or started is False:
            return []
        self._warned = True
        text = (
            f"The position has moved by {high - low} counts, and the model of {self._actuator.name} by {expected:.0f}. "
            f"Check encoder, coupling and wire, {UNIT_REMEDY}. If they are in order, the wire transforms later"
            f"{self._whose_hysteresis()}."
        )
        return [Alarm("warning", "still", text)]

    def _whose_hysteresis(self) -> str:
        """What to do if the file has none of its own wire."""
        if self._actuator.file.hysteresis.surface is None:
            return ""
        return (
            f": the hysteresis in {self._actuator.name} is still that of the thesis's wire, until smarig calibrate RUN "
            "--model MODEL has written that of yours"
        )
