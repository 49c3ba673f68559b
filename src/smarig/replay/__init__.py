"""Models along records: the timeline of runs, predictions along it, the memory, and the model file."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.replay.conditions import condition_text as condition_text
    from smarig.replay.conditions import foreign_conditions as foreign_conditions
    from smarig.replay.conditions import pooled_conditions as pooled_conditions
    from smarig.replay.conditions import recorded_conditions as recorded_conditions
    from smarig.replay.conditions import same_condition as same_condition
    from smarig.replay.electrical_energy import ElectricalEnergy as ElectricalEnergy
    from smarig.replay.electrical_energy import electrical_energy as electrical_energy
    from smarig.replay.extended_model import extended_operator as extended_operator
    from smarig.replay.heated_input import with_heating_of as with_heating_of
    from smarig.replay.measured_input import driven_by_input as driven_by_input
    from smarig.replay.measured_prediction import applied_inputs as applied_inputs
    from smarig.replay.memory_history import MemoryHistory as MemoryHistory
    from smarig.replay.memory_history import memory_histories as memory_histories
    from smarig.replay.memory_history import memory_states as memory_states
    from smarig.replay.memory_history import recorded_start as recorded_start
    from smarig.replay.model_file import ActuatorRecord as ActuatorRecord
    from smarig.replay.model_file import Model as Model
    from smarig.replay.model_file import NoiseRecord as NoiseRecord
    from smarig.replay.model_file import SignalDescription as SignalDescription
    from smarig.replay.model_file import load_model as load_model
    from smarig.replay.plant_model import PlantModel as PlantModel
    from smarig.replay.plant_model import actuator_for_run as actuator_for_run
    from smarig.replay.plant_model import actuator_of as actuator_of
    from smarig.replay.plant_model import plant_model_of as plant_model_of
    from smarig.replay.prediction import OUTPUT_DEPENDENT_KINDS as OUTPUT_DEPENDENT_KINDS
    from smarig.replay.prediction import Prediction as Prediction
    from smarig.replay.prediction import numerics as numerics
    from smarig.replay.prediction import predict as predict
    from smarig.replay.prediction import with_hysteresis as with_hysteresis
    from smarig.replay.provenance import file_hash as file_hash
    from smarig.replay.provenance import missing_earlier_runs as missing_earlier_runs
    from smarig.replay.provenance import model_metadata as model_metadata
    from smarig.replay.provenance import provenance as provenance
    from smarig.replay.provenance import share_zero as share_zero
    from smarig.replay.recorded_actuator import recorded_actuator as recorded_actuator
    from smarig.replay.rig_record import load_of_run as load_of_run
    from smarig.replay.rig_record import load_records as load_records
    from smarig.replay.rig_record import stress_at_points as stress_at_points
    from smarig.replay.rig_record import stress_of_samples as stress_of_samples
    from smarig.replay.sample_predictors import HysteresisPredictor as HysteresisPredictor
    from smarig.replay.sample_predictors import NamedPredictor as NamedPredictor
    from smarig.replay.sample_predictors import PlantPredictor as PlantPredictor
    from smarig.replay.sample_predictors import PrecomputedPredictor as PrecomputedPredictor
    from smarig.replay.sample_predictors import ZeroedPredictor as ZeroedPredictor
    from smarig.replay.simulation import check_input as check_input
    from smarig.replay.simulation import check_output as check_output
    from smarig.replay.simulation import out_of_range as out_of_range
    from smarig.replay.simulation import simulate as simulate
    from smarig.replay.simulation import simulate_runs as simulate_runs
    from smarig.replay.simulation import simulate_samples as simulate_samples
    from smarig.replay.stress_strain import stress_strain as stress_strain
    from smarig.replay.timeline import ReadingSeries as ReadingSeries
    from smarig.replay.timeline import Timeline as Timeline
    from smarig.replay.timeline_from_runs import build_timeline as build_timeline
    from smarig.replay.wire_stress import StressRange as StressRange
    from smarig.replay.wire_stress import stress_over_run as stress_over_run
    from smarig.replay.wire_temperature import TemperatureSource as TemperatureSource
    from smarig.replay.wire_temperature import is_heated_by_model as is_heated_by_model
    from smarig.replay.wire_temperature import temperature_source as temperature_source
    from smarig.replay.wire_temperature import with_wire_temperature as with_wire_temperature
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
