"""Draws hysteresis models from the uncertainty that a model file carries, or states why it carries none.

    surface    parameters ~ N(estimate, covariance of the fit)

A surface stays in its family, so the misfit of the family is not in the spread. A table has no draws: its estimate
contains the noise of every node, which draws around it would add a second time, and noise of the nodes alone makes some
loop negative. A measure that was constrained to ν ≥ 0 is dissipative by construction.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array
from smarig.preisach import Everett, FodSurface, FodTable, Mirrored

Draw = Callable[[np.random.Generator], Everett]


@dataclass(frozen=True)
class ModelPosterior:
    """``draw`` makes one model from a random generator; None if the file holds no posterior, with ``why``.

    ``basis`` says in a few words what the draws vary.
    """

    draw: Draw | None
    basis: str = ""
    why: str = ""


def model_posterior(
    hysteresis: Everett,
    parameters: Sequence[str] = (),
    covariance: ArrayLike = (),
    *,
    non_negative: bool = False,
) -> ModelPosterior:
    """The posterior of a hysteresis; ``covariance`` (p, p) of its ``parameters``.

    ``non_negative``: the measure was constrained to ν ≥ 0.
    """
    if isinstance(hysteresis, Mirrored):
        image = model_posterior(hysteresis.image, parameters, covariance, non_negative=non_negative)
        draw = image.draw
        return ModelPosterior(draw and (lambda dice: Mirrored(draw(dice))), image.basis, image.why)
    if isinstance(hysteresis, FodSurface):
        return _of_surface(hysteresis, parameters, np.asarray(covariance, dtype=float))
    if not isinstance(hysteresis, FodTable):
        return ModelPosterior(None, why="The model file holds no uncertainty of a measure of relays.")
    if non_negative:
        why = (
            "The measure is non-negative by construction, so every fit of this kind is dissipative, and the model "
            "file holds no posterior of its masses."
        )
        return ModelPosterior(None, why=why)
    why = (
        "A table has one reading or few at each node, and the model file holds nothing that couples them: noise alone "
        "makes some loop of such a table negative. Identify a surface for a probability."
    )
    return ModelPosterior(None, why=why)


def _of_surface(surface: FodSurface, parameters: Sequence[str], covariance: Array) -> ModelPosterior:
    own = surface.surface_form.parameters
    p = len(parameters)
    if not p or tuple(parameters[: len(own)]) != own or covariance.shape != (p, p):
        return ModelPosterior(
            None, why="The model file holds no covariance of the parameters of its surface."
        )
    if not np.isfinite(covariance).all():
        return ModelPosterior(
            None, why="The data do not determine every parameter of the surface, so it has no covariance."
        )
    ends = {"y_upper": surface.y_upper, "y_lower": surface.y_lower}
    mean = np.array([*surface.x, *(ends[name] for name in parameters[len(own) :])])
    scale = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    value, vector = np.linalg.eigh(covariance / np.outer(scale, scale))  # parameters differ by many decades
    root = scale[:, None] * vector * np.sqrt(np.maximum(value, 0.0))

    def draw(dice: np.random.Generator) -> Everett:
        drawn = mean + root @ dice.standard_normal(p)
        at = ends | dict(zip(parameters[len(own) :], drawn[len(own) :].tolist(), strict=True))
        return FodSurface(
            surface.form,
            tuple(drawn[: len(own)].tolist()),
            surface.lower,
            surface.upper,
            at["y_lower"],
            at["y_upper"],
            surface.unit,
        )

    return ModelPosterior(draw, f"{p} parameters of the surface with their covariance")
