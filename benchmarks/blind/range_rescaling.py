"""A truth in the terms of its answer: shares of a range of inputs, which a lab sees wider than the relays reach.

    i_max = (1 − c) i(top),   i ∝ √u        ⇒        1 − c′ = (1 − c) √(top / top′)
    T_R = lower + a (upper − lower)         ⇒        a′ = (T_R − lower′) / (upper′ − lower′)

Knows no other parameters: all others have units of their own.
"""

from collections.abc import Mapping
from math import sqrt

InputRange = tuple[float, float]


def rescaled_to_range(
    effects: Mapping[str, Mapping[str, float]], own: InputRange, model_range: InputRange
) -> dict[str, dict[str, float]]:
    """Effects of relays on a range ``own`` (K), as a model of the range ``model_range`` (K) would have to say them.

    >>> rescaled_to_range({"r_phase": {"at": 0.5}}, (0.0, 100.0), (0.0, 200.0))
    {'r_phase': {'at': 0.25}}
    >>> rescaled_to_range({"saturation": {"clip_percent": 0.0}}, (0.0, 81.0), (0.0, 100.0))
    {'saturation': {'clip_percent': 10.0}}
    """
    found = {name: dict(values) for name, values in effects.items()}
    if "saturation" in found:
        share = 1 - found["saturation"]["clip_percent"] / 100
        found["saturation"]["clip_percent"] = round(
            100 * (1 - share * sqrt(_top(own) / _top(model_range))), 9
        )
    if "r_phase" in found:
        at_K = own[0] + found["r_phase"]["at"] * (own[1] - own[0])
        found["r_phase"]["at"] = (at_K - model_range[0]) / (model_range[1] - model_range[0])
    return found


def _top(of: InputRange) -> float:
    return max(of[1], -of[0])
