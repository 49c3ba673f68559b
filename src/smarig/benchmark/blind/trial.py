"""One sealed box: drawn, written, diagnosed from its files alone; then its label is opened beside the answer.

A box is the same whoever opens it and in whatever order, and so is its answer.
"""

import os
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from smarig.benchmark.boxes import Label, Sealed, draw, generate
from smarig.diagnosis.diagnose import Diagnosis, diagnose
from smarig.errors import SmarigError
from smarig.identification.identify import identify
from smarig.model.planted import from_json
from smarig.record import load_run
from smarig.story.retelling import retold

Record = dict[str, Any]
SURFACE = "positive"


def trial(seed: int, number: int, nulls: int = 400) -> Record:
    """A box's answer and its truth, as plain values."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    started = time.process_time()
    box = draw(seed, number)
    with tempfile.TemporaryDirectory() as folder:
        sealed = generate(box, Path(folder))
        without = (box.left_out,) if box.left_out else ()
        try:
            found = _answer(sealed, without, nulls, number)
        except SmarigError as error:
            return {"number": number, "error": str(error)} | _truth(sealed.label)
    seconds = time.process_time() - started
    return (
        {"number": number, "seconds": seconds, "commitment": sealed.commitment}
        | _said(found)
        | _opened(sealed.label, found)
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


def _truth(label: Label) -> Record:
    return {
        "category": label.category,
        "hidden": label.effects,
        "left_out": label.left_out,
        "arrangement": label.arrangement,
        "channels": list(label.channels),
        "noise_counts": label.noise_counts,
    }


def _opened(label: Label, found: Diagnosis) -> Record:
    """The truth, and δ of each hidden effect: what no density explains of it, in noises, rms over all readings."""
    critique = found.levels[-1].critique if found.levels else found.first
    story, subject = found.story, found.first.subject
    bare = replace(subject, effects=())
    plain = retold(story, bare).stacked(story)
    deltas = {}
    for name, values in label.effects.items():
        effect = from_json([{"name": name, "parameters": values}])
        trace = critique.refitted.whitened(retold(story, bare, effect).stacked(story) - plain)
        deltas[name] = float(np.sqrt(np.mean(trace**2)))
    return _truth(label) | {"delta": deltas}
