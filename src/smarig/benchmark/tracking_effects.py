"""Tracking with an effect hidden in the wire: what it costs each controller, and what a diagnosis is worth in the loop.

A twin of the nominal surface with one effect more is characterised (wiping-out, congruency, FOD, validation); a
positive measure is identified, and diagnosed. The feed-forward then drives the same wire by that model as identified,
and as the diagnosis extended it; beside them by the nominal surface with the effect as planted, which no lab knows.
"""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from smarig.benchmark.tracking import RIG, closed, known, references
from smarig.catalogue import names
from smarig.control.settings import TRACKING
from smarig.control.tracking.known import Known
from smarig.control.tracking.tuning import defaults
from smarig.diagnosis.diagnose import diagnose
from smarig.identification.identify import identify
from smarig.identification.model_file import Model
from smarig.model.effect import Planted
from smarig.model.planted import from_json, from_pairs
from smarig.record import load_run
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session

EFFECTS = ("latent_heat", "ambient_drift", "stress_coupling", "backlash")
TRAIN, HELD_OUT = ("wiping_out", "congruency", "first_order_descending"), "validation"
NULLS, QUICK_NULLS = 100, 40


def run(quick: bool = False) -> dict[str, Any]:
    """``{"rms": {effect: {controller: counts, "verdict", "inverse, identified", "inverse, diagnosed", …}}}``."""
    seeds = range(1, 3) if quick else range(1, 9)
    nominal = known()
    found: dict[str, Any] = {"none": _row(nominal, (), seeds)}
    for effect in EFFECTS[1:2] if quick else EFFECTS:
        planted = from_pairs([effect])
        row = _row(nominal, planted, seeds)
        row["inverse, effect known"] = _rms("inverse", nominal.extended(planted), nominal, planted, seeds)
        found[effect] = row | _diagnosed(nominal, planted, seeds, QUICK_NULLS if quick else NULLS)
    return {"rig": RIG, "unit": "counts", "seeds": list(seeds), "rms": found}


def _row(nominal: Known, planted: Sequence[Planted], seeds: Sequence[int]) -> dict[str, Any]:
    return {name: _rms(name, nominal, nominal, planted, seeds) for name in names(TRACKING)}


def _rms(
    name: str, believed: Known, nominal: Known, planted: Sequence[Planted], seeds: Sequence[int]
) -> float | None:
    """Mean rms error of the wire's own position, counts; None when a loop tripped."""
    count = nominal.setup.actuator.position_per_count(nominal.counts_per_rev)
    loops = [
        closed(believed, name, defaults(name), nominal.hysteresis, follow, seed, planted)
        for seed in seeds
        for follow in references(seed)
    ]
    tripped = any(loop.fault for loop in loops)
    return None if tripped else float(np.mean([loop.true.rms for loop in loops]) / count)


def _diagnosed(
    nominal: Known, planted: Sequence[Planted], seeds: Sequence[int], nulls: int
) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        with Session(RIG, twin=TwinSettings(seed=11, effects=planted), wire="tracking-benchmark") as session:
            paths = {
                name: session.run(name, {}, Path(folder) / f"{name}.run.sqlite")
                for name in (*TRAIN, HELD_OUT)
            }
        runs = {name: load_run(path) for name, path in paths.items()}
        train = [runs[name] for name in TRAIN]
        model = identify(train, "positive").model
        found = diagnose(model, train, [runs[HELD_OUT]], nulls=nulls)
    return {
        "verdict": found.verdict.word,
        "names": list(found.verdict.names),
        "inverse, identified": _rms("inverse", believing(nominal, model), nominal, planted, seeds),
        "inverse, diagnosed": _rms("inverse", believing(nominal, found.model), nominal, planted, seeds),
    }


def believing(nominal: Known, model: Model) -> Known:
    """A controller's knowledge by a model file: its hysteresis and its effects."""
    return Known(nominal.setup, model.hysteresis, nominal.counts_per_rev, from_json(model.effects))
