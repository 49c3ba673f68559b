"""Diagnosis: what a model predicts wrongly, which effects explain it, and how much an extended model gains.

``diagnose`` compares hypotheses by how well they predict blocks of readings that were left out: of runs with settled
steps in ``comparison.commanded``, of runs that have only a measured input in ``comparison.measured``. ``comparison``
holds the weights of hypotheses and the rules of a verdict, ``refit`` the density and the noise of commanded runs.
``comparison.thermal`` diagnoses records of wire temperature.
"""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.diagnosis.comparison.commanded.commanded_comparison import (
        diagnose_commanded as diagnose_commanded,
    )
    from smarig.diagnosis.comparison.commanded.commanded_diagnosis import (
        CommandedDiagnosis as CommandedDiagnosis,
    )
    from smarig.diagnosis.comparison.commanded.commanded_law import CommandedLaw as CommandedLaw
    from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis as ComparedHypothesis
    from smarig.diagnosis.comparison.compared_hypothesis import Part as Part
    from smarig.diagnosis.comparison.finding import Finding as Finding
    from smarig.diagnosis.comparison.measured.learned_law import LearnedLaw as LearnedLaw
    from smarig.diagnosis.comparison.measured.measured_comparison import (
        MeasuredComparison as MeasuredComparison,
    )
    from smarig.diagnosis.comparison.measured.measured_diagnosis import MeasuredDiagnosis as MeasuredDiagnosis
    from smarig.diagnosis.comparison.measured.measured_diagnosis import diagnose_measured as diagnose_measured
    from smarig.diagnosis.comparison.measured.measured_text import offset_sentence as offset_sentence
    from smarig.diagnosis.comparison.missing_knowledge import inputs_of_error as inputs_of_error
    from smarig.diagnosis.comparison.missing_knowledge import missing_share as missing_share
    from smarig.diagnosis.comparison.probabilities import Probabilities as Probabilities
    from smarig.diagnosis.comparison.thermal.thermal_diagnosis import ThermalDiagnosis as ThermalDiagnosis
    from smarig.diagnosis.comparison.thermal.thermal_diagnosis import diagnose_transient as diagnose_transient
    from smarig.diagnosis.comparison.verdict_rules import RULES as RULES
    from smarig.diagnosis.comparison.verdict_sentences import doubtful_causes as doubtful_causes
    from smarig.diagnosis.comparison.weights import TEMPERATURE as TEMPERATURE
    from smarig.diagnosis.comparison.weights import Weights as Weights
    from smarig.diagnosis.diagnose import diagnose as diagnose
    from smarig.diagnosis.diagnosis_files import DIAGNOSIS_FILES as DIAGNOSIS_FILES
    from smarig.diagnosis.diagnosis_files import DIAGNOSIS_JSON as DIAGNOSIS_JSON
    from smarig.diagnosis.diagnosis_files import DIAGNOSIS_MODEL as DIAGNOSIS_MODEL
    from smarig.diagnosis.diagnosis_files import DIAGNOSIS_PAGE as DIAGNOSIS_PAGE
    from smarig.diagnosis.diagnosis_files import prepare_folder as prepare_folder
    from smarig.diagnosis.diagnosis_files import write_diagnosis as write_diagnosis
    from smarig.diagnosis.diagnosis_files import write_transient as write_transient
    from smarig.diagnosis.diagnosis_text import AT_FLOOR as AT_FLOOR
    from smarig.diagnosis.diagnosis_text import share_text as share_text
    from smarig.diagnosis.drive_statistics import MIN_COUNT_SD as MIN_COUNT_SD
    from smarig.diagnosis.drive_statistics import DriveStatistics as DriveStatistics
    from smarig.diagnosis.held_out_gain import HeldOutGain as HeldOutGain
    from smarig.diagnosis.noise_terms import POINT_NOISE as POINT_NOISE
    from smarig.diagnosis.noise_terms import PREDICTION_LIMIT as PREDICTION_LIMIT
    from smarig.diagnosis.noise_terms import WIRE_NOISE as WIRE_NOISE
    from smarig.diagnosis.refit.joint_density import joint_density as joint_density
    from smarig.diagnosis.refit.joint_density import (
        joint_density_from_best_start as joint_density_from_best_start,
    )
    from smarig.diagnosis.refit.memory_noise import memory_covariance as memory_covariance
    from smarig.diagnosis.refit.memory_noise import memory_slopes as memory_slopes
    from smarig.diagnosis.refit.parameter_fit import fit_parameters as fit_parameters
    from smarig.diagnosis.refit.refit import NoiseEstimate as NoiseEstimate
    from smarig.diagnosis.refit.refit import Refit as Refit
    from smarig.diagnosis.variable_words import variable_experiment as variable_experiment
    from smarig.diagnosis.variable_words import variable_words as variable_words
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
