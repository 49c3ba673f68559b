"""The probability that a model is dissipative, and that Thm 8.2 covers it, over the uncertainty of its identification.

Models are drawn from ``model_posterior``. Each is evaluated on a grid of levels: loop areas A(M, m) ≥ 0, the density on
the diagonal for small loops, the strips of Assumption 2.1, and Q_r as a storage function. A grid can miss a violation
between its levels; the verdict about the estimate itself is proved apart. k_e = max{γ + δ, 1}/δ depends on the
controller alone, so it has the same value in every model that Thm 8.2 covers, and there is none in the others.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from smarig.certificate.model_posterior import ModelPosterior
from smarig.core import Array, UsageError, beta_quantile
from smarig.preisach import Everett, FodSurface, Mirrored
from smarig.theory import moments_on

SAMPLES = 100
_LEVELS = 129
_ZERO = 1e-9  # relative: a smaller negative value is rounding


@dataclass(frozen=True)
class Share:
    """``count`` of ``n`` draws, with the probability and its 95 % Monte-Carlo interval (Clopper–Pearson)."""

    count: int
    n: int

    @property
    def probability(self) -> float:
        """count/n."""
        return self.count / self.n

    @property
    def ci95(self) -> tuple[float, float]:
        """The interval of the probability.

        >>> [round(x, 4) for x in Share(200, 200).ci95]
        [0.9817, 1.0]
        """
        k, n = self.count, self.n
        low = beta_quantile(0.025, k, n - k + 1) if k else 0.0
        return low, beta_quantile(0.975, k + 1, n - k) if k < n else 1.0

    @property
    def text(self) -> str:
        """Probability with interval."""
        low, high = self.ci95
        return f"{self.probability:.2f} (95 %: {low:.2f} to {high:.2f})"

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        return {"probability": self.probability, "ci95": list(self.ci95)}


@dataclass(frozen=True)
class RobustCertificate:
    """Shares of the drawn models; all are None if the file holds no posterior, with the reason ``why``.

    ``least_area``: the 5, 50 and 95 % quantiles of the least loop area, output times input units; 0 without a negative
    loop.
    """

    dissipative: Share | None
    covered: Share | None
    least_area: tuple[float, float, float] | None
    basis: str
    why: str
    unit: str = ""

    @property
    def text(self) -> str:
        """The result in a sentence or two."""
        if self.dissipative is None or self.covered is None or self.least_area is None:
            return f"Probability of dissipativity: not known. {self.why}"
        unit = f" {self.unit}" if self.unit else ""
        low, _, high = (f"{v:.3g}" for v in self.least_area)
        return (
            f"Over {self.dissipative.n} models drawn from the identification ({self.basis}): dissipative with "
            f"probability {self.dissipative.text}, covered by Thm 8.2 (so that k_e holds) with probability "
            f"{self.covered.text}; least loop area {low} to {high}{unit} (5 % to 95 % quantile). The "
            "spread does not include the misfit of the surface family."
        )

    def to_json(self) -> dict[str, Any]:
        """Plain values for the key ``robust``."""
        return {
            "samples": self.dissipative.n if self.dissipative else 0,
            "dissipative": self.dissipative and self.dissipative.to_json(),
            "k_e_holds": self.covered and self.covered.to_json(),
            "least_area": self.least_area and list(self.least_area),
            "unit": self.unit,
            "drawn": self.basis,
            "why": self.why,
        }


def robust_certificate(
    posterior: ModelPosterior, samples: int = SAMPLES, *, seed: int = 0, unit: str = ""
) -> RobustCertificate:
    """Draw ``samples`` models and evaluate them. Raises UsageError for fewer than one."""
    if samples < 1:
        raise UsageError(f"A probability needs at least 1 sample, got {samples}.")
    if posterior.draw is None:
        return RobustCertificate(None, None, None, "", posterior.why, unit)
    dice = np.random.default_rng([seed, 0x524F])
    found = [_evaluated(posterior.draw(dice)) for _ in range(samples)]
    areas, covered = np.array([a for a, _ in found]), [c for _, c in found]
    low, middle, high = (float(v) for v in np.quantile(areas, [0.05, 0.5, 0.95]))
    return RobustCertificate(
        Share(int(np.sum(areas >= 0.0)), samples),
        Share(sum(covered), samples),
        (low, middle, high),
        posterior.basis,
        "",
        unit,
    )


def _evaluated(hysteresis: Everett) -> tuple[float, bool]:
    """The least loop area, and whether Thm 8.2 covers the model, on a grid of levels that contains u = 0."""
    try:
        grid = _Grid.of(hysteresis)
    except UsageError:  # a surface without amplitude
        return -np.inf, False
    least = grid.least_area()
    return least, least >= 0.0 and grid.follows_input() and grid.recoverable_is_storage()


@dataclass(frozen=True, eq=False)
class _Grid:
    """Moments ``up``, ``down`` and F, all (n, n) for α = u_i and β = u_j ≤ u_i, and μ on the diagonal (n,)."""

    u: Array
    up: Array
    down: Array
    F: Array
    on_diagonal: Array

    @classmethod
    def of(cls, hysteresis: Everett) -> "_Grid":
        u = np.linspace(hysteresis.lower, hysteresis.upper, _LEVELS)
        if hysteresis.lower < 0.0 < hysteresis.upper:
            u = np.union1d(u, 0.0)
        up, down = moments_on(hysteresis, u)
        F = hysteresis.swept(u[:, None], np.minimum(u, u[:, None]))
        return cls(u, up, down, np.tril(F), _diagonal_density(hysteresis, u))

    def least_area(self) -> float:
        """The least A(M, m), 0 if none is negative beyond rounding.

        Where μ is negative on the diagonal, small loops are negative although the grid need not show it; then the
        area 2μ ∬(α − β) = μ h³/3 of one cell stands for them.
        """
        areas = self.up - self.down
        least = float(areas.min())
        if least < -_ZERO * float(np.abs(areas).max()):
            return least
        on_diagonal = float(self.on_diagonal.min(initial=0.0))
        return on_diagonal * float(self.u[1] - self.u[0]) ** 3 / 3

    def follows_input(self) -> bool:
        """No falling strip (Assumption 2.1)."""
        inside = np.tri(self.u.size, dtype=bool)
        rising = np.where(inside[:-1], np.diff(self.F, axis=0), 0.0)
        falling = np.where(inside[:, 1:], -np.diff(self.F, axis=1), 0.0)
        return bool(min(rising.min(), falling.min()) >= -_ZERO * np.abs(self.F).max())

    def recoverable_is_storage(self) -> bool:
        """Q_r is a storage function: the strip moments of ``theory.energy.storage_function`` are not negative."""
        zero, k = int(np.searchsorted(self.u, 0.0)), np.arange(self.u.size)
        last = self.u.size - 1
        rise = np.diff(self.up, axis=0) - np.diff(self.down[:, np.clip(k, zero, last)], axis=0)
        fall = np.diff(self.down, axis=1) - np.diff(self.up[np.minimum(k, zero)], axis=1)
        above, below = k[:-1, None] >= k, k[:, None] > k[:-1]
        least = min(
            np.where(above, rise, 0.0)[zero:].min(initial=0.0),
            np.where(below, fall, 0.0)[:, :zero].min(initial=0.0),
        )
        return bool(least >= -_ZERO * max(np.abs(self.up).max(), np.abs(self.down).max()))


def _diagonal_density(hysteresis: Everett, u: Array) -> Array:
    """μ(v, v) of a surface."""
    if isinstance(hysteresis, Mirrored):
        return _diagonal_density(hysteresis.image, -u)
    return hysteresis.density(u, u) if isinstance(hysteresis, FodSurface) else np.zeros(0)
