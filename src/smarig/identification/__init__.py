"""Identification from recorded runs: surfaces, positive densities, FORC data, calibration, verification."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.identification.adaptive import informed_choice as informed_choice
    from smarig.identification.assumed_starts import assumed_starts as assumed_starts
    from smarig.identification.assumed_starts import assumed_starts_text as assumed_starts_text
    from smarig.identification.calibration.calibrate import Calibration as Calibration
    from smarig.identification.calibration.calibrate import calibrate as calibrate
    from smarig.identification.calibration.holds import valid_rows as valid_rows
    from smarig.identification.density_report import DensityReport as DensityReport
    from smarig.identification.density_report import density_report as density_report
    from smarig.identification.error_verdict import BETTER as BETTER
    from smarig.identification.error_verdict import GOOD_RATIO as GOOD_RATIO
    from smarig.identification.error_verdict import HARDLY_BETTER as HARDLY_BETTER
    from smarig.identification.error_verdict import LARGE_PLACE as LARGE_PLACE
    from smarig.identification.error_verdict import LITTLE_UNPREDICTED as LITTLE_UNPREDICTED
    from smarig.identification.error_verdict import POOR_RATIO as POOR_RATIO
    from smarig.identification.error_verdict import SMALL_SHARE as SMALL_SHARE
    from smarig.identification.error_verdict import AgainstCurves as AgainstCurves
    from smarig.identification.error_verdict import ErrorLevel as ErrorLevel
    from smarig.identification.error_verdict import ErrorParts as ErrorParts
    from smarig.identification.error_verdict import ErrorVerdict as ErrorVerdict
    from smarig.identification.error_verdict import error_verdict as error_verdict
    from smarig.identification.error_verdict import ratio_text as ratio_text
    from smarig.identification.extended.choose_extension import ExtensionChoice as ExtensionChoice
    from smarig.identification.extended.extension_names import extension_names as extension_names
    from smarig.identification.fitted_hysteresis import opposite_senses as opposite_senses
    from smarig.identification.fod_data import FodData as FodData
    from smarig.identification.fod_data import fod_data as fod_data
    from smarig.identification.forc.central_ridge import CentralRidge as CentralRidge
    from smarig.identification.forc.central_ridge import central_ridge as central_ridge
    from smarig.identification.forc.forc_density import forc_density as forc_density
    from smarig.identification.forc.forc_diagram import SIGNIFICANT as SIGNIFICANT
    from smarig.identification.forc.forc_diagram import ForcDiagram as ForcDiagram
    from smarig.identification.forc.forc_diagram import check_factor as check_factor
    from smarig.identification.forc.forc_diagram import forc_diagram as forc_diagram
    from smarig.identification.identification_result import Identification as Identification
    from smarig.identification.identify import identify as identify
    from smarig.identification.interval_estimate import Estimate as Estimate
    from smarig.identification.interval_estimate import variance_inflation as variance_inflation
    from smarig.identification.material.law import MaterialLaw as MaterialLaw
    from smarig.identification.material.law import cooled_fraction as cooled_fraction
    from smarig.identification.material.law import heated_fraction as heated_fraction
    from smarig.identification.material.law import heating_finish as heating_finish
    from smarig.identification.material.law import transformation_strain as transformation_strain
    from smarig.identification.material.material_identification import (
        MaterialIdentification as MaterialIdentification,
    )
    from smarig.identification.material.material_identification import RecordFit as RecordFit
    from smarig.identification.material.material_identification import identify_material as identify_material
    from smarig.identification.material.material_text import parameter_cells as parameter_cells
    from smarig.identification.material.material_text import quantity_name as quantity_name
    from smarig.identification.measured.left_out_errors import held_out_errors as held_out_errors
    from smarig.identification.measured.load_dependence import OWN_ADVANTAGE as OWN_ADVANTAGE
    from smarig.identification.measured.load_dependence import PROPORTIONAL as PROPORTIONAL
    from smarig.identification.measured.load_dependence import LoadDependence as LoadDependence
    from smarig.identification.measured.load_dependence import fit_load_dependence as fit_load_dependence
    from smarig.identification.measured.measured_fit import SMOOTHINGS as SMOOTHINGS
    from smarig.identification.measured.measured_fit import MeasuredFit as MeasuredFit
    from smarig.identification.measured.measured_fit import fit_measured as fit_measured
    from smarig.identification.measured.measured_fit import measured_problem as measured_problem
    from smarig.identification.measured.measured_fit import output_sign as output_sign
    from smarig.identification.measured.measured_hypothesis import Comparison as Comparison
    from smarig.identification.measured.measured_hypothesis import MeasuredHypothesis as MeasuredHypothesis
    from smarig.identification.measured.measured_hypothesis import compared as compared
    from smarig.identification.measured.measured_hypothesis import condition_table as condition_table
    from smarig.identification.measured.reading_weights import local_slope as local_slope
    from smarig.identification.noise_floor import noise_floor as noise_floor
    from smarig.identification.positive.adapted_partition import SAME_LEVEL as SAME_LEVEL
    from smarig.identification.positive.adapted_partition import adapted_nodes as adapted_nodes
    from smarig.identification.positive.observations import Observations as Observations
    from smarig.identification.positive.positive_fit import PositiveFit as PositiveFit
    from smarig.identification.positive.positive_fit import fit_positive as fit_positive
    from smarig.identification.positive.positive_fit import fit_table as fit_table
    from smarig.identification.positive.triangle import Triangle as Triangle
    from smarig.identification.rows_used import RowsUsed as RowsUsed
    from smarig.identification.rows_used import without_dropouts as without_dropouts
    from smarig.identification.run_passivity import passivity_of_run as passivity_of_run
    from smarig.identification.sensing.fit_sensing import identify_sensing as identify_sensing
    from smarig.identification.sensing.sensing_errors import SensingErrors as SensingErrors
    from smarig.identification.sensing.sensing_errors import sensing_errors as sensing_errors
    from smarig.identification.sensing.sensing_errors import sensing_text as sensing_text
    from smarig.identification.surface.choose_surface import INTERVAL_LEVEL as INTERVAL_LEVEL
    from smarig.identification.surface.choose_surface import SIMPLER_TOLERANCE as SIMPLER_TOLERANCE
    from smarig.identification.surface.choose_surface import FittedImage as FittedImage
    from smarig.identification.surface.choose_surface import SurfaceChoice as SurfaceChoice
    from smarig.identification.surface.curve_fit import fit_curves as fit_curves
    from smarig.identification.surface.curve_report import NO_CURVES as NO_CURVES
    from smarig.identification.surface.representation_tests import Representation as Representation
    from smarig.identification.surface.representation_tests import congruency as congruency
    from smarig.identification.surface.representation_tests import wiping_out as wiping_out
    from smarig.identification.surface.surface_kinds import BEST_KIND as BEST_KIND
    from smarig.identification.surface.surface_kinds import POSITIVE_KIND as POSITIVE_KIND
    from smarig.identification.surface.surface_kinds import surface_choices as surface_choices
    from smarig.identification.surface.surface_kinds import surface_kinds as surface_kinds
    from smarig.identification.surface.surface_through_states import (
        surface_through_states as surface_through_states,
    )
    from smarig.identification.verdict_thresholds import study_sentences as study_sentences
    from smarig.identification.verdict_thresholds import threshold_sentences as threshold_sentences
    from smarig.identification.verification import ONLY_NOISE as ONLY_NOISE
    from smarig.identification.verification import PredictionErrors as PredictionErrors
    from smarig.identification.verification import RunVerification as RunVerification
    from smarig.identification.verification import Verification as Verification
    from smarig.identification.verify import selected_points as selected_points
    from smarig.identification.verify import verify as verify
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
