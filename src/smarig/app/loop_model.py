"""A model from a file, checked for use in a closed loop on a rig."""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.config import RigFile
from smarig.control import ControllerModel, LoopTiming
from smarig.core import SmarigError, UsageError, file_bytes
from smarig.identification import Identification
from smarig.plant import Actuator, effects_from_json
from smarig.protocols import Setup
from smarig.replay import Model, load_model
from smarig.runner import Preview, ProtocolFactory, preview

AnyModel = Model | Identification | str | Path
LEAST_COUNTS = 10  # of the encoder, the least motion of the model that a loop can hold


def model_of(model: AnyModel) -> Model:
    """A model, that of an identification, or that of a file."""
    if isinstance(model, Identification):
        return model.model
    return model if isinstance(model, Model) else load_model(model)


@dataclass(frozen=True)
class ModelSource:
    """A model with the name and the hash of its file, as they are recorded; without a file, of what it would have."""

    model: Model
    name: str
    sha256: str

    @classmethod
    def of(cls, model: AnyModel) -> "ModelSource":
        """The model, read if it is the path of a file. Raises the errors of ``load_model``."""
        if not isinstance(model, Model | Identification):
            check_path("The model", model)
        known = model_of(model)
        known.check_classical("A loop or its certificate")
        if isinstance(model, str | Path):
            return cls(known, Path(model).name, hashlib.sha256(file_bytes(Path(model))).hexdigest())
        return cls(known, known.name, hashlib.sha256(known.file_text.encode()).hexdigest())

    def settings(self) -> dict[str, str]:
        """The settings that are recorded."""
        return {"model": self.name, "model_sha256": self.sha256}


@dataclass(frozen=True)
class ClosedLoop:
    """A closed loop ready to run: the name of its protocol, its factory, and its settings for the record.

    ``statement``: what is proved about the loop, in a sentence; "" if nothing is stated. ``make_for_preview``: the
    factory for a preview on a twin, if it must be another one: the resistance of a twin is not that of the wire.
    """

    protocol: str
    make: ProtocolFactory
    settings: dict[str, Any]
    statement: str = ""
    make_for_preview: ProtocolFactory | None = None

    def preview(self, rig: RigFile, report: Callable[[float], None] | None = None) -> Preview:
        """Duration and range on the rig's twin; ``report`` as in ``runner.preview``."""
        factory = self.make_for_preview or self.make
        return preview(self.protocol, rig, protocol_factory=factory, report=report)


def controller_model_for(model: Model, rig: RigFile) -> ControllerModel:
    """The model that a controller is given. Raises UsageError if the model does not suit the rig."""
    actuator = Actuator.named(rig.actuator)
    arrangement = actuator.file.arrangement
    if model.arrangement != arrangement:
        raise UsageError(
            f"Model {model.name} is of a {_arrangement_text(model.arrangement)} rig, but '{rig.name}' is a "
            f"{_arrangement_text(arrangement)} one."
        )
    if model.unit != actuator.unit:
        raise UsageError(
            f"Model {model.name} is in {model.unit}, but rig '{rig.name}' measures in {actuator.unit}."
        )
    if model.input.unit != "K":
        raise UsageError(
            f"The input of model {model.name} is in {model.input.unit or 'no unit'}, but the input of a rig is in K "
            "above ambient."
        )
    setup = Setup(actuator, rig.limits, rig.period_s)
    controller_model = ControllerModel(
        setup, model.hysteresis, actuator.resolution(rig.encoder), effects_from_json(model.effects)
    )
    _check_motion(controller_model, model)
    return controller_model


def timing_of(model: Model) -> LoopTiming | None:
    """The timing of a loop on the rig of a model, with a tick of dead time; None if its files are not at hand, or of
    another wire."""
    try:
        setup = Setup.of(model.rig)
    except SmarigError:
        return None
    if setup.actuator.name != model.actuator.name or model.input.unit != "K":
        return None
    return LoopTiming(setup.period_s, setup.tau_s, setup.period_s)


def _check_motion(controller_model: ControllerModel, model: Model) -> None:
    """Raise UsageError unless the output rises with the input by more than noise, as these loops require."""
    low, high = controller_model.reach
    setup = controller_model.setup
    limits = f"within this rig's limits, {setup.lower_K:.4g} to {setup.upper_K:.4g} K"
    least = LEAST_COUNTS * controller_model.position_per_count
    if low == high:
        raise UsageError(
            f"The output of model {model.name} does not move {limits}, so no loop can be closed with it."
        )
    if abs(high - low) < least:
        raise UsageError(
            f"Model {model.name} moves by only {abs(high - low):.3g} {model.unit} {limits}. A loop needs "
            f"{LEAST_COUNTS} counts of the encoder ({least:.3g} {model.unit})."
        )
    if high < low:
        raise UsageError(
            f"The output of model {model.name} falls as its input rises, by {low - high:.4g} {model.unit} {limits}. "
            "These loops need an output that rises with the input."
        )


def check_arguments(controller: Any, numbers: Any) -> None:
    """Raise UsageError if the controller is not a name or its parameters are not a mapping."""
    if not isinstance(controller, str | Path):
        raise UsageError(f"The controller must be a name, not {controller!r}.")
    if not isinstance(numbers, Mapping | None):
        raise UsageError(
            f"The controller's parameters must be a mapping, such as {{'gain': 2}}, not {numbers!r}."
        )


def check_path(what: str, source: Any) -> None:
    if not isinstance(source, str | Path):
        raise UsageError(f"{what} must be a name or a path, not {source!r}.")


def _arrangement_text(arrangement: str) -> str:
    return arrangement.replace("_", "-") or "nameless"
