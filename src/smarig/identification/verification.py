"""The result of a verification: errors of a model at the points of runs, with their noise, offsets and warnings."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, NotebookDisplay, spaced
from smarig.identification.error_verdict import ErrorParts, ErrorVerdict, error_verdict
from smarig.identification.repeatability import STEADY, Repeatability

ONLY_NOISE = "the measured range is no more than its noise"


@dataclass(frozen=True)
class PredictionErrors:
    """Errors (model minus data) of n points in the run's unit; nrmse = rms / (max − min) of the measured output.

    ``nrmse`` is NaN where noise explains the measured range: a share of that would say nothing of the model.
    """

    n: int
    rms: float
    nrmse: float
    max_abs: float

    @property
    def has_share(self) -> bool:
        """Whether there is an ``nrmse``."""
        return bool(np.isfinite(self.nrmse))

    @property
    def share_text(self) -> str:
        """The error as a share of the measured range, in words."""
        if not self.has_share:
            return ONLY_NOISE
        return f"{100 * self.nrmse:.2f} % of the measured range"

    def to_json(self) -> dict[str, float | None]:
        """Plain values."""
        nrmse = self.nrmse if self.has_share else None
        return {"n": self.n, "rms": self.rms, "nrmse": nrmse, "max_abs": self.max_abs}


@dataclass(frozen=True, eq=False)
class RunVerification:
    """The verification of one run: errors, the points behind them, and the treatment of the encoder's zero.

    ``input``, ``measured``, ``predicted`` (k,) are all settled points (offset added, NaN if the memory is unknown).
    ``counted`` (k,) marks the points that count. ``offset``, "known" or "fitted", was added to the model. ``expected``
    is the rms error to be expected at a load that was not measured, None for other runs and models. ``repeatability``
    is what repeats of the run show besides noise. ``is_training``: the model was fitted to this run. ``in_loop``: how
    many points lie where the branches of the model are apart; None if that is not known.
    """

    run: str
    settled: PredictionErrors
    transient: PredictionErrors | None
    noise_floor: float | None
    offset: float
    offset_kind: str
    input: Array
    measured: Array
    predicted: Array
    counted: NDArray[np.bool_]
    warnings: tuple[str, ...]
    expected: float | None = None
    repeatability: Repeatability = STEADY
    is_training: bool = False
    in_loop: int | None = None

    @property
    def error(self) -> Array:
        """Measured − predicted (k,); NaN at points that do not count."""
        return np.where(self.counted, self.measured - self.predicted, np.nan)

    @property
    def verdict(self) -> ErrorVerdict:
        """How the error compares with the noise of the readings."""
        parts = ErrorParts(doubtful=self.in_loop == 0)
        return error_verdict(
            self.settled.rms, self.noise_floor, self.settled.nrmse, self.repeatability, parts=parts
        )

    def to_json(self) -> dict[str, Any]:
        """Plain values, as the command line prints them."""
        return {
            "run": self.run,
            **self.settled.to_json(),
            "noise_floor": self.noise_floor,
            "repeatability": self.repeatability.to_json(),
            "verdict": self.verdict.level.value,
            "offset": self.offset,
            "offset_kind": self.offset_kind,
            **({"expected_rms": self.expected} if self.expected is not None else {}),
            **({"transient": self.transient.to_json()} if self.transient else {}),
            "warnings": list(self.warnings),
        }


@dataclass(frozen=True, eq=False)
class Verification(NotebookDisplay):
    """The verification of a model on runs."""

    model: str
    unit: str
    runs: tuple[RunVerification, ...]

    @property
    def points(self) -> int:
        """The number of points that count, over all runs."""
        return sum(run.settled.n for run in self.runs)

    @property
    def rms(self) -> float | None:
        """rms error over the points of all runs; None without any."""
        squares = sum(run.settled.n * run.settled.rms**2 for run in self.runs)
        return float(np.sqrt(squares / self.points)) if self.points else None

    @property
    def noise_floor(self) -> float | None:
        """The largest noise floor of the runs; None if none is known."""
        return max((run.noise_floor for run in self.runs if run.noise_floor), default=None)

    def to_json(self) -> dict[str, Any]:
        """{"unit", "runs": [{"run", "n", "rms", "nrmse", "max_abs", "noise_floor", …}]}."""
        return {"unit": self.unit, "runs": [run.to_json() for run in self.runs]}

    def __repr__(self) -> str:
        lines = ", ".join(
            f"{r.run}: rms {r.settled.rms:.3g}{spaced(self.unit)} (n = {r.settled.n})" for r in self.runs
        )
        return f"Verification({self.model}; {lines})"
