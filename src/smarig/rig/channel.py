"""One measured channel against its prediction.

A channel is predicted up to one constant: the zero of an encoder, the resistance of a wire, the gain of a shunt, the
offset of a thermometer. Whatever the constant is, it stays. So four things cannot be:

* contradiction: the constants that agree with this sample, [x − high − tol, x − low + tol], have none in common with
  those that agreed with all samples before;
* jump: between two samples the reading changes by more than the predicted rate and a step;
* frozen: the reading stands still while every wire would move by twice the tolerance, or is the same to the last digit
  while every wire moves (``least_motion.py``), or while the wire changes if its noise is known;
* reversed: the reading moves in one direction while every wire would move by twice the tolerance in the other.

Evidence adds up and fades: a gap as large as the tolerance is enough after ``GAP_S`` seconds. A jump as large is enough
at once for a counter, which is wrong from then on; a reading of its own each time may be wrong once or twice.
"""

import math
from collections.abc import Sequence

from smarig.rig.least_motion import HELD, LeastMotion

GAP_S = 2.0  # until a gap as large as the tolerance is enough
LEAST, LARGEST = 0.05, 3.0  # weight of a gap, in tolerances
ONE_GAP, ONE_JUMP = 0.15, 0.3  # most that a single sample adds where a reading may be wrong once
FADE_PER_S = 0.05  # of what is enough
KIND_FADE_PER_S = 1 / 1800  # a wire changes slowly from one kind to another
MOST = 1.5  # evidence against a kind: what fades in a quarter of an hour
FROZEN = 300  # equal readings, and
FROZEN_RUNS = 4  # times the longest run of equal readings before
STILL = 0.25  # of the step: a reading that changes by no more stands still
NEW_IN_A_ROW = (
    3  # new readings at successive queries: the sensor repeats none until the next, and then one by chance
)


Bounds = Sequence[tuple[float, float]]  # of the prediction for each kind of wire


class Constant:
    """The values of an unknown constant that agree with every sample so far."""

    def __init__(self) -> None:
        self.low, self.high = -math.inf, math.inf
        self._low_tick = self._high_tick = 0  # when they were found
        self.against_tick = 0  # of the sample that the last one with a gap contradicts

    def gap(self, low: float, high: float, tick: int = 0) -> float:
        """How far the constants of a new sample are from those; 0 if they have some in common, which are kept."""
        if low > self.high:
            self.against_tick = self._high_tick
            return low - self.high
        if high < self.low:
            self.against_tick = self._low_tick
            return self.low - high
        if low > self.low:
            self.low, self._low_tick = low, tick
        if high < self.high:
            self.high, self._high_tick = high, tick
        return 0.0

    def widen(self, by: float) -> None:
        """The constant may have changed by so much."""
        self.low, self.high = self.low - by, self.high + by


class Flicker:
    """``frozen``: whether a reading stands still that must flicker, because its noise is known."""

    def __init__(self, *, flickers: bool) -> None:
        self._flickers, self._longest = flickers, 0
        self.run, self.n = 0, 0
        self._last = math.nan

    def add(self, value: float) -> None:
        """One more reading."""
        self.n += 1
        if value == self._last:
            self.run += 1
        else:
            self._longest = max(self._longest, self.run)
            self.run = 0
            self._last = value

    @property
    def frozen(self) -> bool:
        """Far more equal readings than ever before."""
        return self._flickers and self.run >= max(FROZEN, FROZEN_RUNS * self._longest)


class WireKind:
    """Wires of one kind, with the constant and the evidence against them."""

    def __init__(self) -> None:
        self.constant, self.gap, self.evidence = Constant(), 0.0, 0.0

    def add(self, low: float, high: float, tick: int, elapsed_s: float, tolerance: float) -> None:
        """A sample with which the constants between two values agree."""
        self.gap = gap = self.constant.gap(low, high, tick)
        evidence = self.evidence
        if evidence > 0.0:
            evidence -= KIND_FADE_PER_S * elapsed_s
            self.evidence = evidence = evidence if evidence > 0.0 else 0.0
        if gap > 0.0:
            weight = gap / tolerance
            weight = LEAST if weight < LEAST else LARGEST if weight > LARGEST else weight
            by = weight * elapsed_s / GAP_S
            evidence += by if by < ONE_GAP else ONE_GAP
            self.evidence = evidence if evidence < MOST else MOST


