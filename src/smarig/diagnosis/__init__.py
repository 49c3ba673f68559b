"""Diagnosis: what a model predicts wrongly, which effects explain it, and how much an extended model gains.

In the order of the work, after ``smarig.replay``: ``explain.candidates`` (what may be wrong), ``critique.refit``
(fit of density and noise), ``critique.critique`` (does anything exceed the noise?), ``explain.search`` (which
effects explain it?), ``diagnosis_verdict`` and ``held_out_gain``. ``diagnose_commanded`` runs them all.
``comparison.measured`` diagnoses runs that have only a measured input, ``comparison.thermal`` records of wire
temperature.
"""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.diagnosis.commanded_diagnosis import diagnose_commanded as diagnose_commanded
    from smarig.diagnosis.comparison.commanded.commanded_comparison import (
        compare_commanded as compare_commanded,
    )
    from smarig.diagnosis.comparison.commanded.commanded_result import (
        CommandedComparison as CommandedComparison,
    )
    from smarig.diagnosis.comparison.commanded.commanded_result import LikelyEffect as LikelyEffect
    from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis as ComparedHypothesis
    from smarig.diagnosis.comparison.compared_hypothesis import Part as Part
    from smarig.diagnosis.comparison.measured.learned_law import LearnedLaw as LearnedLaw
    from smarig.diagnosis.comparison.measured.measured_comparison import (
        MeasuredComparison as MeasuredComparison,
    )
    from smarig.diagnosis.comparison.measured.measured_comparison import compare_measured as compare_measured
    from smarig.diagnosis.comparison.measured.measured_diagnosis import MeasuredDiagnosis as MeasuredDiagnosis
    from smarig.diagnosis.comparison.measured.measured_diagnosis import diagnose_measured as diagnose_measured
    from smarig.diagnosis.comparison.measured.measured_text import offset_sentence as offset_sentence
    from smarig.diagnosis.comparison.thermal.thermal_diagnosis import ThermalDiagnosis as ThermalDiagnosis
    from smarig.diagnosis.comparison.thermal.thermal_diagnosis import diagnose_transient as diagnose_transient
    from smarig.diagnosis.comparison.weights import Weights as Weights
    from smarig.diagnosis.critique.calibration import CALIBRATION_BOXES as CALIBRATION_BOXES
    from smarig.diagnosis.critique.calibration import p_text as p_text
    from smarig.diagnosis.critique.candidates import DETECTION_SD as DETECTION_SD
    from smarig.diagnosis.critique.critique import MIN_SPREAD_NATS as MIN_SPREAD_NATS
    from smarig.diagnosis.critique.critique import NULL_DATA_SETS as NULL_DATA_SETS
    from smarig.diagnosis.critique.critique import CandidateScore as CandidateScore
    from smarig.diagnosis.critique.critique import Critique as Critique
    from smarig.diagnosis.critique.critique import critique as critique
    from smarig.diagnosis.critique.visibility import IMITATION_THRESHOLD as IMITATION_THRESHOLD
    from smarig.diagnosis.critique.visibility import VisibilityTable as VisibilityTable
    from smarig.diagnosis.critique.visibility import visibility as visibility
    from smarig.diagnosis.diagnose import diagnose as diagnose
    from smarig.diagnosis.diagnosis_files import DIAGNOSIS_FILES as DIAGNOSIS_FILES
    from smarig.diagnosis.diagnosis_files import DIAGNOSIS_JSON as DIAGNOSIS_JSON
    from smarig.diagnosis.diagnosis_files import DIAGNOSIS_MODEL as DIAGNOSIS_MODEL
    from smarig.diagnosis.diagnosis_files import DIAGNOSIS_PAGE as DIAGNOSIS_PAGE
    from smarig.diagnosis.diagnosis_files import prepare_folder as prepare_folder
    from smarig.diagnosis.diagnosis_files import write_diagnosis as write_diagnosis
    from smarig.diagnosis.diagnosis_files import write_transient as write_transient
    from smarig.diagnosis.diagnosis_json import parameter_interval as parameter_interval
    from smarig.diagnosis.diagnosis_result import Diagnosis as Diagnosis
    from smarig.diagnosis.diagnosis_text import AT_FLOOR as AT_FLOOR
    from smarig.diagnosis.diagnosis_text import DOUBT as DOUBT
    from smarig.diagnosis.diagnosis_text import nearest_text as nearest_text
    from smarig.diagnosis.diagnosis_text import share_text as share_text
    from smarig.diagnosis.diagnosis_text import unknown_text as unknown_text
    from smarig.diagnosis.diagnosis_verdict import LEAD_SCALE_NATS as LEAD_SCALE_NATS
    from smarig.diagnosis.diagnosis_verdict import lead_scale_nats as lead_scale_nats
    from smarig.diagnosis.drive_statistics import MIN_COUNT_SD as MIN_COUNT_SD
    from smarig.diagnosis.drive_statistics import DriveStatistics as DriveStatistics
    from smarig.diagnosis.explain.explanation import Explanation as Explanation
    from smarig.diagnosis.explain.joint_density import joint_density as joint_density
    from smarig.diagnosis.explain.joint_density import (
        joint_density_from_best_start as joint_density_from_best_start,
    )
    from smarig.diagnosis.explain.learned_term_fit import LearnedTermFit as LearnedTermFit
    from smarig.diagnosis.explain.parameter_fit import ParameterFit as ParameterFit
    from smarig.diagnosis.explain.parameter_fit import fit_parameters as fit_parameters
    from smarig.diagnosis.held_out_gain import HeldOutGain as HeldOutGain
    from smarig.diagnosis.name_gates import DISCREPANCY_NATS as DISCREPANCY_NATS
    from smarig.diagnosis.name_gates import NORMAL_95 as NORMAL_95
    from smarig.diagnosis.name_gates import SILENT_RATIO as SILENT_RATIO
    from smarig.diagnosis.noise_terms import POINT_NOISE as POINT_NOISE
    from smarig.diagnosis.noise_terms import PREDICTION_LIMIT as PREDICTION_LIMIT
    from smarig.diagnosis.noise_terms import REMAINING_SCATTER as REMAINING_SCATTER
    from smarig.diagnosis.refit.memory_noise import memory_covariance as memory_covariance
    from smarig.diagnosis.refit.memory_noise import memory_slopes as memory_slopes
    from smarig.diagnosis.refit.refit import Refit as Refit
    from smarig.diagnosis.variable_words import variable_experiment as variable_experiment
    from smarig.diagnosis.variable_words import variable_words as variable_words
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
