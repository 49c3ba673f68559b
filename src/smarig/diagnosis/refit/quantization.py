"""The error of an encoder's whole counts: the same wherever the position is the same.

Noise of σ counts smooths the steps of the encoder, but does not remove them. The mean of many readings at y counts
is off by

    Σ_k A_k sin(2πk y + φ_k),    A_k = exp(−2π²k²σ²)/(πk)    (Widrow and Kollár, Quantization Noise, 2008)

This is 0.15 counts at σ = 0.2, and 0.002 counts at 0.5. Holds at one position share it, so it is not white noise.
"""

from functools import cache

import numpy as np

from smarig.core import Array

HARMONICS = 3
_NOISE_COUNTS = np.linspace(0.0, 1.0, 401)  # σ of a reading before it is rounded


def quantization_traces(position: Array, noise_counts: float) -> Array:
    """Traces (n, 2 · harmonics) of the error of mean positions (n,), both in counts, of strengths ~ N(0, 1).

    ``noise_counts``: the sd of single readings before rounding (``noise_before_rounding``).

    >>> quantization_traces(np.array([0.0, 0.25]), 0.2)[:, 0].round(3).tolist()
    [0.102, 0.0]
    """
    k = np.arange(1, HARMONICS + 1)
    amplitude = _amplitudes(noise_counts)
    # the error is known as a function of the true position; as one of the mean, it has a second harmonic as well
    amplitude[1] = np.hypot(amplitude[1], np.pi * amplitude[0] ** 2)
    phase = 2 * np.pi * position[:, None] * k
    return np.concatenate([np.cos(phase), np.sin(phase)], axis=1) * np.tile(amplitude / np.sqrt(2), 2)


def noise_before_rounding(scatter_counts: float) -> float:
    """σ of single readings before rounding, from their sd as recorded; both in counts.

    The recorded variance is, on average over positions, σ² + 1/12 − Σ_k A_k²/2.

    >>> round(noise_before_rounding(0.5), 2)
    0.41
    """
    return float(np.interp(scatter_counts**2, _recorded_variances(), _NOISE_COUNTS))


@cache
def _recorded_variances() -> Array:
    """The recorded variance (counts²) at each of ``_NOISE_COUNTS``; computed once, because every refit asks."""
    errors = np.array([np.sum(_amplitudes(s, 30) ** 2) / 2 for s in _NOISE_COUNTS])
    return _NOISE_COUNTS**2 + np.maximum(1 / 12 - errors, 0.0)


def _amplitudes(noise_counts: float, harmonics: int = HARMONICS) -> Array:
    k = np.arange(1, harmonics + 1)
    return np.exp(-2 * (np.pi * k * noise_counts) ** 2) / (np.pi * k)
