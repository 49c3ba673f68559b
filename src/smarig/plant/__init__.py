"""Physics of the wire: heating, plant, effects and stress."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.plant.actuator import Actuator as Actuator
    from smarig.plant.antagonist_stress import AntagonistStress as AntagonistStress
    from smarig.plant.antagonist_stress import stress_of_phases_MPa as stress_of_phases_MPa
    from smarig.plant.effect import Effect as Effect
    from smarig.plant.effect import EffectContext as EffectContext
    from smarig.plant.effect import EffectType as EffectType
    from smarig.plant.effect import Hook as Hook
    from smarig.plant.effect import Parameter as Parameter
    from smarig.plant.effect import PlantState as PlantState
    from smarig.plant.effect import Stage as Stage
    from smarig.plant.effect import SupportsHooks as SupportsHooks
    from smarig.plant.effect import ThermalState as ThermalState
    from smarig.plant.effect import Values as Values
    from smarig.plant.effect import hook_chains as hook_chains
    from smarig.plant.effect_catalogue import EFFECTS as EFFECTS
    from smarig.plant.effect_catalogue import effect_types as effect_types
    from smarig.plant.effect_catalogue import effect_types_only_on as effect_types_only_on
    from smarig.plant.effect_catalogue import effects_from_arguments as effects_from_arguments
    from smarig.plant.effect_catalogue import effects_from_json as effects_from_json
    from smarig.plant.effect_catalogue import effects_from_pairs as effects_from_pairs
    from smarig.plant.effect_catalogue import effects_to_arguments as effects_to_arguments
    from smarig.plant.effect_catalogue import effects_to_pairs as effects_to_pairs
    from smarig.plant.effect_catalogue import mystery_effects as mystery_effects
    from smarig.plant.heating import JouleHeating as JouleHeating
    from smarig.plant.heating import temperature_along as temperature_along
    from smarig.plant.largest_voltage import largest_voltage_V as largest_voltage_V
    from smarig.plant.learned_effect import LEARNED as LEARNED
    from smarig.plant.learned_effect import LEARNED_FROM as LEARNED_FROM
    from smarig.plant.learned_effect import MEAN_LEVELS as MEAN_LEVELS
    from smarig.plant.learned_effect import MEAN_POWERS as MEAN_POWERS
    from smarig.plant.learned_effect import LearnedShape as LearnedShape
    from smarig.plant.learned_effect import can_be_learned as can_be_learned
    from smarig.plant.learned_effect import learned_effect_type as learned_effect_type
    from smarig.plant.load import BREAKING_STRESS_MPA as BREAKING_STRESS_MPA
    from smarig.plant.load import Load as Load
    from smarig.plant.load import load_of as load_of
    from smarig.plant.measured_input import PassThroughActuator as PassThroughActuator
    from smarig.plant.measured_input import is_testable as is_testable
    from smarig.plant.parameter_words import constant_words as constant_words
    from smarig.plant.parameter_words import parameter_words as parameter_words
    from smarig.plant.plant import Plant as Plant
    from smarig.plant.plant import step_with_feedback as step_with_feedback
    from smarig.plant.power_temperature import PowerTemperature as PowerTemperature
    from smarig.plant.stress import differential_stress as differential_stress
    from smarig.plant.thermal_stages import EARLY_STAGES as EARLY_STAGES
    from smarig.plant.thermal_stages import ThermalStages as ThermalStages
    from smarig.plant.thermal_stages import apply_hooks as apply_hooks
    from smarig.plant.thermomechanical.characteristics import antagonist_path as antagonist_path
    from smarig.plant.thermomechanical.characteristics import isobaric_loop as isobaric_loop
    from smarig.plant.thermomechanical.characteristics import isothermal_loop as isothermal_loop
    from smarig.plant.thermomechanical.free_convection import (
        free_convection_W_per_m2_K as free_convection_W_per_m2_K,
    )
    from smarig.plant.thermomechanical.kinetics import AUSTENITE as AUSTENITE
    from smarig.plant.thermomechanical.kinetics import TWINNED_MARTENSITE as TWINNED_MARTENSITE
    from smarig.plant.thermomechanical.kinetics import Phase as Phase
    from smarig.plant.thermomechanical.material import Material as Material
    from smarig.plant.thermomechanical.shaft import load_MPa_of as load_MPa_of
    from smarig.plant.thermomechanical.shaft import shaft_strain as shaft_strain
    from smarig.plant.thermomechanical.thermomechanical_plant import (
        ThermomechanicalPlant as ThermomechanicalPlant,
    )
    from smarig.plant.thermomechanical.thermomechanical_plant import (
        thermomechanical_travel as thermomechanical_travel,
    )
    from smarig.plant.wire_phases import WirePhases as WirePhases
    from smarig.plant.wire_phases import austenite_along as austenite_along
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
