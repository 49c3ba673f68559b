"""The fit of a heat balance to a thermal record: all parameters by least squares of whitened residuals.

e_k − ρ e_{k−1},    ρ, σ from the residual of the fullest balance (a first-order autoregression)
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from smarig.diagnosis.thermal.thermal_record import HeatBalance, ThermalRecord

Array = NDArray[np.float64]
Bound = tuple[float, float, tuple[float, ...]]  # lower bound, upper bound, starts
BASE = ("start", "offset", "gain", "tau")
MOST_RHO = 0.98
TRIES = (0.02, 0.1, 0.4)  # time constants of a second mass, in record lengths


def extensions(x: ThermalRecord) -> dict[str, dict[str, Bound]]:
    """Parameters of every extension that the record could show, with bounds and starts.

    Latent heat needs a measured transformation. A lag of the wire is τ itself, which the base fits.
    """
    long = x.length
    parameters: dict[str, dict[str, Bound]] = {
        "convection": {"exponent": (-0.3, 0.8, (0.2,))},
        "sensor_lag": {
            "lag": (0.0, 0.2 * long, (0.01 * long,)),
            "dead": (0.0, 0.2 * long, (0.01 * long, 0.03 * long)),
        },
        "settling": {
            "mass_share": (0.0, 0.9, (0.3,)),
            "mass_tau": (4 * x.dt, 3 * long, tuple(s * long for s in TRIES)),
        },
    }
    if x.share is not None:
        parameters["latent_heat"] = {"latent_K": (0.0, 100.0, (5.0,)), "cooling_K": (0.0, 100.0, (5.0,))}
    return parameters


@dataclass(frozen=True, eq=False)
class HeatBalanceFit:
    """A fitted balance with the extensions ``names``, its residual (n,) and its whitened χ²."""

    names: tuple[str, ...]
    balance: HeatBalance
    residual: Array
    chi2: float
    spread: dict[str, float]

    @property
    def rms(self) -> float:
        """Rms of the residual, kelvin."""
        return float(np.sqrt(np.mean(self.residual**2)))


@dataclass(frozen=True)
class RedNoise:
    """First-order autoregressive noise: correlation from bin to bin, sd of the innovations."""

    rho: float
    sigma: float

    def whitened(self, e: Array) -> Array:
        """The innovations divided by their standard deviation, (n,)."""
        white = np.append(e[0] * np.sqrt(1 - self.rho**2), e[1:] - self.rho * e[:-1])
        return white / self.sigma

    def sampled(self, n: int, rng: np.random.Generator) -> Array:
        """A sample of the noise (n,)."""
        e = rng.standard_normal(n) * self.sigma
        e[0] /= np.sqrt(1 - self.rho**2)
        for k in range(1, n):
            e[k] += self.rho * e[k - 1]
        return e


WHITE = RedNoise(0.0, 1.0)


def red_noise_of(e: Array) -> RedNoise:
    """The red noise of a residual (n,)."""
    rho = float(np.clip(e[1:] @ e[:-1] / (e @ e), 0.0, MOST_RHO))
    return RedNoise(rho, max(float(np.std(e[1:] - rho * e[:-1])), 1e-9))


def start_of(x: ThermalRecord) -> dict[str, float]:
    """The start of the base fit: the linear balance by finite differences."""
    T, excess = x.temperature, x.temperature - x.room
    A = np.column_stack([x.drive[1:], -excess[:-1], np.ones(T.size - 1)])
    gain, rate, constant = np.linalg.lstsq(A, np.diff(T) / x.dt, rcond=None)[0]
    rate = min(max(float(rate), 0.2 / x.length), 0.5 / x.dt)
    return {
        "start": float(T[0]),
        "offset": float(constant / rate),
        "gain": max(float(gain), 1e-12),
        "tau": 1 / rate,
    }


def fit_balance(
    x: ThermalRecord,
    names: Sequence[str],
    noise: RedNoise,
    warm_start: HeatBalance | None = None,
    used: NDArray[np.bool_] | None = None,
    quick: bool = False,
) -> HeatBalanceFit:
    """The best balance with extensions, from several starts.

    ``used`` (n,) leaves bins out. ``quick`` tries one start and few steps, near ``warm_start``.
    """
    bounds = {q: b for name in names for q, b in extensions(x)[name].items()}
    origin = {q: getattr(warm_start, q) for q in (*BASE, *bounds)} if warm_start else start_of(x)
    low, high = _box(x, bounds)
    weight = None if used is None else used.astype(float)

    def residual(v: Array) -> Array:
        e = x.temperature - HeatBalance(**dict(zip(keys, v.tolist()))).predicted_temperature(x)
        white = noise.whitened(e)
        return white if weight is None else white * weight

    keys = (*BASE, *bounds)
    best = None
    for values in _starts(bounds, origin, quick):
        begin = np.clip([values[k] for k in keys], low + 1e-9 * (high - low), high - 1e-9 * (high - low))
        size = np.maximum(np.abs(begin), 1e-3 * (high - low))
        size[:2] = 1.0
        solution = least_squares(
            residual,
            begin,
            bounds=(low, high),
            x_scale=size,
            ftol=1e-6,
            xtol=1e-7,
            max_nfev=8 if quick else 60,
        )
        if best is None or solution.cost < best.cost:
            best = solution
    assert best is not None  # noqa: S101 - there is at least one start
    balance = HeatBalance(**dict(zip(keys, best.x.tolist())))
    e = x.temperature - balance.predicted_temperature(x)
    sd = np.sqrt(np.maximum(np.diag(np.linalg.pinv(best.jac.T @ best.jac)), 0.0))
    return HeatBalanceFit(tuple(names), balance, e, 2 * float(best.cost), dict(zip(keys, sd.tolist())))


def _box(x: ThermalRecord, bounds: dict[str, Bound]) -> tuple[Array, Array]:
    base = [(-100.0, 400.0), (-100.0, 400.0), (0.0, 1e6), (x.dt, 20 * x.length)]
    both = [*base, *[b[:2] for b in bounds.values()]]
    return np.array([b[0] for b in both]), np.array([b[1] for b in both])


def _starts(bounds: dict[str, Bound], origin: dict[str, float], quick: bool) -> list[dict[str, float]]:
    count = 1 if quick else max((len(b[2]) for b in bounds.values()), default=1)
    starts = [origin | {q: b[2][min(k, len(b[2]) - 1)] for q, b in bounds.items()} for k in range(count)]
    is_warm = any(q in origin and origin[q] != 0 for q in bounds)
    return [origin] if quick and is_warm else ([origin, *starts] if is_warm else starts)
