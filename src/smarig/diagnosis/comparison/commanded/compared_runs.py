"""The runs of a comparison: their timeline, the plant model, and the effects that the runs could show."""

from collections.abc import Sequence

from smarig.core import UsageError
from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem
from smarig.diagnosis.effects_to_try import effects_to_try
from smarig.diagnosis.run_checks import check_comparable, check_held_out
from smarig.record import Run
from smarig.replay import (
    Model,
    actuator_for_run,
    build_timeline,
    driven_by_input,
    plant_model_of,
)


def subject_of(
    model: Model, train: Sequence[Run], held_out: Sequence[Run], without: Sequence[str] = ()
) -> CommandedProblem:
    """The subject of a comparison on training runs. Raises UsageError or DataError if it cannot be compared."""
    check_held_out(train, held_out)
    check_comparable(model, [*train, *held_out])
    if driven_by_input(list(train)):
        raise UsageError("These runs have only a measured input, and no commanded current.")
    tau_s = actuator_for_run(model, train[0]).tau_s
    if held_out:
        build_timeline([*train, *held_out], tau_s)
    timeline = build_timeline(list(train), tau_s)
    given = plant_model_of(model, timeline.runs[0])
    possible = effects_to_try(given, timeline.runs[0], without)
    visible = [k for k in possible if timeline.drive.can_show(k, given.hysteresis)]
    present = {e.kind.name for e in given.catalogue_effects}
    return CommandedProblem.of(timeline, given, [k for k in visible if k.name not in present])
