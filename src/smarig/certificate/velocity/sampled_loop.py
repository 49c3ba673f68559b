"""The loop of Fig. 8.2 on the operator alone, sampled so that Thm 8.2 holds for the samples themselves.

    ė_k = ṙ_k − (y_k − y_{k−1})/dt,   ũ = H₁ė,   u_k = ũ_k + u_o,k,   y_k = Γ[u]_k         without delay (``implicit``)

With ⟨a, b⟩_T = dt Σ a_k b_k the algebra of the thesis holds for sums, and so does its requirement on the plant:

    Σ u_k (y_k − y_{k−1}) ≥ ∫ u dy ≥ −Q_r(B₀).

Proof. Over one move, u_k Δy − ∫ u dy = ∫ (u_k − u) dy. On a rise u_k ≥ u throughout and dy ≥ 0; on a fall both signs
change. So dy need only follow du (Assumption 2.1), and μ ≥ 0 is not required. ∎  An input beyond saturation does not
move the output further: u_k exceeds the operator's input with the sign of Δy, which only adds to the sum, so clipping
at [u₋, u₊] keeps passivity. A heating lag keeps it too: at a source s the wire moves towards s, (s − u) du ≥ 0, hence
(s − u) dy ≥ 0 and ∫ s dy ≥ ∫ u dy. ``lag_s`` adds a lag without changing the bound.

In continuous time the loop is an equation for u̇ with the factor H∞ ∂y/∂u, which requires regular ṙ or g > 0
(theory.md §8, erratum 11). The sampled loop always has a solution.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from smarig.certificate.velocity.stability import k_e, sharp_bound
from smarig.control import LaggedOperator, VelocityController
from smarig.core import Array, DataError
from smarig.preisach import Everett, Initial
from smarig.theory import recoverable_energy


@dataclass(frozen=True, eq=False)
class VelocityLoop:
    """Signals of a loop, (n,) each: ``rate`` ṙ, ``offset`` u_o, ``error`` ė, ``control`` ũ, ``u``, ``y``.

    ``stored`` is Q_r(B₀), ``y_start`` the initial output.
    """

    controller: VelocityController
    dt_s: float
    rate: Array
    offset: Array
    error: Array
    control: Array
    u: Array
    y: Array
    y_start: float
    stored: float

    def norm(self, signal: Array) -> Array:
        """‖x‖_T up to every sample, (n,)."""
        return np.sqrt(self.dt_s * np.cumsum(signal**2))

    @property
    def supplied(self) -> Array:
        """Σ u_k (y_k − y_{k−1}) up to every sample."""
        return np.cumsum(self.u * np.diff(self.y, prepend=self.y_start))

    @property
    def ratio(self) -> Array:
        """‖ė‖_T / (‖ṙ‖_T + ‖u_o‖_T) up to every sample; 0 while nothing drives the loop."""
        driven = self.norm(self.rate) + self.norm(self.offset)
        error = self.norm(self.error)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(error > 0, error / driven, 0.0)

    @property
    def largest_ratio(self) -> float:
        """The largest ratio over all T, to be compared with ``k_e``."""
        return float(self.ratio.max())

    @property
    def final_ratio(self) -> float:
        """The ratio over the whole run."""
        return float(self.ratio[-1])

    @property
    def k_e(self) -> float:
        """max{γ + δ, 1}/δ."""
        return k_e(self.controller)

    @property
    def sharp_bound(self) -> Array:
        """The bound of ‖ė‖_T up to every sample, including the initially stored energy."""
        return sharp_bound(self.controller, self.norm(self.rate), self.norm(self.offset), self.stored)

    @property
    def residual(self) -> float:
        """max |u − ũ − u_o|: the residual of the loop equation."""
        return float(np.abs(self.u - self.control - self.offset).max())

    def __repr__(self) -> str:
        return f"Loop({self.u.size} samples, largest ratio {self.largest_ratio:.4g}, k_e {self.k_e:.4g})"


def velocity_loop(
    hysteresis: Everett,
    controller: VelocityController,
    rate: ArrayLike,
    offset: float | ArrayLike = 0.0,
    *,
    dt_s: float = 0.1,
    initial: Initial = "negative",
    lag_s: float = 0.0,
) -> VelocityLoop:
    """Close the loop for velocities ``rate`` (n,), output unit per second, with an input offset u_o (one or n).

    It starts from an initial state of the operator with a controller at rest. Raises DataError for signals that are
    empty, not finite or of different lengths, UsageError for a measure of relays.

    >>> from smarig.control import constant_gain
    >>> from smarig.preisach import thesis_surface
    >>> loop = velocity_loop(thesis_surface("one_c"), constant_gain(40.0), [0.1] * 300)
    >>> loop.largest_ratio < loop.k_e
    True
    """
    rates = np.asarray(rate, dtype=float)
    offsets = np.broadcast_to(np.asarray(offset, dtype=float), rates.shape) if np.ndim(offset) == 0 else None
    offsets = np.asarray(offset, dtype=float) if offsets is None else offsets
    if rates.ndim != 1 or not rates.size or offsets.shape != rates.shape:
        raise DataError(
            f"A loop needs rates (n,) and offsets of the same shape, got {rates.shape}, {offsets.shape}."
        )
    if not (np.isfinite(rates).all() and np.isfinite(offsets).all()):
        raise DataError("A rate or an offset of the loop is not finite.")
    plant = LaggedOperator(hysteresis, initial, dt_s, lag_s)
    stored, y_start = recoverable_energy(hysteresis, plant.operator.state), plant.y
    error, control, u, y = _run(plant, controller, rates.tolist(), offsets.tolist(), dt_s)
    return VelocityLoop(
        controller=controller,
        dt_s=dt_s,
        rate=rates,
        offset=offsets,
        error=error,
        control=control,
        u=u,
        y=y,
        y_start=y_start,
        stored=stored,
    )


def _run(
    plant: LaggedOperator,
    controller: VelocityController,
    rates: list[float],
    offsets: list[float],
    dt_s: float,
) -> Array:
    """Errors, controls, inputs and outputs, shape (4, n)."""
    running, signals = controller.start(dt_s), np.empty((4, len(rates)))
    for k, (rate, offset) in enumerate(zip(rates, offsets, strict=True)):
        before = plant.y

        def command(y: float, rate: float = rate, offset: float = offset, before: float = before) -> float:
            return running.output(rate - (y - before) / dt_s) + offset

        u = plant.solve(command)
        y = plant.step(u)
        error = rate - (y - before) / dt_s
        signals[:, k] = error, running.output(error), u, y
        running.advance(error)
    return signals
