"""The effects of the catalogue that a wire may have, without those to leave out."""

from collections.abc import Sequence

from smarig.diagnosis.run_checks import check_left_out
from smarig.plant import EffectType, PassThroughActuator, effect_types, effect_types_only_on
from smarig.replay import PlantModel


def effects_to_try(plant_model: PlantModel, without: Sequence[str] = ()) -> list[EffectType]:
    """The effects of one-wire or two-wire actuators, and those of a wire whose input is given. Raises UsageError for
    an unknown name.
    """
    check_left_out(without, [k.name for k in effect_types()])
    kinds = [*effect_types("two_wire" if plant_model.actuator.two_wire else "one_wire")]
    if isinstance(plant_model.actuator, PassThroughActuator):
        kinds += effect_types_only_on("untrained")
    return [k for k in kinds if k.name not in without]
