"""Theory of the Preisach operator after the thesis: state space, properties, energy, and extended models."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.theory.energy.available_storage import available_storage as available_storage
    from smarig.theory.energy.dissipation import energy_balance as energy_balance
    from smarig.theory.energy.dissipation import recoverable_energy as recoverable_energy
    from smarig.theory.energy.dissipativity import DissipativityCertificate as DissipativityCertificate
    from smarig.theory.energy.dissipativity import certify as certify
    from smarig.theory.energy.moments import loop_area as loop_area
    from smarig.theory.energy.moments import moments_on as moments_on
    from smarig.theory.energy.storage_function import (
        recoverable_energy_is_storage as recoverable_energy_is_storage,
    )
    from smarig.theory.energy.sweep_work import work as work
    from smarig.theory.energy.violation import Violation as Violation
    from smarig.theory.energy.violation import confirm as confirm
    from smarig.theory.extended.accommodating_operator import AccommodatingPreisach as AccommodatingPreisach
    from smarig.theory.extended.moving_operator import MovingPreisach as MovingPreisach
    from smarig.theory.extended.moving_operator import slope_range as slope_range
    from smarig.theory.extended.nonlinear_operator import NonlinearPreisach as NonlinearPreisach
    from smarig.theory.extended.nonlinear_operator import SecondOrderExcess as SecondOrderExcess
    from smarig.theory.extended.nonlinear_operator import second_order_mask as second_order_mask
    from smarig.theory.extended.restricted_operator import RestrictedPreisach as RestrictedPreisach
    from smarig.theory.extended.reversible_operator import ReversiblePart as ReversiblePart
    from smarig.theory.extended.reversible_operator import ReversiblePreisach as ReversiblePreisach
    from smarig.theory.properties.classes import MeasureClasses as MeasureClasses
    from smarig.theory.properties.classes import classes as classes
    from smarig.theory.properties.monotone import Monotonicity as Monotonicity
    from smarig.theory.properties.monotone import crossing_descending as crossing_descending
    from smarig.theory.properties.monotone import largest_slope as largest_slope
    from smarig.theory.properties.monotone import monotone as monotone
    from smarig.theory.properties.summary import properties as properties
    from smarig.theory.state_space.boundary import Boundary as Boundary
    from smarig.theory.state_space.boundary import diagonal as diagonal
    from smarig.theory.state_space.boundary import staircase_points as staircase_points
    from smarig.theory.state_space.operator_state import boundary_of as boundary_of
    from smarig.theory.state_space.operator_state import distance as distance
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
