"""Control of a hysteretic wire (thesis ch. 8): velocity feedback, set-point regulation, tracking.

A closed loop is a protocol like any other: a generator of commands, so the rig's limits, trips and lease apply.
"""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.control.argument_checks import finite as finite
    from smarig.control.argument_checks import not_negative as not_negative
    from smarig.control.controller_settings import SETPOINT_CONTROLLERS as SETPOINT_CONTROLLERS
    from smarig.control.controller_settings import TRACKING_CONTROLLERS as TRACKING_CONTROLLERS
    from smarig.control.controller_settings import VELOCITY_CONTROLLERS as VELOCITY_CONTROLLERS
    from smarig.control.controller_settings import controller_numbers as controller_numbers
    from smarig.control.controller_settings import default_numbers as default_numbers
    from smarig.control.controller_settings import documented_numbers as documented_numbers
    from smarig.control.controller_settings import finite_number as finite_number
    from smarig.control.controller_settings import optional_numbers as optional_numbers
    from smarig.control.lagged_operator import LaggedOperator as LaggedOperator
    from smarig.control.regulation.anhysteretic_output import Psi as Psi
    from smarig.control.regulation.approach import plan_approach as plan_approach
    from smarig.control.regulation.boundary_plane import BoundaryPlane as BoundaryPlane
    from smarig.control.regulation.integral_gain import IntegralGains as IntegralGains
    from smarig.control.regulation.integral_gain import LoopTiming as LoopTiming
    from smarig.control.regulation.integral_gain import integral_gain_unit as integral_gain_unit
    from smarig.control.regulation.integral_gain import integral_gains as integral_gains
    from smarig.control.regulation.regulation_protocol import REGULATION_PLANNED as REGULATION_PLANNED
    from smarig.control.regulation.regulation_protocol import SETPOINT_DISTURBED as SETPOINT_DISTURBED
    from smarig.control.regulation.regulation_protocol import SETPOINT_LOOP_CLOSED as SETPOINT_LOOP_CLOSED
    from smarig.control.regulation.regulation_protocol import SETPOINT_LOOP_OPENED as SETPOINT_LOOP_OPENED
    from smarig.control.regulation.regulation_protocol import START_STATES as START_STATES
    from smarig.control.regulation.regulation_protocol import check_times as check_times
    from smarig.control.regulation.regulation_protocol import regulate as regulate
    from smarig.control.regulation.setpoint_pi import SetpointController as SetpointController
    from smarig.control.sensing.position_observer import AMBIGUOUS_SHARE as AMBIGUOUS_SHARE
    from smarig.control.sensing.position_observer import Observation as Observation
    from smarig.control.sensing.position_observer import PositionObserver as PositionObserver
    from smarig.control.sensing.position_observer import is_ambiguous as is_ambiguous
    from smarig.control.sensing.resistance_feedback import OBSERVED as OBSERVED
    from smarig.control.sensing.resistance_feedback import ResistanceFeedback as ResistanceFeedback
    from smarig.control.sensing.resistance_map import ONE_WIRE_TERMS as ONE_WIRE_TERMS
    from smarig.control.sensing.resistance_map import TWO_WIRE_TERMS as TWO_WIRE_TERMS
    from smarig.control.sensing.resistance_map import ResistanceMap as ResistanceMap
    from smarig.control.sensing.resistance_map import SelfSensing as SelfSensing
    from smarig.control.sensing.resistance_map import map_terms as map_terms
    from smarig.control.sensing.wire_prediction import WirePrediction as WirePrediction
    from smarig.control.tracking.controller_model import Controller as Controller
    from smarig.control.tracking.controller_model import ControllerModel as ControllerModel
    from smarig.control.tracking.controller_model import ReferenceFunction as ReferenceFunction
    from smarig.control.tracking.reference import REFERENCE_SHAPES as REFERENCE_SHAPES
    from smarig.control.tracking.reference import Reference as Reference
    from smarig.control.tracking.reference import reference as reference
    from smarig.control.tracking.reference import reference_from_csv as reference_from_csv
    from smarig.control.tracking.tracking_performance import SETTLED_FOR_S as SETTLED_FOR_S
    from smarig.control.tracking.tracking_performance import SETTLING_BAND_COUNTS as SETTLING_BAND_COUNTS
    from smarig.control.tracking.tracking_performance import TrackingPerformance as TrackingPerformance
    from smarig.control.tracking.tracking_performance import tracking_performance as tracking_performance
    from smarig.control.tracking.tracking_protocol import TRACKING_LOOP_CLOSED as TRACKING_LOOP_CLOSED
    from smarig.control.tracking.tracking_protocol import track as track
    from smarig.control.tracking.tuning import controller_factory as controller_factory
    from smarig.control.tracking.tuning import default_settings as default_settings
    from smarig.control.tracking.tuning import tuned_numbers as tuned_numbers
    from smarig.control.velocity.controllers.constant_gain import constant_gain as constant_gain
    from smarig.control.velocity.controllers.lead_lag import lead_lag as lead_lag
    from smarig.control.velocity.velocity_controller import VelocityController as VelocityController
    from smarig.control.velocity.velocity_protocol import FILTER_TICKS as FILTER_TICKS
    from smarig.control.velocity.velocity_protocol import VELOCITY_LOOP_MEASURED as VELOCITY_LOOP_MEASURED
    from smarig.control.velocity.velocity_protocol import VELOCITY_LOOP_STARTED as VELOCITY_LOOP_STARTED
    from smarig.control.velocity.velocity_protocol import VelocityFilter as VelocityFilter
    from smarig.control.velocity.velocity_protocol import running_ratio as running_ratio
    from smarig.control.velocity.velocity_protocol import velocity_tracking as velocity_tracking
    from smarig.control.velocity.velocity_protocol import with_lead_in as with_lead_in
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
