"""Flexible discrepancies: what a density, plausible noise and a smooth dependence on one variable make likely.

    y ~ N(0, C + s² K_z),    K_z = S k(z, z') S,    S = 1 at the output, the slope ∂y/∂u at the input

k falls exponentially with the distance in z. Every explanation is compared with the likeliest of them by likelihood,
with the sizes of all noise refitted: a named effect must explain more than any, and must leave nothing to any.
"walk" has errors that grow with the travel since the last saturation: minor loops that do not return, as in no Preisach
operator.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, eigh, solve_triangular

from smarig.diagnosis.drive_statistics import DriveStatistics
from smarig.diagnosis.refit.coupled_readings import CoupledReadings, coupled_readings
from smarig.diagnosis.refit.memory_noise import memory_covariance
from smarig.diagnosis.refit.refit import Refit
from smarig.preisach import sensitivities
from smarig.replay import PlantModel, Prediction, Timeline, predict

Array = NDArray[np.float64]
TIME_SHARES = (1 / 60, 1 / 15, 1 / 4)  # of the record's duration: correlation times
RANK_LENGTH = 0.15  # correlation length of other variables, in shares of their ranks
SATURATED_SHARE = 0.02  # of the output's range: nearer to an end counts as saturated
PLAUSIBLE_ROOM_K = 0.1  # fluctuation of the room assumed while candidates are screened
SIZES = 10.0 ** np.linspace(-9, 1, 41)  # s², strokes² or K², tried while candidates are screened
JOINTLY_TRIED = 4
WALK = "walk"
PLAIN = {WALK: "history", "branch": "history"}  # the variable that a verdict names


@dataclass(frozen=True)
class Discrepancy:
    """A dependence on ``variable`` that acts at the "input" or the "output", and its gain in nats.

    ``room_K`` and ``correlation_s`` describe the temperature noise that explains most without it. ``noise`` is the
    standard deviation that all noise beside it gives to a settled position, in output units.
    """

    variable: str
    place: str
    gain: float
    room_K: float
    correlation_s: float
    noise: float

    @property
    def not_preisach(self) -> bool:
        """Whether minor loops do not return."""
        return self.variable == WALK

    @property
    def depends_on(self) -> str:
        """The plain variable of a verdict."""
        return PLAIN.get(self.variable, self.variable)


@dataclass(frozen=True, eq=False)
class _Problem:
    """Positions with the likeliest noise that explains them without a discrepancy.

    ``cost`` is − log likelihood with it, ``components`` log₁₀ of its sds, and ``memory`` the remembered noise per K².
    """

    positions: Timeline
    plant_model: PlantModel
    prediction: Prediction
    readings: CoupledReadings
    cost: float
    components: Array
    correlation_s: float
    memory: Array

    @property
    def screening_components(self) -> Array:
        """The same sds without an implausible fluctuation of the room, which could hide a discrepancy."""
        most = min(self.components[-1], np.log10(PLAUSIBLE_ROOM_K))
        return np.append(self.components[:-1], most)

    def described(self, variable: str, place: str, gain: float, components: Array) -> Discrepancy:
        """A discrepancy with the noise beside it."""
        settled, scale = len(self.positions.settled), self.readings.scale
        square = np.diag(self.readings.covariance.noise_covariance(self.memory, components)) * scale**2
        noise = float(np.sqrt(np.mean(square[:settled])))
        room_K = float(10.0 ** self.components[-1])
        return Discrepancy(variable, place, gain, room_K, self.correlation_s, noise)


def likeliest_discrepancy(timeline: Timeline, plant_model: PlantModel, refitted: Refit) -> Discrepancy:
    """The discrepancy that makes the positions likeliest, against noise alone; ``refitted`` gives where to start."""
    problem = _problem(timeline, plant_model, refitted)
    found, start = problem.readings.covariance, problem.screening_components
    variables = DriveStatistics(timeline).variables(problem.prediction)
    kernels = list(_kernels(problem, variables))
    screened = _screened(problem, [k for _, _, k in kernels])
    best = problem.described("", "", 0.0, problem.components)
    for j in sorted(range(len(kernels)), key=lambda j: -screened[j][0])[:JOINTLY_TRIED]:
        variable, place, kernel = kernels[j]
        with_kernel, components = found.with_shape(kernel).likeliest_near(
            problem.memory, np.insert(start, len(found.shapes), np.log10(screened[j][1]))
        )
        if problem.cost - with_kernel > best.gain:
            best = problem.described(variable, place, problem.cost - with_kernel, components)
    return best


def ranked_places(
    timeline: Timeline, plant_model: PlantModel, refitted: Refit, means: dict[str, Array]
) -> tuple[tuple[str, str], ...]:
    """(variable, place) of all discrepancies, the most promising first; ``means`` are further variables."""
    problem = _problem(timeline, plant_model, refitted)
    kernels = list(_kernels(problem, DriveStatistics(timeline).variables(problem.prediction) | means))
    screened = _screened(problem, [k for _, _, k in kernels])
    order = sorted(range(len(kernels)), key=lambda j: -screened[j][0])
    return tuple(dict.fromkeys(kernels[j][:2] for j in order))


def _problem(timeline: Timeline, plant_model: PlantModel, refitted: Refit) -> _Problem:
    positions = timeline.positions_only
    prediction = predict(timeline, plant_model).positions_only
    readings = coupled_readings(positions, prediction, plant_model)
    cost, components, seconds, memory = np.inf, refitted.log_components, 0.0, np.empty((0, 0))
    for trial_s in DriveStatistics(timeline).correlations_s():
        trial = memory_covariance(readings.slopes, readings.times, trial_s) / plant_model.stroke**2
        trial_cost, trial_components = readings.covariance.likeliest(trial, refitted.log_components)
        if trial_cost < cost:
            cost, components, seconds, memory = trial_cost, trial_components, trial_s, trial
    return _Problem(positions, plant_model, prediction, readings, cost, components, seconds, memory)


def _screened(problem: _Problem, kernels: list[Array]) -> list[tuple[float, float]]:
    """(gain in nats, size s²) of each kernel, added to the noise: closed form in its eigenvalues."""
    covariance = problem.readings.covariance
    C = covariance.covariance(problem.memory, problem.screening_components)
    factor = cholesky(C, lower=True, check_finite=False)

    def whitened(x: Array) -> Array:
        return solve_triangular(factor, x, lower=True, check_finite=False)

    data = whitened(covariance.y)
    found = []
    for kernel in kernels:
        values, vectors = eigh(whitened(whitened(kernel).T), check_finite=False)
        values, squares = np.maximum(values, 0.0), (vectors.T @ data) ** 2
        grown = 1 + SIZES[:, None] * values
        gains = 0.5 * np.sum(squares - squares / grown - np.log(grown), axis=1)
        best = int(np.argmax(gains))
        found.append((float(gains[best]), float(SIZES[best])))
    return found


def _kernels(problem: _Problem, variables: dict[str, Array]) -> Iterator[tuple[str, str, Array]]:
    """(variable, place, kernel (n, n)) of every discrepancy, in strokes² or per K²."""
    timeline, prediction, readings = problem.positions, problem.prediction, problem.readings
    plant_model, positions = problem.plant_model, timeline.all_readings
    step = np.concatenate([r.step for r in positions])
    t_s = np.concatenate([r.t_s for r in positions])
    same_session = np.equal.outer(timeline.session[step], timeline.session[step])
    span = plant_model.stroke
    slope = np.array([s[-1] for s in sensitivities(plant_model.hysteresis, prediction.states)]) / span
    for share in TIME_SHARES:
        seconds = share * float(np.ptp(t_s))
        yield "time", "output", same_session * falling(t_s, seconds)
        yield "time", "input", memory_covariance(readings.slopes, readings.times, seconds) / span**2

    def both(variable: str, kernel: Array) -> Iterator[tuple[str, str, Array]]:
        yield variable, "output", kernel
        yield variable, "input", slope[:, None] * kernel * slope

    for name, z in variables.items():
        if name != "time":
            yield from both(name, falling(ranks(z), RANK_LENGTH))
    same_branch = np.equal.outer(timeline.block[step], timeline.block[step])
    yield from both("branch", same_branch * falling(ranks(prediction.output), RANK_LENGTH))
    yield from both(WALK, walk_kernel(timeline.session[step], t_s, prediction.output))


def falling(z: Array, length: float) -> Array:
    """exp(−|z − z'|/length), (n, n)."""
    return np.exp(-np.abs(z[:, None] - z[None, :]) / length)


def ranks(z: Array) -> Array:
    """The share of distinct values up to each, (n,)."""
    values, place = np.unique(np.round(z, 9), return_inverse=True)
    return ((np.arange(values.size) + 0.5) / values.size)[place]


def walk_kernel(session: NDArray[np.int64], t_s: Array, output: Array) -> Array:
    """A random walk along the travel since the last saturation, (n, n)."""
    low, high = float(output.min()), float(output.max())
    span = (high - low) or 1.0
    near = SATURATED_SHARE * span
    saturated = (output < low + near) | (output > high - near)
    travel, section = np.zeros(output.size), np.zeros(output.size, dtype=np.int64)
    order = np.lexsort((t_s, session))
    for before, k in zip(order[:-1].tolist(), order[1:].tolist()):
        begins = saturated[k] or session[k] != session[before]
        section[k] = section[before] + int(begins)
        travel[k] = 0.0 if begins else travel[before] + abs(output[k] - output[before]) / span
    return np.equal.outer(section, section) * np.minimum.outer(travel, travel)
