"""The effects of the catalogue that a wire and its sensor may have, without those to leave out."""

from collections.abc import Mapping, Sequence

from smarig.diagnosis.run_checks import check_left_out
from smarig.plant import EffectType, PassThroughActuator, effect_types, effect_types_only_on
from smarig.record import Run
from smarig.replay import PlantModel


def effects_to_try(plant_model: PlantModel, run: Run, without: Sequence[str] = ()) -> list[EffectType]:
    """The effects of one-wire or two-wire actuators, and those of a wire whose input is given; of a run without an
    encoder wheel, none that needs one. Raises UsageError for an unknown name.
    """
    check_left_out(without, [k.name for k in effect_types()])
    kinds = [*effect_types("two_wire" if plant_model.actuator.two_wire else "one_wire")]
    if isinstance(plant_model.actuator, PassThroughActuator):
        kinds += effect_types_only_on("untrained")
    wheel = not _reads_a_length(run)
    return [k for k in kinds if k.name not in without and (wheel or not k.needs_wheel)]


def _reads_a_length(run: Run) -> bool:
    """Whether the rig file gives the sensor a resolution in millimetres: it turns with no pulley."""
    encoder = run.info.rig_values.get("encoder")
    return run.unit == "mm" and isinstance(encoder, Mapping) and bool(encoder.get("resolution"))
