"""Passivity of readings: the supplied energy ∫ u dy of a measured output, and the bound that a model gives it.

    ∫ u dy ≈ Σ ½(u_k + u_k−1)(y_k − y_k−1)        beside the model's, exact, along the same input, and its bound

The sum is linear in the readings, so what their noise does to it is known: reading j weighs ½(u_j−1 − u_j+1), the two
at the ends ½(u₀ + u₁) and ½(u_k−1 + u_k). Readings that stay on one count err together. Below the bound by less than
``SPREADS`` of that, and what sampling costs, is no violation. Refuses to tell a wrong model from an input that was
predicted wrongly: u is taken as given.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.certify.certificate_units import with_unit
from smarig.certify.hysteresis_analysis import HysteresisAnalysis
from smarig.certify.passivity import passivity
from smarig.core import DataError
from smarig.preisach import Preisach, State

Array = NDArray[np.float64]
SPREADS = 4.0  # standard deviations
SHORTEST = 3  # readings that a spread can be taken from


@dataclass(frozen=True, eq=False)
class SegmentPassivity:
    """Readings without a gap, from row ``first`` on; (n,) each, output times input units, zero at the first reading.

    ``supplied`` ∫ u dy of the readings, ``spread`` its standard deviation by their noise, ``model`` the model's (NaN
    while its memory is unknown). ``bound`` is −inf for a model that is not dissipative and NaN where none is known;
    ``why`` says so, and ``proven`` whether it is a theorem. ``sampling``: how far the sum is from the integral, on the
    model's own output.
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
        """What each sample is above the bound, with the benefit of the noise: negative is a violation."""
        return self.supplied + SPREADS * self.spread + self.sampling - self.bound

    @property
    def within(self) -> bool | None:
        """Whether no sample is below the bound beyond noise; None where there is no bound."""
        return bool((self.slack >= 0).all()) if math.isfinite(self.bound) else None

    @property
    def worst(self) -> int:
        """The row of the worst sample: farthest below the bound, or of least energy where none is below it."""
        return self.first + int(np.argmin(self.slack if self.within is False else self.supplied))

    def to_json(self) -> dict[str, Any]:
        """Plain values: rows, least and last supplied energy, its deviation in the end, and the bound."""
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
    """All stretches of a record; ``noise`` is the standard deviation of one reading."""

    segments: tuple[SegmentPassivity, ...]
    noise: float
    unit: str = ""
    output_unit: str = ""

    @property
    def within(self) -> bool | None:
        """False if some stretch falls below its bound, True if none does; None if no stretch has a bound."""
        verdicts = [s.within for s in self.segments if s.within is not None]
        return all(verdicts) if verdicts else None

    @property
    def worst(self) -> SegmentPassivity:
        """The stretch with the worst sample; one with a bound, if there is one."""
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
            f"{head}: {self._energy_at(worst, k)} at worst, at sample {worst.worst}, and "
            f"{self._energy_at(worst, -1)} in the end; "
            f"the noise of a reading is {noise}. {self._verdict(worst)}"
        )

    def to_json(self) -> dict[str, Any]:
        """Plain values; what is not finite is None."""
        return {
            "within": self.within,
            "noise": self.noise,
            "unit": self.unit,
            "text": self.text,
            "segments": [s.to_json() for s in self.segments],
        }

    def _energy_at(self, s: SegmentPassivity, k: int) -> str:
        value, spread = with_unit(s.supplied[k], self.unit), with_unit(s.spread[k], self.unit, 2)
        model = "" if math.isnan(s.model[k]) else f" (the model's: {with_unit(s.model[k], self.unit)})"
        return f"{value} ± {spread}{model}"

    def _verdict(self, worst: SegmentPassivity) -> str:
        unknown = [s.why for s in self.segments if s.why]
        if self.within is None:
            return f"There is no bound to hold it against: {unknown[0]}."
        kind = "" if worst.proven else ", which is known from one side only"
        bound = f"the bound of {with_unit(worst.bound + 0.0, self.unit)}{kind}"
        rest = f" Not all could be judged: {unknown[0]}." if unknown else ""
        if self.within:
            return f"It never falls below {bound}, beyond noise.{rest}"
        return f"It falls below {bound}, by more than noise: the wire is not what this model says.{rest}"


def segment_passivity(
    hysteresis_analysis: HysteresisAnalysis,
    u: ArrayLike,
    y: ArrayLike,
    noise: float,
    first: int,
    start: State | str,
) -> SegmentPassivity:
    """One stretch of inputs and readings (n,), ``noise`` of one reading; ``start``: the state at its first input, or
    why that is not known. DataError for values that are missing or that do not belong together.

    >>> from smarig.preisach import thesis_surface
    >>> wire = Preisach(thesis_surface("one_e"))
    >>> u = np.concatenate([np.linspace(0, 120, 200), np.linspace(120, 0, 200)])
    >>> found = segment_passivity(HysteresisAnalysis.of(wire.hysteresis), u, wire.simulate(u), 0.0, 0, wire.state)
    >>> found.within, bool(abs(found.supplied - found.model).max() <= found.sampling)
    (True, True)
    """
    inputs, outputs = np.asarray(u, dtype=float), np.asarray(y, dtype=float)
    if inputs.ndim != 1 or inputs.shape != outputs.shape or not inputs.size:
        raise DataError("A segment needs as many readings as inputs, one at least.")
    if not (np.isfinite(inputs).all() and np.isfinite(outputs).all()):
        raise DataError("A segment has no gap: all its inputs and readings are finite.")
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

    Readings that follow one another with one value count as one error, others as independent ones.

    >>> noise_weight(np.array([3.0, 3.0, 3.0]), np.array([0.0, 1.0, 2.0])).round(3).tolist()   # held: its ends alone
    [0.0, 4.243, 4.243]
    """
    if u.size < 2:
        return np.zeros(u.size)
    middle = (u[1:] + u[:-1]) / 2
    inner = np.concatenate([[0.0], np.abs(np.diff(middle)), [0.0]])  # of readings 0 … n − 1, those inside
    run = np.concatenate([[0], np.cumsum(np.diff(y) != 0)])
    total = np.bincount(run, inner)
    so_far = np.cumsum(inner) - np.concatenate([[0.0], np.cumsum(total)])[run]
    before = np.concatenate([[0.0], np.cumsum(total**2)])[run]
    upto = np.concatenate([[0.0], (before + so_far**2)[:-1]])  # the last reading counts as an end
    ends = np.concatenate([[0.0], middle[0] ** 2 + middle**2])
    return np.sqrt(upto + ends)


def reading_noise(y: ArrayLike, count: float = 0.0) -> float:
    """Standard deviation of one reading: from second differences, which motion hardly shows in, but no less than a
    count's rounding. ``count``: what one count is, 0 if unknown; NaN in ``y`` are left out.

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
