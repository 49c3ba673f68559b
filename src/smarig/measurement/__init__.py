"""Measurement effects: what lies between a recorded input or output and that of the hysteresis.

A sensor that responds late, an offset between two runs, a stress that shifts the transformation: each changes the
input of a record, or adds to its output, before and after the hysteresis. Each is a file in ``measurement/effects``.
What no effect describes can be learned (``learned_term``).
"""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.measurement.condition_table import SAME_SHARE as SAME_SHARE
    from smarig.measurement.condition_table import ConditionTable as ConditionTable
    from smarig.measurement.condition_table import condition_groups as condition_groups
    from smarig.measurement.input_record import CONTINUES_AT as CONTINUES_AT
    from smarig.measurement.input_record import ONE_RATE as ONE_RATE
    from smarig.measurement.input_record import PART_OF as PART_OF
    from smarig.measurement.input_record import InputRecord as InputRecord
    from smarig.measurement.input_record import cycles_before as cycles_before
    from smarig.measurement.input_record import dropouts as dropouts
    from smarig.measurement.input_record import full_cycles_before as full_cycles_before
    from smarig.measurement.input_record import input_noise_sd as input_noise_sd
    from smarig.measurement.input_record import input_records as input_records
    from smarig.measurement.input_record import monotone_branches as monotone_branches
    from smarig.measurement.input_record import noise_range as noise_range
    from smarig.measurement.input_record import output_noise_sd as output_noise_sd
    from smarig.measurement.input_record import recorded_means as recorded_means
    from smarig.measurement.input_record import reversals as reversals
    from smarig.measurement.input_record import rounding_sd as rounding_sd
    from smarig.measurement.learned_term import LearnedTerm as LearnedTerm
    from smarig.measurement.learned_term import learned_input as learned_input
    from smarig.measurement.learned_term import learned_output as learned_output
    from smarig.measurement.learned_variables import LEVEL as LEVEL
    from smarig.measurement.learned_variables import branch_directions as branch_directions
    from smarig.measurement.learned_variables import shared_variables as shared_variables
    from smarig.measurement.learned_variables import variable_of as variable_of
    from smarig.measurement.learned_variables import variable_unit as variable_unit
    from smarig.measurement.loop_direction import width_of_leading_loops as width_of_leading_loops
    from smarig.measurement.measurement_effect import MeasurementEffect as MeasurementEffect
    from smarig.measurement.measurement_effect import MeasurementEffectType as MeasurementEffectType
    from smarig.measurement.measurement_effect import RecordChange as RecordChange
    from smarig.measurement.measurement_effect import SearchedParameter as SearchedParameter
    from smarig.measurement.measurement_effect import changed as changed
    from smarig.measurement.measurement_effect import measurement_effect_types as measurement_effect_types
    from smarig.measurement.measurement_effect import measurement_effects as measurement_effects
    from smarig.measurement.measurement_part import MeasurementPart as MeasurementPart
    from smarig.measurement.reading_rows import spread_rows as spread_rows
    from smarig.measurement.starting_state import SATURATION_TOLERANCE as SATURATION_TOLERANCE
    from smarig.measurement.starting_state import STARTS as STARTS
    from smarig.measurement.starting_state import Start as Start
    from smarig.measurement.starting_state import StartingState as StartingState
    from smarig.measurement.starting_state import first_branch_differs as first_branch_differs
    from smarig.measurement.starting_state import has_measured_input as has_measured_input
    from smarig.measurement.starting_state import may_assume_start as may_assume_start
    from smarig.measurement.starting_state import noise_at_start as noise_at_start
    from smarig.measurement.starting_state import starting_state as starting_state
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
