"""Plot data of an identification: curves, residuals, grids, the re-simulated input, and small loops.

Surfaces are fitted to descending first-order curves; ascending ones are fitted in the mirror image
(u, y) → (−u, −y). All values here have the units and signs of the measurement.
"""

from dataclasses import dataclass
from functools import singledispatch

import numpy as np

from smarig.core import Array, DataError
from smarig.identification import DensityReport, FittedImage, Identification, density_report
from smarig.measurement import Start
from smarig.preisach import Everett, FodSurface, FodTable, ForcTable, Mirrored, Preisach, lattice
from smarig.replay import Model

_MAP_CELLS = 40


@dataclass(frozen=True, eq=False)
class FirstOrderCurve:
    """A first-order curve: its reversal input, inputs (k,) and outputs (k,)."""

    reversal: float
    u: Array
    y: Array


def image(found: Identification) -> FittedImage:
    """The hysteresis for descending first-order curves, its mirror image for ascending ones."""
    return _descending(found.model.hysteresis, found.data.mirrored)


@singledispatch
def _descending(hysteresis: Everett, mirrored: bool) -> FittedImage:
    """The hysteresis or image that has descending curves; ``mirrored`` if the measured curves were ascending."""
    del mirrored
    raise DataError(
        f"A {type(hysteresis).__name__} has no first-order curves to draw. Identify a surface or a table."
    )


@_descending.register
def _image_of_mirrored(hysteresis: Mirrored, mirrored: bool) -> FittedImage:
    del mirrored
    return _descending(hysteresis.image, False)


@_descending.register
def _image_of_table(hysteresis: FodTable, mirrored: bool) -> FittedImage:
    return mirrored_table(hysteresis) if mirrored else hysteresis


@_descending.register(FodSurface)
@_descending.register(ForcTable)
def _image_of_itself(hysteresis: FodSurface | ForcTable, mirrored: bool) -> FittedImage:
    del mirrored
    return hysteresis


def mirrored_table(table: FodTable) -> FodTable:
    """The exact mirror image (u, y) → (−u, −y) of a table; its cells are the reflected cells of the table."""
    turned, nodes = Mirrored(table), -table.nodes[::-1]
    rising = turned.y_lower + turned.swept(nodes, np.full(nodes.size, nodes[0]))
    a, b = np.meshgrid(nodes, nodes, indexing="ij")
    values = np.where(b <= a, rising[:, None] - turned.swept(np.maximum(a, b), np.minimum(a, b)), np.nan)
    return FodTable(nodes, values, table.unit)


def sign(found: Identification) -> float:
    """−1 for fits to the mirror image, 1 otherwise."""
    return -1.0 if found.data.mirrored else 1.0


def axis_symbols(found: Identification) -> tuple[str, str]:
    """Symbols of the reversal input and of the present input: α and β for descending curves, else β and α."""
    return ("β", "α") if found.data.mirrored else ("α", "β")


def measured_curves(found: Identification) -> list[FirstOrderCurve]:
    """The measured curves in order of increasing reversal inputs."""
    s = sign(found)
    curves = [FirstOrderCurve(s * d.alpha, s * d.beta, s * d.y) for d in found.data.descending_curves()]
    return sorted(curves, key=lambda c: c.reversal)


def model_curves(found: Identification, points: int = 60) -> list[FirstOrderCurve]:
    """The curves of the model from the same reversal inputs, over the whole range."""
    s, surface = sign(found), image(found)
    curves = []
    for alpha in np.unique([d.alpha for d in found.data.descending_curves()]):
        beta = np.linspace(found.data.lower, alpha, points)
        curves.append(FirstOrderCurve(float(s * alpha), s * beta, s * np.asarray(surface.y(alpha, beta))))
    return sorted(curves, key=lambda c: c.reversal)


def interval(found: Identification, curve: FirstOrderCurve, level: float = 0.9) -> tuple[Array, Array] | None:
    """(low, high) of new readings on a model curve; None if the fit gives no intervals.

    A positive measure gives intervals for curves of the kind it was fitted to. Its curves increase with the input.
    Therefore the lower end is at least that at any lower input, and the upper end at most that at any higher input.
    """
    if found.positive is None or found.model.mirrored != found.data.mirrored:
        return None
    s, order = sign(found), np.argsort(curve.u * sign(found))
    low, high = found.positive.interval(s * curve.reversal, s * curve.u[order], level)
    low, high = np.maximum.accumulate(low), np.minimum.accumulate(high[::-1])[::-1]
    back = np.argsort(order)
    return (low[back], high[back]) if s > 0 else (-high[back], -low[back])


def residuals(found: Identification) -> tuple[Array, Array, Array]:
    """Reversal input, input, and measured − model, (k,) each, at the points of the curves."""
    d, s = found.data, sign(found)
    return s * d.alpha, s * d.beta, s * (d.y - np.asarray(image(found).y(d.alpha, d.beta)))


def resimulated(
    found: Identification, inputs: Array, between: int = 12, initial: Start = "negative"
) -> tuple[Array, Array]:
    """Dense input and output of the model along the identification input (§5.5), from an initial state."""
    dense = np.concatenate([np.linspace(a, b, between + 1)[1:] for a, b in zip(inputs, inputs[1:])])
    u = np.concatenate([inputs[:1], dense])
    operator = Preisach(found.model.hysteresis, initial)
    return u, np.array([operator.step(float(v)) for v in u])


