"""Certificates: what is proved about a model before a loop is closed around it (thesis ch. 8, §9.2)."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.certificate.certificate_scope import CONTROL_FINDINGS as CONTROL_FINDINGS
    from smarig.certificate.certificate_units import Units as Units
    from smarig.certificate.certify_hysteresis import certificate as certificate
    from smarig.certificate.hypothesis import Hypothesis as Hypothesis
    from smarig.certificate.hypothesis import failing as failing
    from smarig.certificate.hysteresis_analysis import HysteresisAnalysis as HysteresisAnalysis
    from smarig.certificate.integral_convergence import IntegralConvergence as IntegralConvergence
    from smarig.certificate.measured_passivity import MeasuredPassivity as MeasuredPassivity
    from smarig.certificate.measured_passivity import reading_noise as reading_noise
    from smarig.certificate.measured_passivity import segment_passivity as segment_passivity
    from smarig.certificate.model_certificate import ModelCertificate as ModelCertificate
    from smarig.certificate.model_posterior import ModelPosterior as ModelPosterior
    from smarig.certificate.model_posterior import model_posterior as model_posterior
    from smarig.certificate.position_supply_rate import PositionController as PositionController
    from smarig.certificate.rig_assessment import RigAssessment as RigAssessment
    from smarig.certificate.robust_certificate import RobustCertificate as RobustCertificate
    from smarig.certificate.robust_certificate import robust_certificate as robust_certificate
    from smarig.certificate.storage_bound import StorageBound as StorageBound
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
