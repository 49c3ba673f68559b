"""The motion of a wire by its model, against that of the readings, when it is heated from rest for the first time."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from smarig.config import RigFile
from smarig.core import Sample
from smarig.device import Check
from smarig.plant import Actuator
from smarig.preisach import Preisach
from smarig.rig.channel_checks import tolerance_of
from smarig.rig.response import MIN_TRAVEL, MOTION_MARGIN, UNIT_REMEDY

MIN_MOTION_COUNTS = 5  # of the model: less is no motion
NEAR = 3  # times more or less than the model: a wire that is like its file; beyond, a gauge must tell
_DIRECTION_REMEDY = "exchange the encoder's lines, or negate the reading in the driver"
_MOTION_REMEDY = f"check encoder, coupling and wire, {UNIT_REMEDY}"
_SCALE_REMEDY = f"check {UNIT_REMEDY}"


class Motion(NamedTuple):
    """How readings differ from those at rest."""

    heated_by: int
    """Counts between their medians, in the direction of heating."""
    clear: bool
    """Whether none of them is among those at rest: more than noise."""
    noise: int
    """Counts between the largest and the smallest reading at rest."""


def motion_of(rest: Sequence[Sample], heated: Sequence[Sample], sign: int) -> Motion:
    """How readings while heating differ from those at rest. ``sign``: of the counts that heating gives."""
    before, after = sorted(s.counts for s in rest), sorted(s.counts for s in heated)
    moved = after[len(after) // 2] - before[len(before) // 2]
    return Motion(sign * moved, after[0] > before[-1] or after[-1] < before[0], before[-1] - before[0])


class MotionModel:
    """The motion of the wire by its model from rest, in counts, against a measured one in the direction of heating.

    A motion of less than ``MIN_TRAVEL`` of the stroke tells nothing: before it transforms, a wire lengthens.
    One that is ``MOTION_MARGIN`` times larger or smaller than the model's is that of no wire.
    """

    def __init__(self, actuator: Actuator, file: RigFile, sign: int) -> None:
        h = actuator.hysteresis
        inputs = np.linspace(0.0, h.upper if sign > 0 else h.lower, 200)
        y = Preisach(h).simulate(inputs, actuator.file.hysteresis.initial)
        self._sign, self._inputs_K, self._actuator = sign, np.abs(inputs), actuator
        self._per_count = actuator.resolution(file.encoder)
        self._tolerance, self._name = tolerance_of(file), actuator.name
        self._counts = np.abs(y - y[0]) / self._per_count
        largest = float(self._counts.max())
        compared = MIN_TRAVEL * actuator.stroke / self._per_count
        self._compared = min(compared, largest)
        self._least = max(MIN_MOTION_COUNTS, self._compared)
        self._largest = MOTION_MARGIN * self._least
        self._certain = min(self._largest, largest)  # a coarse encoder never reaches the first

    def at(self, input_K: float) -> float:
        """The motion of the model."""
        return float(np.interp(abs(input_K), self._inputs_K, self._counts))

    def blind(self, rest: Motion) -> Check | None:
        """A failed check if readings at rest differ by as much as the least motion: they show neither its direction nor
        its size.
        """
        if rest.noise < self._least:
            return None
        unit, stroke = self._actuator.unit, self._actuator.stroke
        scatter = self._per_count * rest.noise
        least = self._per_count * self._least
        observed = (
            f"readings at rest scatter by {scatter:.3g} {unit}, {scatter / stroke:.0%} of the stroke of {stroke:.3g} "
            f"{unit}, and a motion of {least:.2g} {unit} must be seen: {_smaller_unit(unit)}? Check {UNIT_REMEDY}. If "
            "they are in order, the readings need an average, or the sensor is none for this wire"
        )
        return Check("encoder scale", False, observed)

    def has_shown(self, motion: Motion, input_K: float) -> bool:
        """Whether more heat would tell nothing more: a motion that can be compared, one that is wrong already, or none,
        although every wire within ``limits.model_tolerance`` has moved.
        """
        by_model, moved = self.at(input_K), motion.heated_by
        compared = abs(moved) >= self._least and by_model >= self._compared
        shown = motion.clear and (compared or abs(moved) > self._largest)
        return shown or self._every_wire_has_moved(input_K)

    def _every_wire_has_moved(self, input_K: float) -> bool:
        hot_K = abs(input_K)
        latest_K = hot_K if hot_K >= self._inputs_K[-1] else (1 - self._tolerance) * hot_K
        return self.at(latest_K) >= self._certain

    def direction(self, motion: Motion, where: str, input_K: float, *, transformed: bool) -> Check:
        """Whether the wire has moved, as heating moves it. ``transformed``: its resistance says that it has."""
        way = f"{where}; heating must {'decrease' if self._sign < 0 else 'increase'} the counts"
        if not motion.clear or abs(motion.heated_by) < self._least:
            why = self._no_motion(motion, input_K, transformed=transformed)
            return Check("encoder direction", False, f"{where}; {why}")
        if motion.heated_by < 0:
            return Check("encoder direction", False, f"{way}; {_DIRECTION_REMEDY}")
        return Check("encoder direction", True, way)

    def _no_motion(self, motion: Motion, input_K: float, *, transformed: bool) -> str:
        noise = (
            f"the readings at rest differ by {motion.noise}; " if not motion.clear and motion.noise else ""
        )
        few = f"{noise}a motion has {math.ceil(self._least)} counts or more; {_MOTION_REMEDY}"
        if transformed:
            return f"{few}: its resistance shows that the wire has transformed"
        if self._every_wire_has_moved(input_K):
            further = (
                f"limits.model_tolerance is {self._tolerance:g}; write a larger one, such as model_tolerance = "
                f"{_larger(self._tolerance):.2g}, under [limits] of the rig file, and it is heated further, within the "
                "limits"
            )
        else:
            further = "it needs more heat than limits.current_max_A (for wire 2 current_min_A) allows"
        return (
            f"{few}. If they are in order, the wire transforms later than {self._name}, or is colder than that file "
            f"says (check its reference_temperature at reference_current): {further}"
        )

    def scale(self, motion: Motion, input_K: float) -> Check:
        """Whether the wire has moved no more than ``MOTION_MARGIN`` times what its model has, in any direction; a
        limitation if it is far from that.

        Counts that are too large for the model to move by some tell nothing of a wire.
        """
        whole = float(self._counts.max())
        if whole < MIN_MOTION_COUNTS:
            return Check("encoder scale", False, f"its whole stroke is {whole:.2g} counts; {_SCALE_REMEDY}")
        by_model, moved = self.at(input_K), abs(motion.heated_by)
        largest = MOTION_MARGIN * max(by_model, MIN_MOTION_COUNTS)
        observed = f"{motion.heated_by} counts, {by_model:.0f} by the model of the wire (accepted: "
        if not motion.clear or moved < self._least:  # no motion, which is the direction's concern
            return Check("encoder scale", True, f"{observed}up to {largest:.0f})")
        observed += (
            f"{math.ceil(self._least)} to {largest:.0f}, as a wire may transform later than its model)"
        )
        if moved > largest:
            return Check("encoder scale", False, f"{observed}; {_SCALE_REMEDY}")
        if max(by_model, moved) <= NEAR * min(by_model, moved):
            return Check("encoder scale", True, observed)
        way = "more" if moved > by_model else "less"
        observed += f"; that is much {way}: compare its readings with a gauge, and check {UNIT_REMEDY}"
        return Check("encoder scale", True, observed, limitation=True)


def _smaller_unit(unit: str) -> str:
    """What a sensor with far too much noise may be."""
    return "a sensor in um read as mm" if unit == "mm" else f"a sensor in another unit read as {unit}"


def _larger(tolerance: float) -> float:
    """A larger tolerance: twice as large, but no more than a rig file may have."""
    return min(2 * tolerance, (1 + tolerance) / 2, 0.9)
