"""The runs of a comparison: their timeline, the plant model, and the effects that the runs could show."""

from collections.abc import Sequence

import numpy as np

from smarig.core import UsageError
from smarig.diagnosis.comparison.commanded.subject import CommandedProblem
from smarig.diagnosis.run_checks import check_comparable
from smarig.plant import EffectType, PassThroughActuator, effect_types, effect_types_only_on
from smarig.record import Run
from smarig.replay import (
    Model,
    PlantModel,
    actuator_for_run,
    build_timeline,
    driven_by_input,
    file_hash,
    plant_model_of,
)


def subject_of(
    model: Model, train: Sequence[Run], held_out: Sequence[Run], without: Sequence[str] = ()
) -> CommandedProblem:
    """The subject of a comparison on training runs. Raises UsageError or DataError if it cannot be compared."""
    if not train:
        raise UsageError("A diagnosis needs at least one training run.")
    check_comparable(model, [*train, *held_out])
    if driven_by_input(list(train)):
        raise UsageError("These runs have only a measured input, and no commanded current.")
    if any(_same(a, b) for a in train for b in held_out):
        raise UsageError(
            "A held-out run is a copy of a training run. Hold out a run that is not used for training."
        )
    tau_s = actuator_for_run(model, train[0]).tau_s
    if held_out:
        build_timeline([*train, *held_out], tau_s)
    timeline = build_timeline(list(train), tau_s)
    given = plant_model_of(model, timeline.runs[0])
    visible = [k for k in _catalogue(given, without) if timeline.drive.can_show(k, given.hysteresis)]
    present = {e.kind.name for e in given.catalogue_effects}
    return CommandedProblem.of(timeline, given, [k for k in visible if k.name not in present])


def _same(a: Run, b: Run) -> bool:
    return file_hash(a) == file_hash(b) != "" and np.array_equal(a["tick"], b["tick"])


def _catalogue(plant_model: PlantModel, without: Sequence[str]) -> list[EffectType]:
    kinds = [*effect_types("two_wire" if plant_model.actuator.two_wire else "one_wire")]
    if isinstance(plant_model.actuator, PassThroughActuator):
        kinds += effect_types_only_on("untrained")
    known = [k.name for k in effect_types()]
    for name in without:
        if name not in known:
            raise UsageError(f"Effect '{name}' cannot be left out: the catalogue has no such effect.")
    return [k for k in kinds if k.name not in without]
