"""Aligns runs for comparison: time since the start of each run, a common zero, and differences at common steps.

The output depends on the history of the input, so outputs are subtracted only as long as two runs have the same steps
in the same order. A difference is within the noise, or a shift of the input, or a change of the stroke.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf

import numpy as np

from smarig.core import Array, NotToml, UsageError, parsed_toml, root_mean_square
from smarig.identification import ErrorLevel, error_verdict, noise_floor
from smarig.record import Run
from smarig.replay import provenance, recorded_start, share_zero

ZERO_COUNTS = 2.0  # counts: two zeros of the same state of a wire differ by less, by rounding and noise
_SAME = 1e-6  # of the input's range: tolerance of equal targets


@dataclass(frozen=True, eq=False)
class AlignedRun:
    """A run aligned with the first one: ``offset`` is added to its outputs to match the zero of the first run.

    ``offset_kind`` is "reference", "known" (same session, same zero), "power-up" (both were zeroed in the same
    state of the wire), "fitted", "cold" (both were zeroed cold, and a fitted offset would exceed the
    errors of two zeros), or "unknown" (no common step).
    ``input`` and ``difference`` (k,) are the inputs of the common points and this run − first run at these points.
    ``noise`` is the standard deviation of one such difference, None if no state was repeated. ``colour`` is that of
    the run on the page.
    """

    name: str
    run: Run
    offset: float
    offset_kind: str
    input: Array
    difference: Array
    noise: float | None
    colour: str = ""

    @property
    def rms(self) -> float:
        """Root of the mean squared difference; NaN without common points."""
        return root_mean_square(self.difference) if self.difference.size else float("nan")

    @property
    def max_abs(self) -> float:
        """The largest difference; NaN without common points."""
        return float(np.abs(self.difference).max()) if self.difference.size else float("nan")


def aligned(runs: Mapping[str, Run]) -> list[AlignedRun]:
    """The runs, each aligned with the first. UsageError when their units differ."""
    check_same_units(runs)
    first = next(iter(runs.values()))
    return [_aligned_run(name, run, first) for name, run in runs.items()]


def check_same_units(runs: Mapping[str, Run]) -> None:
    """Raise UsageError unless all runs have the units of the first."""
    names = list(runs)
    first = runs[names[0]]
    for name, run in runs.items():
        if (run.unit, run.input_unit) != (first.unit, first.input_unit):
            raise UsageError(
                f"Run {name} has the units {run.unit} and {run.input_unit}, run {names[0]} has {first.unit} and "
                f"{first.input_unit}. Only runs in the same units can be compared."
            )


def _aligned_run(name: str, run: Run, first: Run) -> AlignedRun:
    n = common_steps(first, run)
    inputs, outputs = run.points()
    difference = outputs[:n] - first.points()[1][:n]
    if run is first:
        return AlignedRun(
            name=name,
            run=run,
            offset=0.0,
            offset_kind="reference",
            input=inputs[:n],
            difference=difference,
            noise=None,
        )
    offset, kind = _offset(run, first, difference)
    return AlignedRun(
        name=name,
        run=run,
        offset=offset,
        offset_kind=kind,
        input=inputs[:n],
        difference=difference + offset,
        noise=_noise(run, first),
    )


def common_steps(first: Run, run: Run) -> int:
    """The number of settled steps from the start that two runs have in common."""
    a, b = (np.array([step.target for step in each.settled], dtype=float) for each in (first, run))
    n = min(a.size, b.size)
    if not n:
        return 0
    different = np.abs(a[:n] - b[:n]) > _SAME * max(float(np.ptp(a)), float(np.ptp(b)))
    return int(np.argmax(different)) if different.any() else n


def _offset(run: Run, first: Run, difference: Array) -> tuple[float, str]:
    if share_zero(provenance(first), provenance(run)):
        return 0.0, "known"
    if (start := _state_at_power_up(first)) is not None and start == _state_at_power_up(run):
        return 0.0, "power-up"
    if not difference.size:
        return 0.0, "unknown"
    fitted, most = -float(difference.mean()), max(_zero_tolerance(first), _zero_tolerance(run))
    return (fitted, "fitted") if abs(fitted) <= most else (0.0, "cold")


def _zero_tolerance(run: Run) -> float:
    """How far the zero of a run can lie from that of the cold wire; infinite if another state may have been zeroed.

    Only ``initialise`` zeroes an encoder, and one wire is cold then. Fitted without a limit, the offset would take up
    what has changed in a wire that became slack or got play.
    """
    step = run.info.output.per_count
    zeroed = str(run.info.encoder_zero).startswith("zeroed at") and run.info.source != "import"
    if not (zeroed and step and _is_one_wire(run)):
        return inf
    return ZERO_COUNTS * abs(step)


def _is_one_wire(run: Run) -> bool:
    try:
        return parsed_toml(run.info.actuator_text or "").get("arrangement") == "one_wire"
    except NotToml:
        return False


def _state_at_power_up(run: Run) -> str | None:
    """The recorded state of a wire in which its encoder started at zero; None if the zero is another."""
    zeroed = run.info.encoder_zero == "power-up" and run.info.source != "import"
    return recorded_start(run) if zeroed else None


def _noise(run: Run, first: Run) -> float | None:
    a, b = (noise_floor(each).value for each in (first, run))
    return None if a is None or b is None else float(np.hypot(a, b))


_FEWEST = 8  # common points for a fit of shift and stroke
_CLEAR = 3.0  # standard errors
_EXPLAINED = 0.5  # of the squared difference


@dataclass(frozen=True)
class RunChange:
    """The change from the first run to another, from their common steps.

    ``level``: "good" (within the noise), "fair", "poor", or "unknown" without a noise; ``text`` is the size relative to
    the noise. ``shift`` ± ``shift_se`` of the input and ``gain`` ± ``gain_se`` of the output (as a share) are
    those that reproduce the difference best; ``explained`` is the share of its square that both explain together.
    None if the common steps are too few.
    """

    level: ErrorLevel
    text: str
    shift: tuple[float, float] | None = None
    gain: tuple[float, float] | None = None
    explained: float = 0.0

    @property
    def is_shift(self) -> bool:
        """Whether a shift of the input explains the difference."""
        return self._is(self.shift)

    @property
    def is_gain_change(self) -> bool:
        """Whether a change of the stroke explains the difference."""
        return self._is(self.gain)

    def _is(self, found: tuple[float, float] | None) -> bool:
        return found is not None and self.explained >= _EXPLAINED and abs(found[0]) > _CLEAR * found[1]


def run_change(first: AlignedRun, other: AlignedRun) -> RunChange:
    """The change from ``first`` to ``other``; the differences of ``other`` are those from ``first``."""
    d = other.difference
    y = first.run.points()[1][: d.size]
    extent = float(np.ptp(y)) if y.size else 0.0
    verdict = error_verdict(other.rms, other.noise, other.rms / extent if extent else 0.0)
    u = other.input
    if d.size < _FEWEST or not extent or not np.ptp(u):
        return RunChange(verdict.level, verdict.text)
    basis = np.column_stack([-_slopes(u, y), y - y.mean(), np.ones_like(y)])
    weights, *_ = np.linalg.lstsq(basis, d, rcond=None)
    residual = d - basis @ weights
    centred = d - d.mean()
    total = float(centred @ centred)
    if not total:
        return RunChange(verdict.level, verdict.text)
    variance = float(residual @ residual) / (d.size - basis.shape[1])
    errors = np.sqrt(variance * np.diag(np.linalg.pinv(basis.T @ basis)))
    return RunChange(
        verdict.level,
        verdict.text,
        (float(weights[0]), float(errors[0])),
        (float(weights[1]), float(errors[1])),
        1.0 - float(residual @ residual) / total,
    )


def _slopes(u: Array, y: Array) -> Array:
    """dy/du (n,) along the branch that leads to each point; zero where the input did not move."""
    du, dy = np.diff(u, prepend=u[0]), np.diff(y, prepend=y[0])
    moved = np.abs(du) > 1e-9 * np.ptp(u)
    return np.where(moved, dy / np.where(moved, du, 1.0), 0.0)
