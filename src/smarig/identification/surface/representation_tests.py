"""The two tests of §5.3 whether a Preisach model applies, as numbers with a verdict.

Wiping-out and congruency together are necessary and sufficient for a Preisach representation (Mayergoyz; thesis
§3.3).

    χ² = Σ (d_k/σ_k)²        d: differences of the two curves, σ² = σ_a² + σ_b²

A property is violated if p = P(χ²_ν ≥ χ²) < 0.01. Without a violation, the largest rms difference that such data would
still leave unnoticed in one of 20 cases is stated (noncentral χ²), so that "holds" has a size.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, chndtrinc

from smarig.core import Array, DataError, root_mean_square, spaced
from smarig.identification.settled_points import SettledPoints, settled_points
from smarig.record import Run

ALPHA = 0.01  # probability that a wire with the property fails the test
UNNOTICED = (
    0.05  # probability that a difference of the size ``hidden`` gives a χ² as small as the observed one
)


@dataclass(frozen=True)
class Representation:
    """One test: two curves over the same inputs that are equal in a Preisach model.

    ``first``/``second`` (k,) are in ``unit``. For congruency both are relative to their lower corner, and
    ``offset`` is the distance of the corners. ``rms``, ``max_abs`` are of the difference. ``noise`` is the rms
    difference expected from the uncertainties of the settled points. ``times_noise`` = √(χ²/ν) weighs each point by its
    own uncertainty, so a violation at precise points may hide in an rms that imprecise ones dominate. ``p_value`` is
    the probability of a χ² at least as large by noise alone. ``hidden`` is the rms difference that could be there all
    the same (95 %). ``spread`` (k,) are the standard deviations of the differences, and ``common`` is the difference
    of all points that the test permits: the noise of the corner of a minor loop; 0 for wiping-out.
    """

    name: str
    input: Array
    first: Array
    second: Array
    rms: float
    max_abs: float
    noise: float
    per_count: float
    unit: str
    offset: float
    p_value: float
    hidden: float
    span: float
    times_noise: float
    spread: Array
    common: float

    @property
    def holds(self) -> bool:
        """Whether noise explains the difference."""
        return self.p_value >= ALPHA

    @property
    def p_text(self) -> str:
        """The p-value as text; those below a millionth are not distinguished."""
        return f"p = {self.p_value:.2g}" if self.p_value >= 1e-6 else "p < 10⁻⁶"

    @property
    def verdict(self) -> str:
        """The result of the test in one sentence."""
        counts = f" ({self.max_abs / self.per_count:.2f} counts)" if self.per_count else ""
        size = f"{self.rms:.3g}{spaced(self.unit)} rms, {self.max_abs:.3g}{spaced(self.unit)}{counts} at most"
        # Congruency asks for the shape only: the corner's noise is common to all points, and in the rms.
        compared = {"wiping_out": "Point by point", "congruency": "In shape"}[self.name]
        against = f"{compared}, that is {self.times_noise:.2g} × what noise alone gives"
        what = {
            "wiping_out": ("Segment B retraces segment A", "Segment B does not retrace segment A"),
            "congruency": ("Both minor loops have the same shape", "The two minor loops differ in shape"),
        }[self.name][0 if self.holds else 1]
        return f"{what}: they differ by {size}. {against} (χ² test, {self.p_text})."

    @property
    def meaning(self) -> str:
        """The consequence for a Preisach model."""
        share = 100 * self.max_abs / self.span if self.span else float("nan")
        if self.holds:
            return (
                "The test gives no evidence against a classical Preisach model. A difference of up to "
                f"{self.hidden:.2g}{spaced(self.unit)} rms besides the noise could have remained unnoticed (95 %)."
            )
        return (
            "A classical Preisach model cannot represent this difference: by itself it causes errors of up to "
            f"{share:.1f} % of the range of the test, in such histories."
        )

    def to_json(self) -> dict:
        """The test as JSON for model files, reports and --json."""
        keys = (
            "name",
            "rms",
            "max_abs",
            "noise",
            "unit",
            "offset",
            "p_value",
            "hidden",
            "times_noise",
            "holds",
        )
        return {k: getattr(self, k) for k in keys} | {"verdict": self.verdict, "meaning": self.meaning}


def wiping_out(run: Run) -> Representation:
    """The wiping-out test (§5.3.1): segment B against segment A, point by point, from a run of the wiping_out
    protocol.
    """
    points = settled_points(run)
    # The first peak is approached on the major branch, the second from inside, so only the last point is common.
    labels = [f"{{}} {k}" for k in range(1, 5)]
    a = points.of(*(label.format("A") for label in labels))
    b = points.of(*(label.format("B") for label in labels))
    _need_pairs(run, "wiping_out", a, b)
    return _compare("wiping_out", a, b, 0.0, run)


def congruency(run: Run) -> Representation:
    """The congruency test (§5.3.2): both minor loops superposed at their lower corner, from a run of the congruency
    protocol.
    """
    points = settled_points(run)
    a_down, a_up, b_up, b_down = (points.of(label) for label in ("A down", "A up", "B up", "B down"))
    _need_pairs(run, "congruency", a_down, b_down)
    a, b = _joined(a_down, a_up), _joined(b_down, b_up)
    corner_a, corner_b = _at_bottom(a_down), _at_bottom(points.of("fall"))
    return _compare("congruency", _shifted(a, corner_a), _shifted(b, corner_b), corner_b - corner_a, run)


def _at_bottom(points: SettledPoints) -> float:
    return float(points.output[np.argmin(points.input)])


def _joined(first: SettledPoints, second: SettledPoints) -> SettledPoints:
    return SettledPoints(
        np.concatenate([first.input, second.input]),
        np.concatenate([first.output, second.output]),
        np.concatenate([first.uncertainty, second.uncertainty]),
        first.branch + second.branch,
        first.unit,
    )


def _shifted(points: SettledPoints, corner: float) -> SettledPoints:
    return SettledPoints(points.input, points.output - corner, points.uncertainty, points.branch, points.unit)


def _need_pairs(run: Run, name: str, a: SettledPoints, b: SettledPoints) -> None:
    if a.input.size < 2 or a.input.size != b.input.size:
        raise DataError(
            f"{run.path} contains no complete {name} test ({a.input.size} and {b.input.size} settled points). "
            f"Run the {name} protocol to its end."
        )


def _compare(name: str, a: SettledPoints, b: SettledPoints, offset: float, run: Run) -> Representation:
    difference = b.output - a.output
    noise = float(np.hypot(a.noise, b.noise))
    rms = root_mean_square(difference)
    spread = np.hypot(a.uncertainty, b.uncertainty)
    test = difference_test(difference, spread, free_offset=name == "congruency")
    everything = run.points()[1]
    return Representation(
        name=name,
        input=a.input,
        first=a.output,
        second=b.output,
        rms=rms,
        max_abs=float(np.max(np.abs(difference))),
        noise=noise,
        per_count=run.info.output.resolution,
        unit=run.unit,
        offset=offset,
        p_value=test.p_value,
        hidden=test.hidden,
        span=float(np.ptp(everything)),
        times_noise=test.times_noise,
        spread=spread,
        common=test.shift,
    )


class DifferenceTest(NamedTuple):
    """p-value of differences, the rms difference that could be hidden, √(χ²/ν), and the offset that is left out."""

    p_value: float
    hidden: float
    times_noise: float
    shift: float


def difference_test(difference: Array, sd: Array, *, free_offset: bool) -> DifferenceTest:
    """The χ² test of differences (k,) with standard deviations (k,).

    ``free_offset``: only the shape is compared, because the noise of the corner is common to all points.
    """
    weight = 1 / sd**2
    shift = float(np.average(difference, weights=weight)) if free_offset else 0.0
    chi_square, freedom = (
        float(np.sum(weight * (difference - shift) ** 2)),
        difference.size - int(free_offset),
    )
    noncentrality = chndtrinc(max(chi_square, freedom), freedom, UNNOTICED)  # no luck claimed
    by_noise = 1 / float(np.sqrt(np.mean(weight)))
    hidden = (
        by_noise * float(np.sqrt(max(noncentrality, 0.0) / freedom)) if np.isfinite(noncentrality) else np.nan
    )
    return DifferenceTest(
        float(chdtrc(freedom, chi_square)), hidden, float(np.sqrt(chi_square / freedom)), shift
    )
