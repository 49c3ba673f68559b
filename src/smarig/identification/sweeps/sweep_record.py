"""The record of a run of sweeps: source temperatures that heat the wire, and block means of its position.

A block is a short part of one sweep, within which the input moves by at most 0.8 % of its range. Its mean position is
that at its mean input: the mean carries less noise of the encoder, and a moving wire dithers the counts.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.identification.calibration.holds import valid_rows
from smarig.identification.positive.observations import Observations
from smarig.identification.sweeps.sweep_heat import SweepHeat, heated_along
from smarig.plant import Actuator
from smarig.preisach import turning_points
from smarig.record import Run, void_rows
from smarig.replay import memory_states, recorded_actuator

Integers = NDArray[np.int64]
SWEEP_PROTOCOL = "continuous_reversal_curves"
BLOCK_SHARE = 0.008  # of the input range: a block is at most this wide
LONGEST_BLOCK = 20  # samples
REVERSAL_SHARE = 0.002  # of the input range: smaller reversals are noise of the current
_SETTLED = 20  # samples at the end of the hold that saturates the wire
_FEWEST = 50  # samples


@dataclass(frozen=True, eq=False)
class SweepRecord:
    """Samples (n,) of a run after the hold that saturated the wire at the lower end.

    ``source_K`` is the steady input of each measured current (5.3), ``dt_s`` the time since the sample before.
    ``valid`` marks positions that count. ``sweep`` numbers the steps of the run. ``first`` is the row of the first
    sample in the run, ``start_K`` the input before it. ``lower`` and ``upper`` contain every input for any τ.
    ``heat`` is what the heating law (5.1) leaves out, nothing at first.
    """

    run: Run
    actuator: Actuator
    source_K: Array
    dt_s: Array
    position: Array
    valid: NDArray[np.bool_]
    sweep: Integers
    first: int
    start_K: float
    lower: float
    upper: float
    heat: SweepHeat = field(default_factory=SweepHeat)

    @classmethod
    def of(cls, run: Run) -> "SweepRecord":
        """The record of a run. Raises DataError if it lacks current, position, clock or the constants of its wire."""
        for name, text in (("current_A", "current"), ("position", "position"), ("t_s", "clock")):
            if not run.has(name):
                raise DataError(
                    f"{run.path} has no {text}. Sweeps are identified from current, position and time."
                )
        actuator = _actuator(run)
        current, t = _held(run["current_A"]), _held(run["t_s"])
        source = np.array([actuator.input_for(i) for i in current.tolist()])
        counting = [step for step in run.steps if not step.void]
        first = run.rows(counting[0]).stop if counting else 0
        if len(run) - first < _FEWEST:
            raise DataError(
                f"{run.path} has {max(len(run) - first, 0)} samples of sweeps, too few to identify."
            )
        dt_s = np.diff(t, prepend=t[0] - (run.info.period_s or float(np.median(np.diff(t)))))
        start_K = float(np.mean(source[max(first - _SETTLED, 0) : first])) if first else float(source[0])
        position = run["position"][first:]
        return cls(
            run=run,
            actuator=actuator,
            source_K=source[first:],
            dt_s=np.maximum(dt_s[first:], 0.0),
            position=np.nan_to_num(position),
            valid=(np.isfinite(run["position"]) & valid_rows(run) & ~void_rows(run))[first:],
            sweep=np.nan_to_num(run["step"][first:], nan=-1.0).astype(np.int64),
            first=first,
            start_K=start_K,
            lower=float(min(source[first:].min(), start_K)),
            upper=float(max(source[first:].max(), start_K)),
        )

    @property
    def span_K(self) -> float:
        """Largest minus smallest steady input."""
        return self.upper - self.lower

    def inputs_K(self, tau_s: float) -> Array:
        """Hysteresis input u (n,) by (5.1), or by ``heat``.

        For two wires u = T₁ − T₂ obeys the same law with a signed source, because both have the same τ.
        """
        return self._constant_tau_K(tau_s) if self.heat.is_constant_tau else self._heated(tau_s)[1]

    def rises_K(self, tau_s: float) -> Array:
        """The wire's temperature above ambient (n,), to which its inputs are proportional by (5.1) only."""
        return self._constant_tau_K(tau_s) if self.heat.is_constant_tau else self._heated(tau_s)[0]

    def _heated(self, tau_s: float) -> tuple[Array, Array]:
        return heated_along(
            self.heat, tau_s, self.source_K, self.dt_s, self.held_position, self.start_K, self.middle_K
        )

    def with_heat(self, heat: SweepHeat) -> "SweepRecord":
        """The record with another law of its heat, and the same blocks."""
        found = replace(self, heat=heat)
        found.__dict__["blocks"] = self.blocks  # cached: they do not depend on the law
        return found

    @property
    def middle_K(self) -> float:
        """Half the largest steady input, at which τ is that of ``heat``."""
        return max(abs(self.lower), abs(self.upper)) / 2

    @cached_property
    def held_position(self) -> Array:
        """Positions (n,), those that do not count replaced by the last that does."""
        return _held(np.where(self.valid, self.position, np.nan))

    def _constant_tau_K(self, tau_s: float) -> Array:
        """First order with the time constant ``tau_s``, exact for every tick."""
        u, inputs = self.start_K, np.empty(self.source_K.size)
        decays = np.exp(-self.dt_s / tau_s)
        for k, (source, decay) in enumerate(zip(self.source_K.tolist(), decays.tolist())):
            u = source + (u - source) * decay
            inputs[k] = u
        return inputs

    @cached_property
    def blocks(self) -> Integers:
        """Index of the first sample of each block (b,), the same for every τ and heat."""
        u, width = self._constant_tau_K(self.actuator.tau_s).tolist(), BLOCK_SHARE * self.span_K
        sweep, edges = self.sweep.tolist(), [0]
        for k in range(1, len(u)):
            a = edges[-1]
            if sweep[k] != sweep[a] or abs(u[k] - u[a]) > width or k - a >= LONGEST_BLOCK:
                edges.append(k)
        return np.array(edges)

    @cached_property
    def sizes(self) -> Array:
        """Number of valid samples of each block (b,)."""
        return np.add.reduceat(self.valid.astype(float), self.blocks)

    def means(self, values: Array) -> Array:
        """Means of samples (n,) over the valid samples of each block (b,); NaN for blocks without one."""
        with np.errstate(invalid="ignore"):
            return np.add.reduceat(np.where(self.valid, values, 0.0), self.blocks) / np.where(
                self.sizes > 0, self.sizes, np.nan
            )

    def path(self, tau_s: float) -> tuple[Array, Array, Integers]:
        """(input, sample, block or −1 at a turning point) along the run: block means and turning points, in order."""
        u = self.inputs_K(tau_s)
        turns = np.array(turning_points(u, REVERSAL_SHARE * self.span_K)[1:-1], dtype=np.int64)
        used = np.flatnonzero(self.sizes > 0)
        ends = np.append(self.blocks[1:], u.size)
        sample = np.concatenate([(self.blocks + ends - 1)[used] / 2, turns.astype(np.float64)])
        block = np.concatenate([used, np.full(turns.size, -1)])
        inputs = np.clip(np.concatenate([self.means(u)[used], u[turns]]), self.lower, self.upper)
        order = np.argsort(sample, kind="stable")
        return inputs[order], sample[order], block[order]

    def branches(self) -> tuple[Array, Array, Integers]:
        """(input, position, sweep) of each block with a valid sample, by the constants of the actuator."""
        used = self.sizes > 0
        u = self.means(self.inputs_K(self.actuator.tau_s))[used]
        return u, self.means(self.position)[used], self.sweep[self.blocks][used]

    def observations(self, tau_s: float) -> Observations:
        """The block means as sums over the FOD surface, for one τ; a curve is a sweep."""
        inputs, _, block = self.path(tau_s)
        states = memory_states(inputs, self.lower, self.upper, "negative")
        at, used = np.flatnonzero(block >= 0), block[block >= 0]
        return Observations.of_states(
            [state for k in at.tolist() if (state := states[k]) is not None],
            self.means(self.position)[used],
            self.sweep[self.blocks][used],
            (self.lower, self.upper),
            self.run.unit,
        )

    @cached_property
    def noise(self) -> float:
        """Standard deviation expected of a block mean: scatter of neighbouring samples, and quantisation without it."""
        y, same = self.position, self.valid[2:] & self.valid[1:-1] & self.valid[:-2]
        same &= (self.sweep[2:] == self.sweep[:-2]) & (np.abs(np.diff(self.source_K, 2)) < 0.1 * self.span_K)
        bend = np.diff(y, 2)[same]
        sample = float(np.sqrt(np.mean(bend**2) / 6)) if bend.size else 0.0
        per_count = self.run.info.output.resolution or 0.0
        undithered = per_count**2 / 12 if sample < 0.3 * per_count else 0.0
        sizes = self.sizes[self.sizes > 0]
        return float(np.sqrt(sample**2 * np.mean(1 / sizes) + undithered))


def is_sweep_run(run: Run) -> bool:
    """Whether a run was made by the protocol of continuous sweeps."""
    return run.info.protocol == SWEEP_PROTOCOL


def _actuator(run: Run) -> Actuator:
    actuator = recorded_actuator(run)
    if actuator is None:
        raise DataError(f"{run.path} does not name its actuator, so its currents give no temperatures.")
    return actuator


def _held(values: Array) -> Array:
    """The values with gaps filled by the last known one."""
    known = np.isfinite(values)
    at = np.maximum.accumulate(np.where(known, np.arange(values.size), int(np.argmax(known))))
    return values[at]
