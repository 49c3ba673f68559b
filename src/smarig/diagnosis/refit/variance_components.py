"""Maximum-likelihood variances: of the density, of the positions, and of the ambient temperature.

C(x) = Σ w_k S_k + F + N,    x = log₁₀ (w_k, s_m, s₀, s_T),    − log p(y | x) at its least, by its gradient
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotri, dpotrs
from scipy.optimize import OptimizeResult, minimize

from smarig.core import Array
from smarig.diagnosis.drive_statistics import DriveStatistics
from smarig.replay import PlantModel, Timeline

AT_BOUND, LOG_FLUCTUATION_STILL = 0.05, -2.0  # log₁₀: distance from a bound of s_T; s_T in still air
LOG_FLUCTUATION_START = (
    -0.8
)  # log₁₀ of s_T at the start of every search: from still air it would miss ambient fluctuations
START = np.array(
    [-0.5, -1.5, -4.5, -4.0, -3.7, LOG_FLUCTUATION_START]
)  # log₁₀ of sds: parts of the density; s_m, s₀ (ranges); s_T (K)
MOVING_ERROR_BOUNDS = (
    1e-5,
    0.1,
)  # ranges: extra error of moving positions; wrong heating must not distort the density


def noise_covariance(memory: Array, own_variances: Array, s_T: float, slope: Array) -> Array:
    """Σ, scaled, from the variance of each reading (n,) and the remembered noise."""
    C = slope[:, None] * (s_T**2 * memory) * slope
    C[np.diag_indices_from(C)] += own_variances
    return C


def own_variances(white: Array, is_moving: Array, s_m: float, s0: float) -> Array:
    """Variances (n,): s₀ of every position, s_m of moving ones, and each reading's own noise."""
    return white**2 + s_m**2 * is_moving + np.where(white < 1.0, s0**2, 0.0)