def output_grid(found: Identification, n: int = 31) -> tuple[Array, Array, Array]:
    """Grids (n, n) of reversal input, input, and output over the Preisach plane, for a surface plot."""
    s, lower, upper = sign(found), found.data.lower, found.data.upper
    alpha, t = np.meshgrid(np.linspace(lower, upper, n), np.linspace(0, 1, n), indexing="ij")
    beta = lower + t * (alpha - lower)
    return s * alpha, s * beta, s * np.asarray(image(found).y(alpha, beta))


def density_grid(found: Identification, n: int = 51) -> tuple[Array, Array, Array] | None:
    """Grids of α, β, μ(α, β) over the half-plane α ≥ β; None for tables, whose μ is constant on cells."""
    surface = _analytic(image(found))
    if surface is None:
        return None
    a, t = np.meshgrid(np.linspace(surface.lower, surface.upper, n), np.linspace(0, 1, n), indexing="ij")
    b = surface.lower + t * (a - surface.lower)
    mu = surface.density(a, b)
    return (-b, -a, mu) if found.data.mirrored else (a, b, mu)


@singledispatch
def _analytic(hysteresis: Everett) -> FodSurface | None:
    """The hysteresis if its density is a formula, else None."""
    del hysteresis
    return None


@_analytic.register
def _itself(hysteresis: FodSurface) -> FodSurface | None:
    return hysteresis


def density_map(found: Identification) -> tuple[Array, Array, Array]:
    """μ of the identified hysteresis on a grid, as returned by ``density_of``."""
    return density_of(image(found), mirrored=found.data.mirrored)


def density_of(hysteresis: Everett, *, mirrored: bool = False, n: int = 121) -> tuple[Array, Array, Array]:
    """Nodes (surfaces) or cell edges (tables) of α and β, and μ[α, β] with NaN outside α ≥ β.

    μ of a cell is its mass divided by its area, [F(α₂,β₁) − F(α₁,β₁) − F(α₂,β₂) + F(α₁,β₂)] / (2 Δα Δβ).
    """
    u, mu = _density(hysteresis, n)
    if mirrored:  # μ(α, β) = μ̃(−β, −α)
        return -u[::-1], -u[::-1], mu[::-1, ::-1].T
    return u, u, mu


@singledispatch
def _density(hysteresis: Everett, n: int) -> tuple[Array, Array]:
    """Edges u of cells, or nodes, and μ[α, β]."""
    del n
    u = lattice(hysteresis, _MAP_CELLS)
    inputs = u.tolist()
    F = np.array([[hysteresis.everett(a, b) if b <= a else np.nan for b in inputs] for a in inputs])
    mass = F[1:, :-1] - F[:-1, :-1] - F[1:, 1:] + F[:-1, 1:]
    width = np.diff(u)
    return u, np.where(np.tri(u.size - 1, k=-1, dtype=bool), mass / (2 * width[:, None] * width), np.nan)


@_density.register
def _density_of_surface(hysteresis: FodSurface, n: int) -> tuple[Array, Array]:
    u = np.linspace(hysteresis.lower, hysteresis.upper, n)
    a, b = np.meshgrid(u, u, indexing="ij")
    return u, np.where(b <= a, hysteresis.density(a, b), np.nan)


@_density.register
def _density_of_mirrored(hysteresis: Mirrored, n: int) -> tuple[Array, Array]:
    u, _, mu = density_of(hysteresis.image, mirrored=True, n=n)
    return u, mu


@singledispatch
def hysteresis_description(hysteresis: Everett) -> str:
    """The displayed kind of a model's hysteresis: "exponential surface", "relays"."""
    del hysteresis
    return "relays"


@hysteresis_description.register
def _surface_description(hysteresis: FodSurface) -> str:
    return f"{hysteresis.form} surface"


@hysteresis_description.register
def _table_description(hysteresis: FodTable) -> str:
    del hysteresis
    return "table of first-order curves"


@hysteresis_description.register
def _curves_description(hysteresis: ForcTable) -> str:
    del hysteresis
    return "first-order reversal curves"


@hysteresis_description.register
def _mirrored_description(hysteresis: Mirrored) -> str:
    return f"{hysteresis_description(hysteresis.image)}, mirrored"


def density_report_of(found: Identification) -> DensityReport:
    """Extremes and classes of μ, in the signs of the measurement."""
    return density_report(found.model.hysteresis)


def reversible(found: Identification, n: int = 201) -> tuple[Array, Array] | None:
    """Input and g: the density of reversible relays on α = β; None for tables."""
    surface = _analytic(image(found))
    if surface is None:
        return None
    u = np.linspace(surface.lower, surface.upper, n)
    return sign(found) * u, np.asarray(surface.reversible(u))


_REVERSALS = (0.35, 0.55, 0.75)  # first-order curves, as shares of the range


def model_loops(model: Model, n: int = 40) -> tuple[Array, Array]:
    """Input and output (k,) along the major loop and some first-order curves; ``n`` points per branch."""
    low, high = model.hysteresis.lower, model.hysteresis.upper
    turns = [low, *(end for share in _REVERSALS for end in (low + share * (high - low), low)), high, low]
    u = np.concatenate([np.linspace(a, b, n) for a, b in zip(turns, turns[1:])])
    return u, model.predict(u)
