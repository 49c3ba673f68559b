"""Velocity feedback with a model from a file: checks of its arguments, and the loop with its certificate
(Thm 8.2)."""

from collections.abc import Mapping
from typing import Any

from smarig.certificate import RigAssessment, Units, certificate
from smarig.control import (
    FILTER_TICKS,
    VELOCITY_CONTROLLERS,
    Reference,
    finite_number,
    velocity_tracking,
    with_lead_in,
)
from smarig.core import UsageError, catalogue_entry, catalogue_names
from smarig.protocols import Setup
from smarig.replay import Model
from smarig.runner import ProtocolFactory


def checked_offset(offset_K: Any, setup: Setup) -> float:
    """u_o in kelvin, 0 if not given. Raises UsageError for an offset beyond the rig's range."""
    found = 0.0 if offset_K is None else finite_number("The offset u_o", offset_K)
    range_K = setup.upper_K - setup.lower_K
    if abs(found) > range_K:
        raise UsageError(
            f"An offset u_o of {found:g} K exceeds this rig's whole range, {range_K:.4g} K. Give a smaller one."
        )
    return found


def refuse_offset(offset_K: Any, controller: str) -> None:
    """Raise UsageError for an offset that a position loop would ignore."""
    if offset_K is not None:
        names = ", ".join(catalogue_names(VELOCITY_CONTROLLERS))
        raise UsageError(
            f"An offset u_o applies to velocity controllers only ({names}), but '{controller}' feeds back "
            "the position."
        )


def velocity_reference(reference: Reference, controller: str, offset_K: float) -> Reference:
    """The reference with a velocity, from the encoder's zero on. Raises UsageError if it has no velocity."""
    if reference.held:
        raise UsageError(
            f"'{controller}' feeds back the velocity, which is infinite at the jumps of steps. Give ramps, "
            "multisine or a CSV file."
        )
    led = with_lead_in(reference)
    if not any(led.position) and not offset_K:
        raise UsageError(
            f"Reference {reference.name} never moves and there is no offset u_o. Nothing drives a loop that feeds back "
            "the velocity."
        )
    return led


def velocity_factory(
    model: Model,
    setup: Setup,
    controller: str,
    numbers: Mapping[str, float],
    reference: Reference,
    offset_K: float = 0.0,
    lead_in_s: float = 0.0,
) -> ProtocolFactory:
    """The loop as a protocol. Its record holds what Thm 8.2 states of model and controller.

    ``lead_in_s``: the time in which the reference goes to its first position, for the record.
    """
    units = Units(model.unit, model.input.unit)
    (result,) = certificate(model.hysteresis, {controller: numbers}, units).controllers
    assessment = RigAssessment(result, setup, FILTER_TICKS * setup.period_s)
    law = catalogue_entry(VELOCITY_CONTROLLERS, controller)(**numbers)
    return lambda _: velocity_tracking(
        setup,
        law,
        reference,
        offset_K,
        name=controller,
        filter_s=assessment.filter_s,
        assess=lambda clipped_share: {"lead_in_s": lead_in_s} | assessment.to_json(clipped_share),
    )
