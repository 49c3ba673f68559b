"""The two tests of §5.3 whether a Preisach model applies, as numbers with a verdict.

Wiping-out and congruency together are necessary and sufficient for a Preisach representation (Mayergoyz; thesis
§3.3). A difference is compared with the noise of the settled points.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import DataError
from smarig.identification.settled_points import SettledPoints, settled_points
from smarig.record import Run

Array = NDArray[np.float64]
_COVERAGE = 3.0  # times the noise: a smaller difference is no evidence against the property


@dataclass(frozen=True)
class Representation:
    """One test: two curves over the same inputs that are equal in a Preisach model.

    ``first``/``second`` (k,) are in ``unit``. For congruency both are relative to their lower corner, and
    ``offset`` is the distance of the corners. ``rms``, ``max_abs`` are of the difference. ``noise`` is the rms
    difference expected from the uncertainties of the settled points.
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
    holds: bool
    span: float

    @property
    def verdict(self) -> str:
        """The result of the test in one sentence."""
        counts = f" ({self.max_abs / self.per_count:.2f} counts)" if self.per_count else ""
        size = f"{self.rms:.3g} {self.unit} rms, {self.max_abs:.3g} {self.unit}{counts} at most"
        against = f"noise alone gives differences of {self.noise:.2g} {self.unit} rms"
        what = {
            "wiping_out": ("Segment B retraces segment A", "Segment B does not retrace segment A"),
            "congruency": ("Both minor loops have the same shape", "The two minor loops differ in shape"),
        }[self.name][0 if self.holds else 1]
        return f"{what}: they differ by {size}; {against}."

    @property
    def meaning(self) -> str:
        """The consequence for a Preisach model."""
        share = 100 * self.max_abs / self.span if self.span else float("nan")
        if self.holds:
            return "At this precision the test gives no evidence against a classical Preisach model."
        return (
            f"A classical Preisach model cannot represent this difference. Expect errors of up to "
            f"{share:.1f} % of the travel for such histories."
        )

    def to_json(self) -> dict:
        """The test as JSON for model files, reports and --json."""
        keys = ("name", "rms", "max_abs", "noise", "unit", "offset", "holds")
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
    rms = float(np.sqrt(np.mean(difference**2)))
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
        holds=bool(rms <= _COVERAGE * noise),
        span=float(np.ptp(everything)),
    )
