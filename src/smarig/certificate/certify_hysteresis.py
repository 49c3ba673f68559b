"""Certifies a hysteresis: applies chapter 8 to one model and to the requested velocity controllers."""

from collections.abc import Iterable, Mapping
from typing import Any

from smarig.certificate.certificate_scope import CONTROL_FINDINGS, CertificateScope
from smarig.certificate.certificate_units import Units
from smarig.certificate.hypothesis import all_hold
from smarig.certificate.hysteresis_analysis import HysteresisAnalysis
from smarig.certificate.integral_convergence import integral_convergence
from smarig.certificate.model_certificate import ControllerResult, ModelCertificate
from smarig.certificate.passivity import PassivityCounterexample, counterexample
from smarig.certificate.position_assumptions import indistinguishable_states
from smarig.certificate.storage_bound import storage_bound
from smarig.certificate.velocity.stability import basis, controller_stability
from smarig.control import TRACKING_CONTROLLERS, VELOCITY_CONTROLLERS, LoopTiming, controller_numbers
from smarig.core import UsageError, catalogue_entry, catalogue_names
from smarig.preisach import Everett, Initial, Preisach


def certificate(
    hysteresis: Everett,
    controllers: Mapping[str, Mapping[str, Any]] | None = None,
    units: Units | None = None,
    timing: LoopTiming | None = None,
) -> ModelCertificate:
    """Certify a hysteresis with velocity controllers, given by name with the numbers that differ from the defaults.

    ``controllers``: the whole catalogue if None. ``units``: those of the hysteresis if None.
    ``timing``: of a rig, for the gains of integral action there. Raises UsageError for a
    controller that feeds back the position.

    >>> from smarig.preisach import thesis_surface
    >>> found = certificate(thesis_surface("one_e"), {"constant_gain": {"gain": 4.0}})
    >>> found.passive, found.classes.M_P, found.controllers[0].k_e
    (True, False, 2.0)
    >>> certificate(thesis_surface("two_p"), {"constant_gain": {"gain": 4.0}}).controllers[0].k_e is None
    True
    """
    requested = (
        {name: {} for name in catalogue_names(VELOCITY_CONTROLLERS)} if controllers is None else controllers
    )
    _check_names(requested)
    numbers_by_controller = {
        name: controller_numbers(VELOCITY_CONTROLLERS, name, pairs) for name, pairs in requested.items()
    }
    built_controllers = {
        name: catalogue_entry(VELOCITY_CONTROLLERS, name)(**numbers)
        for name, numbers in numbers_by_controller.items()
    }
    hysteresis_analysis = HysteresisAnalysis.of(hysteresis, units)
    initial = initial_of(hysteresis_analysis.hysteresis)
    stored = storage_bound(hysteresis_analysis, Preisach(hysteresis_analysis.hysteresis, initial).state)
    basis_of_model = basis(hysteresis_analysis, initial, stored)
    is_two_sided = initial == "anhysteretic" and hysteresis.lower < 0.0 < hysteresis.upper
    return ModelCertificate(
        initial=initial,
        classes=hysteresis_analysis.classes,
        dissipativity=hysteresis_analysis.dissipativity,
        undecided=hysteresis_analysis.undecided,
        storage_bound=stored,
        counterexample=_counterexample(hysteresis_analysis, initial),
        controllers=tuple(
            ControllerResult(
                name,
                numbers_by_controller[name],
                controller_stability(basis_of_model, built_controllers[name]),
            )
            for name in built_controllers
        ),
        scope=CertificateScope(
            stored.basis,
            hysteresis_analysis.monotone.holds,
            all_hold(basis_of_model.hypotheses),
            hysteresis_analysis.units,
        ),
        integral=integral_convergence(hysteresis_analysis, timing),
        indistinguishable=indistinguishable_states(hysteresis) if is_two_sided else None,
    )


def _check_names(requested: Iterable[str]) -> None:
    """Raise UsageError for position loops, which are not misspelt names."""
    for name in requested:
        if name in catalogue_names(TRACKING_CONTROLLERS):
            raise UsageError(
                f"'{name}' is a position loop (smarig track and regulate), which Thm 8.2 does not cover. certify "
                f"accepts {', '.join(catalogue_names(VELOCITY_CONTROLLERS))}. "
                f"{CONTROL_FINDINGS} describes position loops."
            )


def initial_of(hysteresis: Everett) -> Initial:
    """The state at u(0) = 0: cold for a wire on one side of zero, B* for two wires."""
    return "negative" if hysteresis.lower >= 0 else "anhysteretic"


def _counterexample(
    hysteresis_analysis: HysteresisAnalysis, initial: Initial
) -> PassivityCounterexample | None:
    try:
        return counterexample(hysteresis_analysis, initial)
    except UsageError:
        # There is none, or its loop is too small to repay the approach within the cycles that are tried.
        return None
