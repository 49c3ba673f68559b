"""Sentences that all diagnoses share: parameters, learned terms, and the errors on held-out runs."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from smarig.core import spaced
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.noise_terms import PREDICTION_LIMIT
from smarig.plant import parameter_words

FAR_OFF_RATIO = 10.0  # times the rms error of a refitted density: the model is of another wire or state
INADEQUATE_HELD_OUT = 5.0  # times the prediction limit: worth a clause
AT_FLOOR = f"The base model already reaches the {PREDICTION_LIMIT}."


def no_extension_text(reason: str) -> str:
    """Why no extended model is offered."""
    return f"No extended model is offered: {reason}."


def learned_gain_text(gain_blocks: float, similar: Sequence[str]) -> str:
    """What a learned term removes, and the effects that leave an error which depends on the same variable."""
    size = f"It removes {100 * gain_blocks:.0f} % of the error on blocks left out of the fit."
    return f"{size} Effects that depend on the same variable: {', '.join(similar)}." if similar else size


def parameter_text(name: str, v: Mapping[str, Any]) -> str:
    """A parameter with its 95 % interval and unit."""
    ends, name = v["ci95"], parameter_words(name, v["unit"])
    if ends and ends[1] is None:  # the search is open above
        return f"{name} at least {ends[0]:.3g}{spaced(v['unit'])}"
    return (
        f"{name} {v['value']:.3g}" + (f" [{ends[0]:.3g}, {ends[1]:.3g}]" if ends else "") + spaced(v["unit"])
    )


def gain_text(gain: HeldOutGain, unit: str) -> str:
    """The gain of the extended model on held-out runs."""
    opening = (
        f"Held-out runs, {gain.blocks} blocks: rms error {gain.base:.4g} → {gain.extended:.4g}{spaced(unit)}"
    )
    if gain.original is not None:
        opening += f" (given model: {gain.original:.4g}{spaced(unit)})"
    share, ends = gain.removable_share, gain.interval()
    if gain.extended > max(gain.base, gain.floor):
        return f"{opening}. The extended model is WORSE. Check its parameters before you use it."
    if share is None:
        return f"{opening}. {AT_FLOOR}"
    between = f" (95 %: {share_text(ends[0])} to {share_text(ends[1])})" if ends else ""
    words = f"{opening}; removable share R = {share_text(share)}{between}."
    if gain.original is not None and gain.original < gain.extended:
        words += " The given model predicts them better than the extended one. Keep the given model."
    return words


def held_out_text(gain: HeldOutGain, unit: str) -> str:
    """The errors on held-out runs where no extended model is offered."""
    given = f" (given model: {gain.original:.4g}{spaced(unit)})" if gain.original is not None else ""
    ratio = gain.base / gain.floor
    many = f", {ratio:.0f} × the {PREDICTION_LIMIT}" if ratio > INADEQUATE_HELD_OUT else ""
    return f"Held-out runs, {gain.blocks} blocks: rms error {gain.base:.4g}{spaced(unit)}{many}{given}."


def as_verified(gain: HeldOutGain, unit: str, *, extended: bool) -> Iterator[str]:
    """The same in the measure of ``smarig verify``, and what differs; nothing if the measures are the same."""
    if gain.weight is None and (gain.settled is None or gain.settled.all()):
        return
    errors = [gain.settled_rms(gain.base_error)]
    if extended:
        errors.append(gain.settled_rms(gain.extended_error))
    shown = " → ".join(f"{error:.4g}" for error in errors)
    yield (
        f"At the settled points only, all with one weight, as smarig verify counts: {shown}{spaced(unit)}. The "
        "figures before also count positions during motion, and weight each by 1/σ² of its prediction. The zero of "
        "the output is estimated from all training runs; smarig verify takes that of the model."
    )


def share_text(share: float) -> str:
    """R with two decimals, or with as many as distinguish it from 1.

    >>> share_text(0.937), share_text(0.99986), share_text(-20.8193)
    ('0.94', '0.9999', '−20.82')
    """
    left = 1 - share
    digits = int(np.clip(np.ceil(-np.log10(left)), 2, 5)) if left > 0 else 2
    return f"{share:.{digits}f}".replace("-", "−")
