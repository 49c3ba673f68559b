"""Passivity of readings: the supplied energy ∫ u dy of a measured output, and its bound from a model.

    ∫ u dy ≈ Σ ½(u_k + u_k−1)(y_k − y_k−1)        compared with the model's exact value and its bound

The sum is linear in the readings, so the effect of their noise is known: the weight of reading j is ½(u_j−1 − u_j+1),
those at the ends are ½(u₀ + u₁) and ½(u_k−1 + u_k). Consecutive readings with one value share one error. A sum below
the bound by less than ``SPREADS`` standard deviations plus the sampling error is no violation. The input u is taken
as given: the method cannot distinguish a wrong model from a wrongly predicted input.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from smarig.certificate.certificate_units import with_unit
from smarig.certificate.hysteresis_analysis import HysteresisAnalysis
from smarig.certificate.passivity import passivity
from smarig.core import Array, DataError
from smarig.preisach import Preisach, State

SPREADS = 4.0  # standard deviations
SHORTEST = 3  # smallest number of readings that determines a spread


@dataclass(frozen=True, eq=False)
class SegmentPassivity:
    """Readings without a gap, from row ``first`` on; (n,) each, output times input units, zero at the first reading.

    ``supplied`` is ∫ u dy of the readings, ``spread`` its standard deviation from their noise, ``model`` the value of
    the model (NaN while its memory is unknown). ``bound`` is −inf for a model that is not dissipative and NaN if
    unknown; ``why`` is the reason, ``proven`` whether the bound is a theorem. ``sampling`` is the error of the sum
    against the integral, computed on the model's own output.
    """

    first: int
    supplied: Array
    spread: Array
    model: Array
    bound: float
    sampling: float
    proven: bool = False
    why: str = ""

    @property
    def slack(self) -> Array:
        """Distance of each sample above the bound, with allowance for noise; negative is a violation."""
        return self.supplied + SPREADS * self.spread + self.sampling - self.bound

    @property
    def within(self) -> bool | None:
        """Whether no sample is below the bound beyond noise; None if there is no bound."""
        return bool((self.slack >= 0).all()) if math.isfinite(self.bound) else None

    @property
    def worst(self) -> int:
        """The row of the worst sample: farthest below the bound, or of smallest energy if none is below it."""
        return self.first + int(np.argmin(self.slack if self.within is False else self.supplied))

    def to_json(self) -> dict[str, Any]:
        """Plain values: rows, smallest and last supplied energy, its final deviation, and the bound."""
        return {
            "first": self.first,
            "samples": self.supplied.size,
            "least": float(self.supplied.min()),
            "end": float(self.supplied[-1]),
            "end_deviation": float(self.spread[-1]),
            "bound": self.bound if math.isfinite(self.bound) else None,
            "proved": self.proven,
            "within": self.within,
            "reason": self.why,
        }


@dataclass(frozen=True, eq=False)
class MeasuredPassivity:
    """All segments of a record; ``noise`` is the standard deviation of one reading."""

    segments: tuple[SegmentPassivity, ...]
    noise: float
    unit: str = ""
    output_unit: str = ""

    @property
    def within(self) -> bool | None:
        """False if a segment falls below its bound, True if none does; None if no segment has a bound."""
        verdicts = [s.within for s in self.segments if s.within is not None]
        return all(verdicts) if verdicts else None

    @property
    def worst(self) -> SegmentPassivity:
        """The segment with the worst sample; one with a bound, if there is one."""
        bounded = [s for s in self.segments if s.within is not None]
        return (
            min(bounded, key=lambda s: s.slack.min()) if bounded else min(self.segments, key=_least_supplied)
        )

    @property
    def text(self) -> str:
        """A few sentences for a report."""
        worst = self.worst
        k = worst.worst - worst.first
        n_segments, noise = len(self.segments), with_unit(self.noise, self.output_unit, 2)
        head = "Supplied energy of the readings" + (
            f", {n_segments} segments without a gap" if n_segments > 1 else ""
        )
        return (
            f"{head}: minimum {self._energy_at(worst, k)} at sample {worst.worst}, final value "
            f"{self._energy_at(worst, -1)}; "
            f"the noise of a reading is {noise}. {self._verdict(worst)}"
        )

    def to_json(self) -> dict[str, Any]:
        """Plain values; values that are not finite are None."""
        return {
            "within": self.within,
            "noise": self.noise,
            "unit": self.unit,
            "text": self.text,
            "segments": [s.to_json() for s in self.segments],
        }

    def _energy_at(self, s: SegmentPassivity, k: int) -> str:
        value, spread = with_unit(s.supplied[k], self.unit), with_unit(s.spread[k], self.unit, 2)
        model = "" if math.isnan(s.model[k]) else f" (model: {with_unit(s.model[k], self.unit)})"
        return f"{value} ± {spread}{model}"

    def _verdict(self, worst: SegmentPassivity) -> str:
        unknown = [s.why for s in self.segments if s.why]
        if self.within is None:
            return f"There is no bound to compare with: {unknown[0]}."
        kind = "" if worst.proven else ", which is known from one side only"
        bound = f"the bound of {with_unit(worst.bound + 0.0, self.unit)}{kind}"
        rest = f" Some segments have no bound: {unknown[0]}." if unknown else ""
        if self.within:
            return f"It does not fall below {bound} by more than noise.{rest}"
        return f"It falls below {bound} by more than noise, so the wire differs from this model.{rest}"


def segment_passivity(
    hysteresis_analysis: HysteresisAnalysis,
    u: ArrayLike,
    y: ArrayLike,
    noise: float,
    first: int,
    start: State | str,
) -> SegmentPassivity:
    """One segment of inputs and readings (n,), with the ``noise`` of one reading. ``start``: the state at its first
    input, or why it is not known. Raises DataError for missing values or different lengths.

    >>> from smarig.preisach import thesis_surface
    >>> wire = Preisach(thesis_surface("one_e"))
    >>> u = np.concatenate([np.linspace(0, 120, 200), np.linspace(120, 0, 200)])
    >>> found = segment_passivity(HysteresisAnalysis.of(wire.hysteresis), u, wire.simulate(u), 0.0, 0, wire.state)
    >>> found.within, bool(abs(found.supplied - found.model).max() <= found.sampling)
    (True, True)
    """
    inputs, outputs = np.asarray(u, dtype=float), np.asarray(y, dtype=float)
    if inputs.ndim != 1 or inputs.shape != outputs.shape or not inputs.size:
        raise DataError("A segment needs the same number of readings and inputs, at least one of each.")
    if not (np.isfinite(inputs).all() and np.isfinite(outputs).all()):
        raise DataError("A segment contains a gap. All its inputs and readings must be finite.")
    supplied, spread = trapezoid(inputs, outputs), noise * noise_weight(inputs, outputs)
    if isinstance(start, str):
        return SegmentPassivity(
            first, supplied, spread, np.full(inputs.size, np.nan), math.nan, 0.0, why=start
        )
    found = passivity(hysteresis_analysis, inputs, start)
    exact = found.supplied - found.supplied[0]
    followed = Preisach(hysteresis_analysis.hysteresis).simulate(inputs, start)
    sampling = float(np.abs(trapezoid(inputs, followed) - exact).max()) + found.rounding
    why = {
        "none": "the model is not dissipative",
        "undecided": "it is not decided whether the model is dissipative",
    }
    return SegmentPassivity(
        first=first,
        supplied=supplied,
        spread=spread,
        model=exact,
        bound=found.bound,
        sampling=sampling,
        proven=found.proven,
        why=why.get(found.basis, ""),
    )


def trapezoid(u: Array, y: Array) -> Array:
    """Σ ½(u_k + u_k−1)(y_k − y_k−1) up to each sample, (n,).

    >>> trapezoid(np.array([0.0, 2.0, 2.0]), np.array([0.0, 1.0, 3.0])).tolist()
    [0.0, 1.0, 5.0]
    """
    return np.concatenate([[0.0], np.cumsum((u[1:] + u[:-1]) / 2 * np.diff(y))])


def noise_weight(u: Array, y: Array) -> Array:
    """Standard deviation of the sum up to each sample for readings of standard deviation 1, (n,).

    Consecutive readings with one value share one error; others have independent errors.

    >>> noise_weight(np.array([3.0, 3.0, 3.0]), np.array([0.0, 1.0, 2.0])).round(3).tolist()   # held: only the ends
    [0.0, 4.243, 4.243]
    """
    if u.size < 2:
        return np.zeros(u.size)
    middle = (u[1:] + u[:-1]) / 2
    inner = np.concatenate(
        [[0.0], np.abs(np.diff(middle)), [0.0]]
    )  # weights of the inner readings of 0 … n − 1
    run = np.concatenate([[0], np.cumsum(np.diff(y) != 0)])
    total = np.bincount(run, inner)
    so_far = np.cumsum(inner) - np.concatenate([[0.0], np.cumsum(total)])[run]
    before = np.concatenate([[0.0], np.cumsum(total**2)])[run]
    upto = np.concatenate([[0.0], (before + so_far**2)[:-1]])  # the last reading counts as an end
    ends = np.concatenate([[0.0], middle[0] ** 2 + middle**2])
    return np.sqrt(upto + ends)


def reading_noise(y: ArrayLike, count: float = 0.0) -> float:
    """Standard deviation of one reading, from second differences, which suppress motion; at least the rounding of a
    count. ``count``: one count in output units, 0 if unknown. NaN in ``y`` are left out.

    >>> rng = np.random.default_rng(1)
    >>> noisy = np.linspace(0, 50, 5000) + rng.normal(0, 1, 5000)
    >>> bool(0.9 < reading_noise(noisy) < 1.1), reading_noise([1.0, 1.0], 12**0.5)
    (True, 1.0)
    """
    values = np.asarray(y, dtype=float)
    rounding = count / math.sqrt(12)
    if values.size < SHORTEST:
        return rounding
    second = np.abs(np.diff(values, 2))
    second = second[np.isfinite(second)]
    return max(rounding, 1.4826 * float(np.median(second)) / math.sqrt(6)) if second.size else rounding


def _least_supplied(s: SegmentPassivity) -> float:
    return float(s.supplied.min())