def _all_against(change: float, then: Bounds, now: Bounds) -> bool:
    """Whether both bounds of every kind have moved in the other direction than this change."""
    for (low, high), (low_now, high_now) in zip(then, now):
        if change * (low_now - low) >= 0 or change * (high_now - high) >= 0:
            return False
    return True


def _all_moved(then: Bounds, now: Bounds, enough: float) -> bool:
    """Whether both bounds of every kind have moved by more than enough, in one direction."""
    for (low, high), (low_now, high_now) in zip(then, now):
        at_low, at_high = low_now - low, high_now - high
        if not (at_low > enough < at_high) and not (at_low < -enough > at_high):
            return False
    return True


class ChannelCheck:
    """``add`` takes a sample; ``suspect`` tells whether it contradicts, ``fault`` names what has become certain."""

    def __init__(
        self,
        tolerance: float,
        step: float,
        period_s: float,
        *,
        counter: bool = False,
        kinds: int = 1,
        flickers: bool = False,
        moves: bool = True,
        motion: LeastMotion | None = None,
    ) -> None:
        """``moves``: whether a reading must move with the prediction; the resistance of a wire may stay as it is.
        ``motion``: what every wire has moved since the reading last changed.
        """
        self._one_jump, self._late = math.inf if counter else ONE_JUMP, not counter
        self.tolerance, self._step, self._period_s = tolerance, step, period_s
        self._kinds = [WireKind() for _ in range(kinds)]
        self.flicker, self._moves, self.motion = Flicker(flickers=flickers), moves, motion
        self._last: float | None = None
        self._allowed, self._speed = 0.0, 0.0  # what the reading may still change by, and how it changed last
        self._held, self._new_in_a_row = HELD, 0  # samples that may repeat a reading; new readings in a row
        self._tick, self._against_tick = 0, 0
        self.doubtful_ticks = 0  # before a contradiction: since the readings with which it is one
        self._evidence = 0.0  # of jumps and of a frozen reading
        self._widen_by, self._since_s = 0.0, 0.0  # since the kinds were compared last
        self._excluded = self._all_excluded = self._still = False
        self._against = False  # the reading moves, and every wire in the other direction
        self._still_from: tuple[float, Bounds] | None = None
        self.jump, self.gap, self.ticks = 0.0, 0.0, 1
        self.stands = False  # the reading, while every wire moves
        self.suspect, self.fault, self._certain = False, "", False

    def add(
        self,
        value: float,
        bounds: Bounds | None,
        rate: float,
        *,
        ticks: int,
        changes: bool,
        against: bool = False,
        must_move: bool | None = True,
    ) -> None:
        """A reading with the bounds of its prediction for each kind of wire, if there are any at this tick, and its
        largest change in the ticks since the last reading.

        ``changes``: whether the wire has changed since the reading last did. ``against``: whether the reading moves in
        no wire's direction. ``must_move``: whether the wire moves where its model does; if None, a reading that stands
        is suspect, and no evidence.
        """
        self.jump, self.ticks = 0.0, ticks
        elapsed_s = ticks * self._period_s
        self._since_s += elapsed_s
        self._tick += ticks
        if self._evidence > 0.0:
            self._evidence = max(0.0, self._evidence - FADE_PER_S * elapsed_s)
        excess = self._excess(value, rate, ticks)
        if bounds is not None:
            self._compare(value, bounds)
        against = against or (self._still and self._against)
        unmoved = self._still or (self.motion is not None and self.motion.unmoved)
        self.stands = unmoved and not against and must_move is not False
        frozen = (self.stands and bool(must_move)) or against or (changes and self.flicker.frozen)
        if frozen:
            self._evidence += min(elapsed_s / GAP_S, ONE_GAP)
        self.suspect = excess > 0 or frozen or self.stands or self._excluded
        self.fault = ""
        certain = self._evidence >= 1.0 or self._all_excluded
        if certain and not self._certain:
            standing = "reversed" if against else "frozen"
            self.fault = "contradiction" if self._evidence < 1.0 else standing if frozen else "jump"
            self.doubtful_ticks = self._tick - self._against_tick if self.fault == "contradiction" else 0
            if self.fault == "frozen" and self.motion is not None:
                self.doubtful_ticks = self.motion.doubtful_ticks
        self._certain = certain

    def _compare(self, value: float, bounds: Bounds) -> None:
        """Whether every kind of wire contradicts, and whether none stands as still as the reading."""
        elapsed_s, self._since_s = self._since_s, 0.0
        tolerance = self.tolerance
        by, self._widen_by = self._widen_by, 0.0
        least_gap, excluded, all_excluded, tick = math.inf, True, True, self._tick
        against_tick = tick
        for kind, (low, high) in zip(self._kinds, bounds):
            if by:
                kind.constant.widen(by)
            was_certain = kind.evidence >= 1.0
            kind.add(value - high - tolerance, value - low + tolerance, tick, elapsed_s, tolerance)
            gap, certain = kind.gap, kind.evidence >= 1.0
            if certain and not was_certain:  # the last that were possible
                against_tick = min(against_tick, kind.constant.against_tick)
            least_gap = gap if gap < least_gap else least_gap
            all_excluded = all_excluded and certain
            excluded = excluded and (certain or gap > 0)
        self.gap, self._excluded, self._all_excluded = least_gap, excluded, all_excluded
        self._against_tick = against_tick
        if self._moves:
            self._follow(value, bounds)

    def _follow(self, value: float, bounds: Bounds) -> None:
        """Whether the reading has not moved along, since it last did, with what every wire has moved by."""
        if self._still_from is None:
            self._still_from = value, bounds
        change, then = value - self._still_from[0], self._still_from[1]
        self._against = abs(change) > STILL * self._step
        if self._against and not _all_against(change, then, bounds):
            self._still_from, self._still, self._against = (value, bounds), False, False
        else:
            self._still = _all_moved(then, bounds, 2 * self.tolerance)

    def _excess(self, value: float, rate: float, ticks: int) -> float:
        """By how much the reading has changed more than it can; adds the evidence."""
        change = 0.0 if self._last is None else value - self._last
        self._last, moved = value, abs(change)
        excess = moved - self._allowed - rate - self._step
        self.flicker.add(value)
        # a reading that is repeated until the next query may then change by what has gathered
        self._new_in_a_row = self._new_in_a_row + 1 if moved else 0
        if self._new_in_a_row >= NEW_IN_A_ROW:
            self._held = 2
        gathers = moved == 0.0 and self.flicker.run < self._held
        if self._late and ticks > 1:  # a late reply may show an earlier moment
            self._allowed = max(0.0, self._allowed + rate - moved)
        else:
            self._allowed = self._allowed + rate if gathers else 0.0
        if excess > 0:
            self.jump = change
            self._evidence += min(abs(moved - self._speed) / self.tolerance, self._one_jump)
        self._speed = moved
        return excess

    def widen(self, by: float) -> None:
        """The constant may have changed by so much."""
        self._widen_by += by

    def pause(self) -> None:
        """No reading now: the next one may be any."""
        self._last, self.suspect = None, False

    def forget(self) -> None:
        """The constant is another one now, and the last reading of another kind."""
        self._last, self._allowed, self.gap, self._still_from = None, 0.0, 0.0, None
        self._excluded = self._still = self._against = False
        if self.motion is not None:
            self.motion.forget()
        for kind in self._kinds:
            kind.constant, kind.gap = Constant(), 0.0

    def rearm(self) -> None:
        """A trip was cleared: what persists must trip again."""
        self._evidence, self._certain, self._all_excluded = 0.0, False, False
        self._kinds = [WireKind() for _ in self._kinds]
        self.forget()
