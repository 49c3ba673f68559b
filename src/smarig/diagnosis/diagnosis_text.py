"""A diagnosis in plain sentences, for a terminal and a notebook. Knows no page, and computes nothing."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from smarig.diagnosis.held_out_gain import HeldOutGain

if TYPE_CHECKING:
    from smarig.diagnosis.diagnose import Diagnosis

FAR_OFF_RATIO = (
    10.0  # times what a density of its own misses: the model is not of this wire, or not of this state
)
MIN_UNRECORDED_S = 60.0  # of a sitting: two commands typed one after the other


def text_lines(d: "Diagnosis") -> Iterator[str]:
    """A diagnosis for people."""
    e, gain, best = d.error, d.gain, d.best
    p = f"p = {d.first.p_value:.2g} by {d.nulls} nulls"
    if d.verdict.word in ("silent", "not_identifiable"):
        if d.first.silent:
            yield f"Nothing stands out ({p}; an alarm needs p < {d.alpha:g})."
        else:
            yield f"Something stands out ({p}), but neither a name nor a variable explains enough to be claimed."
    if d.verdict.word == "unknown":
        yield f"Something is wrong ({p}) that depends on {d.verdict.depends_on}; no effect known explains it."
    if best is not None:
        opening = {"named": "Found", "ambiguous": "One of a set, best"}.get(
            d.verdict.word, "Nearest, not enough"
        )
        for effect in d.effects():
            values = ", ".join(_parameter_text(n, v) for n, v in effect["parameters"].items())
            yield f"{opening}: {effect['name']} ({values}), probability {effect['probability']:.2f}."
    if d.verdict.word == "ambiguous":
        yield f"The set that holds the cause with 90 % probability: {', '.join(d.verdict.names)}."
    yield (
        f"Settled points, rms: {e.original:.4g} {e.unit} by the model as given, {e.base:.4g} with its density "
        "identified "
        + ("anew" if best is None else f"anew, {e.extended:.4g} extended")
        + f"; noise {e.noise_floor:.2g}."
    )
    unsettled = [step for run in d.timeline.runs for step in run.settled if step.verdict == "timed_out"]
    if unsettled:
        yield f"{len(unsettled)} of {len(d.timeline.settled)} settled points had not settled when their time was over."
    if e.original > FAR_OFF_RATIO * max(min(e.base, e.extended), e.noise_floor):
        yield "The model as given is far from these data, whatever is hidden in them: identify it again from them."
    if d.left is not None:
        yield (
            f"More is left besides {'it' if len(d.effects()) == 1 else 'them'} than noise leaves, and it goes with "
            f"{d.left}: the name explains most, but sizes may be wrong by more than their intervals state."
        )
    if d.timeline.unrecorded_gap_s > MIN_UNRECORDED_S:
        yield (
            f"Of {d.timeline.unrecorded_gap_s / 60:.0f} min between these runs nothing is recorded: if the wire was "
            "driven meanwhile, what goes with time or counts cycles is assessed wrongly; give every run of the session."
        )
    if gain is not None and d.extended:
        yield _gain_text(gain, e.unit)
    if d.separating_run:
        yield d.separating_run["why"]
    if d.visibility.invisible:
        yield f"These data cannot show, however large: {', '.join(d.visibility.invisible)}."


def _parameter_text(name: str, v: dict[str, Any]) -> str:
    ends = v["ci95"]
    return f"{name} {v['value']:.3g}" + (f" [{ends[0]:.3g}, {ends[1]:.3g}]" if ends else "") + f" {v['unit']}"


def _gain_text(gain: HeldOutGain, unit: str) -> str:
    """What knowing the effects is worth on runs that taught nothing."""
    opening = f"Held out, {gain.blocks} blocks: {gain.base:.4g} → {gain.extended:.4g} {unit} rms"
    if gain.original is not None:
        opening += f" (the model as given: {gain.original:.4g})"
    share, ends = gain.removable_share, gain.interval()
    if gain.extended > max(gain.base, gain.floor):
        return f"{opening}: the extended model is WORSE there. Check its parameters before you use it."
    if share is None:
        return f"{opening}; the base model is at the floor of what can be predicted already."
    between = f" (95 %: {share_text(ends[0])} to {share_text(ends[1])})" if ends else ""
    words = f"{opening}, so {share_text(share)}{between} of what can be removed is gone (R)."
    if gain.original is not None and gain.original < gain.extended:
        words += (
            " The model as given predicts them better than the extended one: trust the name, keep the model."
        )
    return words


def share_text(share: float) -> str:
    """R with two decimals, or as many as tell it from one.

    >>> share_text(0.937), share_text(0.99986), share_text(-20.8193)
    ('0.94', '0.9999', '−20.82')
    """
    left = 1 - share
    digits = int(np.clip(np.ceil(-np.log10(left)), 2, 5)) if left > 0 else 2
    return f"{share:.{digits}f}".replace("-", "−")
