"""Tracking with an effect in the wire: its cost for each controller, and the gain of a diagnosis in the
loop.

A twin of the nominal surface with one more effect is characterised (wiping-out, congruency, FOD,
validation). A positive measure is identified and diagnosed. The feed-forward then drives the same wire with
the identified model and with the model that the diagnosis extended. For comparison it also uses the nominal
surface with the injected effect, which no lab knows.
"""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.tracking import RIG, controller_model, references, simulate_loop
from smarig.control import TRACKING_CONTROLLERS, ControllerModel, default_settings
from smarig.core import catalogue_names
from smarig.diagnosis import diagnose_commanded
from smarig.identification import identify
from smarig.plant import Effect, effects_from_json, effects_from_pairs
from smarig.record import load_run
from smarig.replay import Model
from smarig.rig import TwinSettings
from smarig.runner import Session

EFFECTS = ("latent_heat", "ambient_drift", "stress_coupling", "backlash")
TRAIN, HELD_OUT = ("wiping_out", "congruency", "first_order_descending"), "validation"


def run(quick: bool = False) -> dict[str, Any]:
    """Track with each effect.

    Returns ``{"rms": {effect: {controller: counts, "verdict", "inverse, identified", "inverse, diagnosed",
    …}}}``.
    """
    seeds = range(1, 3) if quick else range(1, 9)
    nominal = controller_model()
    found: dict[str, Any] = {"none": _row(nominal, (), seeds)}
    for effect in EFFECTS[1:2] if quick else EFFECTS:
        injected = effects_from_pairs([effect])
        row = _row(nominal, injected, seeds)
        row["inverse, effect nominal_model"] = _rms(
            "inverse", nominal.with_effects(injected), nominal, injected, seeds
        )
        found[effect] = row | _diagnosed(nominal, injected, seeds)
    return {"rig": RIG, "unit": "counts", "seeds": list(seeds), "rms": found}


def _row(nominal: ControllerModel, injected: Sequence[Effect], seeds: Sequence[int]) -> dict[str, Any]:
    return {
        name: _rms(name, nominal, nominal, injected, seeds) for name in catalogue_names(TRACKING_CONTROLLERS)
    }


def _rms(
    name: str,
    assumed_model: ControllerModel,
    nominal: ControllerModel,
    injected: Sequence[Effect],
    seeds: Sequence[int],
) -> float | None:
    """Mean rms error of the wire's true position in counts; None if a loop tripped."""
    count = nominal.position_per_count
    loops = [
        simulate_loop(
            assumed_model=assumed_model,
            name=name,
            numbers=default_settings(name),
            wire=nominal.hysteresis,
            target=target,
            seed=seed,
            effects=injected,
        )
        for seed in seeds
        for target in references(seed)
    ]
    tripped = any(loop.fault for loop in loops)
    return None if tripped else float(np.mean([loop.true.rms for loop in loops]) / count)


def _diagnosed(nominal: ControllerModel, injected: Sequence[Effect], seeds: Sequence[int]) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        with Session(RIG, twin=TwinSettings(seed=11, effects=injected), wire="tracking-benchmark") as session:
            paths = {
                name: session.run(name, {}, Path(folder) / f"{name}.run.sqlite")
                for name in (*TRAIN, HELD_OUT)
            }
        runs = {name: load_run(path) for name, path in paths.items()}
        train = [runs[name] for name in TRAIN]
        model = identify(train, "positive").model
        found = diagnose_commanded(model, train, [runs[HELD_OUT]])
    return {
        "verdict": found.verdict.word,
        "names": list(found.verdict.names),
        "inverse, identified": _rms("inverse", identified_model(nominal, model), nominal, injected, seeds),
        "inverse, diagnosed": _rms(
            "inverse", identified_model(nominal, found.model), nominal, injected, seeds
        ),
    }


def identified_model(nominal: ControllerModel, model: Model) -> ControllerModel:
    """The controller model with the hysteresis and the effects of a model file."""
    return ControllerModel(
        nominal.setup, model.hysteresis, nominal.position_per_count, effects_from_json(model.effects)
    )
