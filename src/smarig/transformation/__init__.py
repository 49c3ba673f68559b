"""Transformation temperatures of a wire by the tangent method (ASTM E3097, F2082, F2004), with their intervals."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.transformation.branch_tangents import BranchTangents as BranchTangents
    from smarig.transformation.branch_tangents import branch_tangents as branch_tangents
    from smarig.transformation.calorimetry import HEAT_FIGURES as HEAT_FIGURES
    from smarig.transformation.calorimetry import HEAT_TEMPERATURES as HEAT_TEMPERATURES
    from smarig.transformation.calorimetry import Calorimetry as Calorimetry
    from smarig.transformation.calorimetry import CalorimetryCycle as CalorimetryCycle
    from smarig.transformation.calorimetry import HeatFlowScan as HeatFlowScan
    from smarig.transformation.calorimetry import calorimetry as calorimetry
    from smarig.transformation.chosen_cycles import cycles_text as cycles_text
    from smarig.transformation.cycle_figures import CORNERS as CORNERS
    from smarig.transformation.cycle_figures import FIGURES as FIGURES
    from smarig.transformation.cycle_figures import NAMES as NAMES
    from smarig.transformation.cycle_figures import TEMPERATURES as TEMPERATURES
    from smarig.transformation.cycle_figures import CycleFigures as CycleFigures
    from smarig.transformation.cycle_figures import Drawn as Drawn
    from smarig.transformation.decades import DECADE as DECADE
    from smarig.transformation.figures_text import value_text as value_text
    from smarig.transformation.figures_text import why_not as why_not
    from smarig.transformation.headline import HEADLINE as HEADLINE
    from smarig.transformation.headline import full_loop as full_loop
    from smarig.transformation.headline import headline as headline
    from smarig.transformation.heat_flow_peak import HeatFlowPeak as HeatFlowPeak
    from smarig.transformation.heat_flow_peak import heat_flow_peak as heat_flow_peak
    from smarig.transformation.run_figures import RunFigures as RunFigures
    from smarig.transformation.run_figures import run_figures as run_figures
    from smarig.transformation.stress_dependence import LoadSlope as LoadSlope
    from smarig.transformation.stress_dependence import StressSlope as StressSlope
    from smarig.transformation.tangent_ranges import stated_ranges as stated_ranges
    from smarig.transformation.transformation_temperatures import (
        TransformationResult as TransformationResult,
    )
    from smarig.transformation.transformation_temperatures import (
        transformation_temperatures as transformation_temperatures,
    )
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
