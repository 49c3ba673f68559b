"""Velocity feedback by a model from a file: what may be asked of it, and the loop with its certificate (Thm 8.2)."""

from collections.abc import Mapping
from typing import Any

from smarig.certify import RigAssessment, Units, certificate
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
    """u_o in kelvin, 0 where none is given; UsageError for what is none on this rig."""
    found = 0.0 if offset_K is None else finite_number("The offset u_o", offset_K)
    range_K = setup.upper_K - setup.lower_K
    if abs(found) > range_K:
        raise UsageError(
            f"An offset u_o of {found:g} K is more than this rig's whole range, {range_K:.4g} K; give a smaller one."
        )
    return found


def refuse_offset(offset_K: Any, controller: str) -> None:
    """UsageError for an offset that a position loop would ignore."""
    if offset_K is not None:
        names = ", ".join(catalogue_names(VELOCITY_CONTROLLERS))
        raise UsageError(
            f"An offset u_o belongs to velocity controllers ({names}); '{controller}' feeds back "
            "the position."
        )


def velocity_reference(reference: Reference, controller: str, offset_K: float) -> Reference:
    """A reference with a velocity, from the encoder's zero on; UsageError where it has none."""
    if reference.held:
        raise UsageError(
            f"'{controller}' feeds back the velocity, and that of steps is infinite where they jump: give ramps, "
            "multisine or a CSV file."
        )
    led = with_lead_in(reference)
    if not any(led.position) and not offset_K:
        raise UsageError(
            f"Reference {reference.name} never moves and there is no offset u_o: nothing drives a loop that feeds back "
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
    """The loop as a protocol; what Thm 8.2 says of model and controller stands in its record.

    ``lead_in_s``: how much of the reference leads to its first position, for the record.
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