@dataclass(frozen=True, eq=False)
class ReadingCovariance:
    """Scaled readings y (n,) with the covariances (n, n) of the density's parts and of free constants.

    ``white`` (n,) is each reading's own noise. ``is_moving`` is 1 for moving positions. ``slope`` (n,) is the slope
    of a reading to the output in strokes. ``bounds`` limit the sds.
    """

    y: Array
    shapes: tuple[Array, ...]
    free: Array
    white: Array
    is_moving: Array
    slope: Array
    bounds: tuple[Array, Array]

    def density(self, log_components: Array) -> Array:
        """Covariance (n, n) of the outputs, in strokes²."""
        return np.sum([w * shape for w, shape in zip(10.0**log_components, self.shapes)], axis=0)

    def noise_covariance(self, memory: Array, log_components: Array) -> Array:
        """Σ (n, n)."""
        s_m, s0, s_T = 10.0 ** log_components[-3:]
        return noise_covariance(memory, own_variances(self.white, self.is_moving, s_m, s0), s_T, self.slope)

    def covariance(self, memory: Array, log_components: Array) -> Array:
        """C (n, n)."""
        density = self.slope[:, None] * self.density(log_components) * self.slope
        return density + self.free + self.noise_covariance(memory, log_components)

    def cost(self, memory: Array, log_components: Array) -> float:
        """− log likelihood at given sds."""
        return self._cost(log_components, self._parts(memory), self.free)[0]

    def likeliest(self, memory: Array, start: Array, *, from_both_sides: bool = True) -> tuple[float, Array]:
        """(−log likelihood, log₁₀ of the sds) at the minimum.

        If a search ends at a bound of s_T, another starts from the other side: ambient fluctuations and other noise
        imitate each other.
        """
        parts, bounds = self._parts(memory), self.bounds

        def minimised(start: Array) -> OptimizeResult:
            return _minimised(lambda x: self._cost(x, parts, self.free), start, bounds)

        found = minimised(start)
        if from_both_sides and min(found.x[-1] - bounds[0][-1], bounds[1][-1] - found.x[-1]) < AT_BOUND:
            fluctuating = found.x[-1] > LOG_FLUCTUATION_START
            second = minimised(
                np.append(START[:-1], LOG_FLUCTUATION_STILL if fluctuating else LOG_FLUCTUATION_START)
            )
            found = min(found, second, key=lambda f: float(f.fun))
        return float(found.fun), found.x

    def with_shape(self, shape: Array) -> "ReadingCovariance":
        """The same with one more part (n, n) of the outputs' covariance, of a variance between 1e-9 and 100."""
        bounds = tuple(np.insert(b, len(self.shapes), v) for b, v in zip(self.bounds, (-9.0, 2.0)))
        return replace(self, shapes=(*self.shapes, shape), bounds=(bounds[0], bounds[1]))

    def likeliest_near(self, memory: Array, start: Array) -> tuple[float, Array]:
        """(−log likelihood, log₁₀ of the variances and sds) at the minimum found from one start."""
        parts = self._parts(memory)
        found = _minimised(lambda x: self._cost(x, parts, self.free), start, self.bounds)
        return float(found.fun), found.x

    def _parts(self, memory: Array) -> list[Array]:
        return [self.slope[:, None] * shape * self.slope for shape in (*self.shapes, memory)]

    def _cost(self, x: Array, parts: Sequence[Array], fixed: Array) -> tuple[float, Array]:
        """− log p(y | x) and its gradient."""
        *weights, s_m, s0, s_T = 10.0**x
        weights.append(s_T**2)
        C, term = (
            fixed.copy(),
            np.empty_like(fixed),
        )  # one term in memory: new ones take longer than their numbers
        for w, part in zip(weights, parts):
            C += np.multiply(part, w, out=term)
        C[np.diag_indices_from(C)] += own_variances(self.white, self.is_moving, s_m, s0)
        L, failed = dpotrf(
            C.T, lower=1, clean=1, overwrite_a=1
        )  # transposed, C is in LAPACK's order: no copy
        if failed:
            return 1e12, np.zeros(x.size)
        a = dpotrs(L, self.y, lower=1)[0]
        value = 0.5 * float(self.y @ a) + float(np.log(np.diag(L)).sum())
        inverse = dpotri(L, lower=1, overwrite_c=1)[0].T  # one triangle, in the order of the parts
        diagonal = np.diag(inverse).copy()
        by = [2 * float(np.vdot(inverse, S)) - float(diagonal @ np.diag(S)) - float(a @ S @ a) for S in parts]
        variance_gradient = diagonal - a * a
        slopes = [w * b for w, b in zip(weights[:-1], by)]
        slopes += [
            2 * s_m**2 * float(variance_gradient @ self.is_moving),
            2 * s0**2 * float(variance_gradient @ (self.white < 1.0)),
            2 * s_T**2 * by[-1],
        ]
        return value, 0.5 * np.log(10.0) * np.array(slopes)


def _minimised(
    cost: Callable[[Array], tuple[float, Array]], start: Array, bounds: tuple[Array, Array]
) -> OptimizeResult:
    """The minimum of a cost with its gradient, from a start within bounds."""
    return minimize(
        cost,
        np.clip(start, *bounds),
        jac=True,
        method="L-BFGS-B",
        bounds=list(zip(*bounds)),
        options={"maxiter": 30, "ftol": 1e-5},
    )


def bounds_of(timeline: Timeline, plant_model: PlantModel) -> tuple[Array, Array]:
    """Bounds of the search: from the number of samples of a mean, and from the largest plausible ambient
    fluctuation.
    """
    return _with_density(*DriveStatistics(timeline).noise_bounds(plant_model))


def _with_density(position: tuple[float, float], kelvin: tuple[float, float]) -> tuple[Array, Array]:
    """Bounds of all sds, log₁₀: those of the density's parts, then s₀ and s_T as given."""
    return (
        np.array(
            [-6.0, -6.0, -9.0, np.log10(MOVING_ERROR_BOUNDS[0]), np.log10(position[0]), np.log10(kelvin[0])]
        ),
        np.array(
            [2.0, 2.0, 0.0, np.log10(MOVING_ERROR_BOUNDS[1]), np.log10(position[1]), np.log10(kelvin[1])]
        ),
    )
