"""A model from a file for a closed loop on a rig: what fits, what moves, and what is refused with a sentence."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.config import RigFile
from smarig.control import ControllerModel
from smarig.core import UsageError
from smarig.plant import Actuator, effects_from_json
from smarig.protocols import Setup
from smarig.replay import Model, load_model
from smarig.runner import ProtocolFactory

LEAST_COUNTS = 10  # of the encoder that a model must move: less is no motion that a loop could hold


@dataclass(frozen=True)
class ModelSource:
    """A model with the file it came from, and that file's hash: what a record says of it."""

    model: Model
    name: str
    sha256: str

    @classmethod
    def of(cls, path: str | Path) -> "ModelSource":
        """Read and hash a model file; errors of ``load_model``."""
        check_path("The model", path)
        model = load_model(path)
        model.check_classical("A loop or its certificate")
        return cls(model, Path(path).name, hashlib.sha256(Path(path).read_bytes()).hexdigest())

    def settings(self) -> dict[str, str]:
        """For a record."""
        return {"model": self.name, "model_sha256": self.sha256}


@dataclass(frozen=True)
class ClosedLoop:
    """A closed loop ready to be run: its protocol's name, what makes it, and its settings for the record."""

    protocol: str
    make: ProtocolFactory
    settings: dict[str, Any]


def controller_model_for(model: Model, rig: RigFile) -> ControllerModel:
    """What a controller will believe; UsageError where the model is not one of such a rig."""
    actuator = Actuator.named(rig.actuator)
    arrangement = actuator.file.arrangement
    if model.arrangement != arrangement:
        raise UsageError(
            f"Model {model.name} is of a {_arrangement_text(model.arrangement)} rig, '{rig.name}' is a "
            f"{_arrangement_text(arrangement)} one."
        )
    if model.unit != actuator.unit:
        raise UsageError(
            f"Model {model.name} speaks in {model.unit}, rig '{rig.name}' measures in {actuator.unit}."
        )
    if model.input.unit != "K":
        raise UsageError(
            f"Model {model.name} has an input in {model.input.unit or 'no unit'}; a rig is driven by kelvin above "
            "ambient."
        )
    setup = Setup(actuator, rig.limits, rig.period_s)
    controller_model = ControllerModel(
        setup, model.hysteresis, rig.encoder.counts_per_rev, effects_from_json(model.effects)
    )
    _check_motion(controller_model, model)
    return controller_model


def _check_motion(controller_model: ControllerModel, model: Model) -> None:
    """UsageError where the output does not rise with the input by more than noise: these loops heat to raise it."""
    low, high = controller_model.reach
    setup = controller_model.setup
    limits = f"within this rig's limits, {setup.lower_K:.4g} to {setup.upper_K:.4g} K"
    least = LEAST_COUNTS * setup.actuator.position_per_count(controller_model.counts_per_rev)
    if low == high:
        raise UsageError(
            f"The output of model {model.name} does not move {limits}: no loop can be closed by it."
        )
    if abs(high - low) < least:
        raise UsageError(
            f"Model {model.name} moves by {abs(high - low):.3g} {model.unit} only {limits}: less than {LEAST_COUNTS} "
            f"counts of the encoder ({least:.3g} {model.unit}), which no loop can hold."
        )
    if high < low:
        raise UsageError(
            f"The output of model {model.name} falls as its input rises, by {low - high:.4g} {model.unit} {limits}: "
            "these loops hold an output that rises with the input."
        )


def check_arguments(controller: Any, numbers: Any) -> None:
    """UsageError for a notebook's slip: what is no name, and what is no mapping."""
    if not isinstance(controller, str | Path):
        raise UsageError(f"A controller is given by its name, not by {controller!r}.")
    if not isinstance(numbers, Mapping | None):
        raise UsageError(
            f"A controller's numbers are given by name, such as {{'gain': 2}}, not by {numbers!r}."
        )


def check_path(what: str, source: Any) -> None:
    if not isinstance(source, str | Path):
        raise UsageError(f"{what} is given by a name or a path, not by {source!r}.")


def _arrangement_text(arrangement: str) -> str:
    return arrangement.replace("_", "-") or "nameless"
