"""Tracking on a rig with a model from a file. Reference, controller and offset are checked before any
current flows."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from smarig.app.loop_model import ClosedLoop, ModelSource, check_arguments, check_path, controller_model_for
from smarig.app.velocity_loop import checked_offset, refuse_offset, velocity_factory, velocity_reference
from smarig.config import RigFile
from smarig.control import (
    REFERENCE_SHAPES,
    TRACKING_CONTROLLERS,
    VELOCITY_CONTROLLERS,
    ControllerModel,
    Reference,
    controller_factory,
    controller_numbers,
    finite_number,
    reference,
    reference_from_csv,
)
from smarig.control import track as tracking_protocol
from smarig.core import UsageError, catalogue_names, is_file, offered_names, resolve_name, suggestion
from smarig.runner import ProtocolFactory

ONLY_SHAPES = (
    "Settings of a reference apply to steps, ramps and multisine only. Leave them out for a file or values."
)
LEAST_TICKS = 10  # least length of a reference: fewer samples say nothing about a loop
_DEFAULT_RANGE_SHARES = (0.2, 0.8)  # of the reach: range of a reference by default
_REFERENCE_SETTINGS = ("low", "high", "seconds", "every_s", "speed", "seed")


def tracking(
    source: ModelSource,
    rig: RigFile,
    wanted: str | ArrayLike | Reference,
    settings: Mapping[str, Any] | None = None,
    controller: str = "inverse",
    numbers: Mapping[str, Any] | None = None,
    offset_K: float | None = None,
) -> ClosedLoop:
    """The closed loop that tracks a reference: steps, ramps or multisine with ``settings``, a CSV file, or values.

    ``controller`` is a name, also of a plug-in, or the path of an own file; both are executed. A velocity controller
    follows the reference's velocity alone and takes ``offset_K``, u_o of Thm 8.2. Raises UsageError for arguments that
    do not suit each other.
    """
    check_arguments(controller, numbers)
    controller_model = controller_model_for(source.model, rig)
    if controller not in catalogue_names(VELOCITY_CONTROLLERS):  # a plug-in does not replace one of them
        controller = resolve_name(TRACKING_CONTROLLERS, controller)
    package = _controller_package(controller)
    pairs = controller_numbers(package, controller, numbers or {})
    followed = _reference(wanted, settings or {}, controller_model, source.model.unit)
    _check_length(followed, rig.period_s)
    _check_reach(followed, controller_model, source.model.unit)
    velocity_numbers: dict[str, float] = {}
    if package == VELOCITY_CONTROLLERS:
        velocity_numbers = {"offset_K": checked_offset(offset_K, controller_model.setup)}
        given_s, followed = followed.duration_s, velocity_reference(followed, controller, **velocity_numbers)
        velocity_numbers["lead_in_s"] = followed.duration_s - given_s
    else:
        refuse_offset(offset_K, controller)
    recorded_settings = {
        **source.settings(),
        "reference": followed.name,
        **(settings or {}),
        "controller": controller,
        **velocity_numbers,
    }
    for key in pairs:
        if key in recorded_settings or key in _REFERENCE_SETTINGS:
            raise UsageError(
                f"Controller '{controller}': '{key}' has another meaning in the record. Rename this parameter."
            )
    if package == VELOCITY_CONTROLLERS:
        make = velocity_factory(
            source.model, controller_model.setup, controller, pairs, followed, **velocity_numbers
        )
    else:
        make = _position_factory(controller_model, controller, pairs, followed)
    return ClosedLoop("track", make, recorded_settings | pairs)


def _position_factory(
    controller_model: ControllerModel, controller: str, pairs: Mapping[str, float], followed: Reference
) -> ProtocolFactory:
    factory = controller_factory(controller, pairs)
    return lambda _: tracking_protocol(controller_model, factory, followed, name=controller)


def _controller_package(controller: str) -> str:
    """The catalogue that holds a controller: that of the position (with own files) or that of the velocity."""
    known = {package: catalogue_names(package) for package in (TRACKING_CONTROLLERS, VELOCITY_CONTROLLERS)}
    for package, there in known.items():
        if controller in there:
            return package
    names = [name for there in known.values() for name in there]
    raise UsageError(
        f"No controller '{controller}'{suggestion(controller, [*names, *offered_names(TRACKING_CONTROLLERS)])}."
    )


def _reference(
    wanted: str | ArrayLike | Reference,
    settings: Mapping[str, Any],
    controller_model: ControllerModel,
    unit: str,
) -> Reference:
    if not isinstance(wanted, str | Path):
        if settings:
            raise UsageError(ONLY_SHAPES)
        return wanted if isinstance(wanted, Reference) else _of_rows(wanted)
    check_path("The reference", wanted)
    if wanted not in REFERENCE_SHAPES:
        if not Path(wanted).suffix and not is_file(Path(wanted)):
            raise UsageError(
                f"No reference '{wanted}'{suggestion(wanted, list(REFERENCE_SHAPES))}, or a CSV file with time_s and "
                f"position_{unit}."
            )
        if settings:
            raise UsageError(ONLY_SHAPES)
        return reference_from_csv(Path(wanted), unit)
    for key in settings:
        if key not in _REFERENCE_SETTINGS:
            raise UsageError(
                f"A reference has no setting '{key}'{suggestion(key, list(_REFERENCE_SETTINGS))}."
            )
    low, high = controller_model.reach
    settings = dict(settings)
    seed = {"seed": _whole_seed(settings.pop("seed"))} if "seed" in settings else {}
    values: dict[str, Any] = {
        "low": low + _DEFAULT_RANGE_SHARES[0] * (high - low),
        "high": low + _DEFAULT_RANGE_SHARES[1] * (high - low),
    } | {key: finite_number(f"The reference's {key}", value) for key, value in settings.items()}
    return reference(wanted, values.pop("low"), values.pop("high"), **values, **seed)


def _of_rows(rows: ArrayLike) -> Reference:
    """The reference of times and positions, (2, n)."""
    try:
        numbers = np.asarray(rows, dtype=float)
    except (TypeError, ValueError):
        numbers = np.empty(0)
    if numbers.ndim != 2 or numbers.shape[0] != 2:
        raise UsageError(
            "A reference is the name of a shape, a CSV file, or two rows of numbers: times in s from 0, and positions; "
            f"got {rows!r:.40}."
        )
    return Reference("array", tuple(map(float, numbers[0])), tuple(map(float, numbers[1])))


def _whole_seed(seed: Any) -> int:
    """A seed as typed."""
    try:
        found = float(seed)
    except (TypeError, ValueError, OverflowError):
        found = -1.0
    if not 0 <= found <= 2**53 or found != int(found):
        raise UsageError(f"The reference's seed must be a whole number from 0 to 2^53 (given: {seed}).")
    return int(found)


def _check_length(followed: Reference, period_s: float) -> None:
    if followed.duration_s < LEAST_TICKS * period_s:
        raise UsageError(
            f"The reference lasts {followed.duration_s:g} s. It must last at least {LEAST_TICKS} "
            "samples, "
            f"{LEAST_TICKS * period_s:g} s on this rig."
        )


def _check_reach(followed: Reference, controller_model: ControllerModel, unit: str) -> None:
    low, high = controller_model.reach
    count = controller_model.position_per_count
    least, most = min(followed.position), max(followed.position)
    if not low - count <= least <= most <= high + count:
        raise UsageError(
            f"The reference goes from {least:.4g} to {most:.4g} {unit}. This model on this rig reaches from {low:.4g} "
            f"to {high:.4g} {unit}, counted from the encoder's zero."
        )
