"""Trial of one sealed box: it is drawn, written, and diagnosed from its files alone; then its label is
opened.

A box and its answer do not depend on the order of the trials.
"""

import tempfile
import time
from collections.abc import Mapping
from dataclasses import replace
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.boxes import Box, Label, Part, SealedBox, draw_box, draw_world_box, write_box
from benchmarks.boxes.label import KINETIC, UNLISTED_CATEGORY
from benchmarks.boxes.relays import RelayHysteresis
from smarig.core import SmarigError
from smarig.diagnosis import CommandedDiagnosis, diagnose_commanded, joint_density_from_best_start
from smarig.identification import identify
from smarig.plant import SupportsHooks, effects_from_json
from smarig.record import load_run

Record = dict[str, Any]
SURFACE = "positive"


InputRange = tuple[float, float]


@threadpool_limits.wrap(limits=1, user_api="blas")
def trial(seed: int, number: int, part: Part | None = None) -> Record:
    """A box's answer and its truth, as plain values; with ``part``, of a box from all worlds."""
    started = time.process_time()
    box = draw_box(seed, number) if part is None else draw_world_box(seed, number, part)
    with tempfile.TemporaryDirectory() as folder:
        sealed = write_box(box, Path(folder))
        without = (box.left_out,) if box.left_out else ()
        try:
            found = _answer(sealed, without, number)
        except SmarigError as error:
            return {"number": number, "error": str(error)} | _truth(sealed.label, sealed.label.effects)
    seconds = time.process_time() - started
    return (
        {"number": number, "seconds": seconds, "commitment": sealed.commitment}
        | _answer_record(found)
        | _truth_of(box, sealed.label, found)
    )


def _truth_of(box: Box, label: Label, found: CommandedDiagnosis) -> Record:
    """The truth with the size δ of what is hidden."""
    if label.category in (KINETIC, UNLISTED_CATEGORY) or not isinstance(box.hysteresis, RelayHysteresis):
        return _truth(label, label.effects) | {"delta": {label.category: _delta_of_base(label, found)}}
    return _truth_with_delta(label, box.hysteresis, found)


def _delta_of_base(label: Label, found: CommandedDiagnosis) -> float:
    """δ where no effect of the catalogue is the truth: what the base model misses beyond the noise, over the noise."""
    noise = label.noise_counts * label.per_count
    return sqrt(max(found.error.base**2 - noise**2, 0.0)) / noise


def _answer(sealed: SealedBox, without: tuple[str, ...], number: int) -> CommandedDiagnosis:
    """The diagnosis from the files alone. The effect to leave out is left out of the catalogue."""
    train = [load_run(path) for path in sealed.train]
    held_out = [load_run(path) for path in sealed.held_out]
    model = identify(train, SURFACE).model
    return diagnose_commanded(model, train, held_out, seed=number, without=without)


def _answer_record(found: CommandedDiagnosis) -> Record:
    """The answer as plain values; ``explanations`` are the effects with their probabilities, likeliest first."""
    keys = ("verdict", "effects", "set", "depends_on", "reason", "not_identifiable", "held_out", "learned")
    whole = found.to_json()
    return {key: whole[key] for key in (*keys, "adequacy", "noise")} | {
        "explanations": [[[p.name], w] for p, w in found.causes.items() if p.kind == "effect"],
        "variables": [[p.name, w] for p, w in found.causes.items() if p.kind == "variable"],
        "nothing": found.probabilities.nothing,
        "intervals90": found.intervals90,
    }


def _truth(label: Label, effects: Mapping[str, Mapping[str, float]]) -> Record:
    return {
        "category": label.category,
        "hidden": effects,
        "left_out": label.left_out,
        "arrangement": label.arrangement,
        "channels": list(label.channels),
        "noise_counts": label.noise_counts,
    }


def _truth_with_delta(label: Label, relays: RelayHysteresis, found: CommandedDiagnosis) -> Record:
    """The truth, and δ of each hidden effect: √(2/N) of the nats by which the truth exceeds the truth
    without it.

    Densities are identified again for both, so the part that a density can represent does not count.
    """
    timeline = found.timeline
    plant_model = replace(found.subject.base.plant_model, effects=())
    model_hysteresis = plant_model.hysteresis
    effects = rescaled_to_range(
        label.effects, (relays.lower, relays.upper), (model_hysteresis.lower, model_hysteresis.upper)
    )
    hidden = effects_from_json([{"name": name, "parameters": values} for name, values in effects.items()])

    def evidence_of(effects: tuple[SupportsHooks, ...]) -> float:
        identified = found.subject.base.plant_model.hysteresis
        warm_start = found.subject.base.refitted
        return joint_density_from_best_start(
            timeline, replace(plant_model, effects=effects), identified, warm_start
        ).refitted.log_evidence

    whole = evidence_of(hidden) if hidden else 0.0
    n = sum(len(r) for r in timeline.all_readings)
    deltas = {
        name: float(np.sqrt(2 * max(whole - evidence_of(tuple(e for e in hidden if e is not one)), 0.0) / n))
        for name, one in zip(effects, hidden)
    }
    return _truth(label, effects) | {"delta": deltas}


def rescaled_to_range(
    effects: Mapping[str, Mapping[str, float]], own: InputRange, model_range: InputRange
) -> dict[str, dict[str, float]]:
    """Effects of relays on a range ``own`` (K), in the parameters of a model with the range ``model_range``
    (K).

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
