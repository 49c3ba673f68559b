"""One sealed box: drawn, written, diagnosed from its files alone; then its label is opened beside the answer.

A box is the same whoever opens it and in whatever order, and so is its answer.
"""

import tempfile
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from smarig.benchmark.blind.ranges import in_range
from smarig.benchmark.boxes import Label, Sealed, draw, generate
from smarig.benchmark.boxes.relays import Hysteresis
from smarig.diagnosis.density_beside import density_anew
from smarig.diagnosis.diagnose import Diagnosis, diagnose
from smarig.errors import SmarigError
from smarig.identification.identify import identify
from smarig.model.effect import Effect
from smarig.model.planted import from_json
from smarig.record import load_run

Record = dict[str, Any]
SURFACE = "positive"


@threadpool_limits.wrap(limits=1, user_api="blas")
def trial(seed: int, number: int, nulls: int = 400) -> Record:
    """A box's answer and its truth, as plain values."""
    started = time.process_time()
    box = draw(seed, number)
    with tempfile.TemporaryDirectory() as folder:
        sealed = generate(box, Path(folder))
        without = (box.left_out,) if box.left_out else ()
        try:
            found = _answer(sealed, without, nulls, number)
        except SmarigError as error:
            return {"number": number, "error": str(error)} | _truth(sealed.label, sealed.label.effects)
    seconds = time.process_time() - started
    return (
        {"number": number, "seconds": seconds, "commitment": sealed.commitment}
        | _said(found)
        | _opened(sealed.label, box.hysteresis, found)
    )


def _answer(sealed: Sealed, without: tuple[str, ...], nulls: int, number: int) -> Diagnosis:
    """From the files alone; what is left out is left out of the catalogue."""
    train = [load_run(path) for path in sealed.train]
    held_out = [load_run(path) for path in sealed.held_out]
    model = identify(train, SURFACE).model
    return diagnose(model, train, held_out, nulls=nulls, seed=number, without=without)


def _said(found: Diagnosis) -> Record:
    keys = ("verdict", "effects", "set", "depends_on", "not_identifiable", "held_out", "p_value")
    whole = found.to_json()
    return {key: whole[key] for key in keys} | {
        "explanations": [[list(names), p] for names, p in found.verdict.explanations],
        "standard": found.first.largest.standard,
        "threshold": found.first.threshold,
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


def _opened(label: Label, relays: Hysteresis, found: Diagnosis) -> Record:
    """The truth, and δ of each hidden effect: √(2/N) of the nats by which the truth beats the truth without it.

    Densities are identified anew beside either, so what a density takes up counts for nothing.
    """
    story = found.story
    subject = replace(found.first.subject, effects=())
    seen = subject.hysteresis
    effects = in_range(label.effects, (relays.lower, relays.upper), (seen.lower, seen.upper))
    hidden = from_json([{"name": name, "parameters": values} for name, values in effects.items()])

    def worth(effects: tuple[Effect, ...]) -> float:
        given = found.first.subject.hysteresis
        like = found.first.refitted
        return density_anew(story, replace(subject, effects=effects), given, like)[1].log_evidence

    whole = worth(hidden) if hidden else 0.0
    n = sum(len(r) for r in story.kinds)
    deltas = {
        name: float(np.sqrt(2 * max(whole - worth(tuple(e for e in hidden if e is not one)), 0.0) / n))
        for name, one in zip(effects, hidden)
    }
    return _truth(label, effects) | {"delta": deltas}
