"""Preisach hysteresis: the operator, its inverse, and the surfaces, tables and measures that define it."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.preisach.checked_input import input_array as input_array
    from smarig.preisach.checked_input import input_number as input_number
    from smarig.preisach.checked_input import input_rows as input_rows
    from smarig.preisach.checked_input import vector as vector
    from smarig.preisach.compiled import compiled_available as compiled_available
    from smarig.preisach.everett import Everett as Everett
    from smarig.preisach.hysteresis.fod_surface import FodSurface as FodSurface
    from smarig.preisach.hysteresis.fod_surface import sigmoid as sigmoid
    from smarig.preisach.hysteresis.fod_table import FodTable as FodTable
    from smarig.preisach.hysteresis.forc_curve import ForcCurve as ForcCurve
    from smarig.preisach.hysteresis.forc_table import ForcTable as ForcTable
    from smarig.preisach.hysteresis.gorbet_1997 import THESIS_PARTITIONS as THESIS_PARTITIONS
    from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES as THESIS_SURFACES
    from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface as thesis_surface
    from smarig.preisach.hysteresis.hysteresis_json import dump_hysteresis as dump_hysteresis
    from smarig.preisach.hysteresis.hysteresis_json import load_hysteresis as load_hysteresis
    from smarig.preisach.hysteresis.lattice import lattice as lattice
    from smarig.preisach.hysteresis.mirrored import Mirrored as Mirrored
    from smarig.preisach.hysteresis.mirrored import mirror_image as mirror_image
    from smarig.preisach.hysteresis.mirrored import unmirrored as unmirrored
    from smarig.preisach.hysteresis.relay_measure import RelayMeasure as RelayMeasure
    from smarig.preisach.hysteresis.surface_form import Parameters as Parameters
    from smarig.preisach.hysteresis.surface_form import SurfaceForm as SurfaceForm
    from smarig.preisach.hysteresis.surface_form import surface_form as surface_form
    from smarig.preisach.hysteresis.surface_form import surface_forms as surface_forms
    from smarig.preisach.interval import Interval as Interval
    from smarig.preisach.interval import shift_bounds as shift_bounds
    from smarig.preisach.inverse import InverseSolver as InverseSolver
    from smarig.preisach.inverse import bracketed_root as bracketed_root
    from smarig.preisach.many_models import simulate_models as simulate_models
    from smarig.preisach.operator import Initial as Initial
    from smarig.preisach.operator import Preisach as Preisach
    from smarig.preisach.sensitivity import sensitivities as sensitivities
    from smarig.preisach.state import State as State
    from smarig.preisach.turning_points import turning_points as turning_points
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
