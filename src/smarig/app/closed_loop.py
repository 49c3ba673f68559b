"""Closed loops on a rig by a model from a file: what may be asked is checked here, before anything flows.

Puts model, rig file and ``smarig.control`` together; the session runs what comes out like any protocol. Refuses what
does not fit (arrangement, unit) and what is out of reach, each with a sentence.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.app.velocity_loop import checked_offset, refuse_offset, velocity_factory, velocity_reference
from smarig.config import RigFile, load_rig
from smarig.control.controller_settings import TRACKING, VELOCITY, controller_numbers, finite_number
from smarig.control.regulation import SetpointPI
from smarig.control.regulation import regulate as regulation_protocol
from smarig.control.regulation.regulation_protocol import START_STATES, check_times
from smarig.control.tracking import ControllerModel, Reference, reference
from smarig.control.tracking import track as tracking_protocol
from smarig.control.tracking.reference import SHAPES, from_csv
from smarig.control.tracking.tuning import controller_factory
from smarig.core.catalogue import names, resolve_name, suggestion
from smarig.core.errors import UsageError
from smarig.plant.actuator import Actuator
from smarig.plant.effect_catalogue import from_json
from smarig.protocols._setup import Setup
from smarig.record import Run, load_run
from smarig.replay import Model, load_model
from smarig.runner.preview import ProtocolFactory
from smarig.runner.session import Session

LEAST_COUNTS = 10  # of the encoder that a model must move: less is no motion that a loop could hold
LEAST_TICKS = 10  # that a reference lasts: fewer samples tell nothing of a loop
_DEFAULT_RANGE_SHARES = (0.2, 0.8)  # of the reach: where references stay unless told otherwise
_REFERENCE_SETTINGS = ("low", "high", "seconds", "every_s", "speed", "seed")
REGULATORS = {"pi": ("gain", "band")}


@dataclass(frozen=True)
class ModelSource:
    """A model with the file it came from, and that file's hash: what a record says of it."""

    model: Model
    name: str
    sha256: str

    @classmethod
    def of(cls, path: str | Path) -> "ModelSource":
        """Read and hash a model file; errors of ``load_model``."""
        _check_path("The model", path)
        model = load_model(path)
        model.check_classical("A loop or its certificate")
        return cls(model, Path(path).name, hashlib.sha256(Path(path).read_bytes()).hexdigest())

    def settings(self) -> dict[str, str]:
        """For a record."""
        return {"model": self.name, "model_sha256": self.sha256}


@dataclass(frozen=True)
class ClosedLoop:
    """A closed loop ready to be run: its protocol's name, what makes it, and its settings for the record."""

    protocol: str
    make: ProtocolFactory
    settings: dict[str, Any]


def tracking(
    source: ModelSource,
    rig: RigFile,
    wanted: str,
    settings: Mapping[str, Any] | None = None,
    controller: str = "inverse",
    numbers: Mapping[str, Any] | None = None,
    offset_K: float | None = None,
) -> ClosedLoop:
    """Follow a reference: steps, ramps, multisine with ``settings``, or a CSV file. UsageError says what is wrong.

    ``controller`` is a name or the path of an own file, which is executed. One of the velocity controllers follows the
    reference's velocity alone, and takes ``offset_K``, u_o of Thm 8.2.
    """
    _check_arguments(controller, numbers)
    _check_path("The reference", wanted)
    controller_model = _controller_model(source.model, rig)
    controller = resolve_name(TRACKING, controller)
    package = _controller_package(controller)
    pairs = controller_numbers(package, controller, numbers or {})
    followed = _reference(wanted, settings or {}, controller_model, source.model.unit)
    _check_length(followed, rig.period_s)
    _check_reach(followed, controller_model, source.model.unit)
    velocity_numbers: dict[str, float] = {}
    if package == VELOCITY:
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
                f"Controller '{controller}': '{key}' means something else in the record; rename it."
            )
    if package == VELOCITY:
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
    """The catalogue a controller stands in: of positions, an own file's too, or of velocities."""
    known = {package: names(package) for package in (TRACKING, VELOCITY)}
    for package, there in known.items():
        if controller in there:
            return package
    raise UsageError(
        f"No controller '{controller}'{suggestion(controller, [*known[TRACKING], *known[VELOCITY]])}."
    )


def regulation(
    source: ModelSource,
    rig: RigFile,
    setpoint: float,
    *,
    within: float = 0.01,
    hold_s: float = 600.0,
    start: str = "diagonal",
    disturbance_K: float = 0.0,
    controller: str = "pi",
    numbers: Mapping[str, Any] | None = None,
) -> ClosedLoop:
    """Go to a state of the output ``setpoint`` (the model's scale) and hold it. UsageError says what is wrong."""
    _check_arguments(controller, numbers)
    model, controller_model = source.model, _controller_model(source.model, rig)
    setup = controller_model.setup
    low, high = (end + controller_model.origin for end in controller_model.reach)
    y = finite_number("The set-point", setpoint)
    count = setup.actuator.position_per_count(rig.encoder.counts_per_rev)
    if not low - count <= y <= high + count:
        raise UsageError(
            f"The set-point {y:g} {model.unit} is out of reach: this model on this rig reaches from {low:.4g} to "
            f"{high:.4g} {model.unit}."
        )
    y = min(max(y, low), high)  # a count is what the rig can tell apart
    if start not in START_STATES:
        raise UsageError(f"start is {', '.join(START_STATES)}, not '{start}'.")
    push_K, share = finite_number("The disturbance", disturbance_K), finite_number("within", within)
    _check_push(push_K, setup)
    check_times(setup, finite_number("hold_s", hold_s), push_K)
    loop = _regulator(controller, {"band": count / 2} | dict(numbers or {}), setup, model)
    recorded_settings = {
        "setpoint": y,
        "within": share,
        "hold_s": hold_s,
        "start": start,
        "disturbance_K": push_K,
    }

    def make(rig_setup: Setup):
        return regulation_protocol(
            rig_setup,
            hysteresis=model.hysteresis,
            setpoint=y,
            within=share,
            hold_s=float(hold_s),
            start=start,
            loop=loop,
            disturbance_K=push_K,
        )

    recorded_settings |= {"controller": controller, "gain": loop.gain, "band": loop.band}
    return ClosedLoop("regulate", make, source.settings() | recorded_settings)


def _controller_model(model: Model, rig: RigFile) -> ControllerModel:
    """What a controller will believe; UsageError where the model is not one of such a rig."""
    actuator = Actuator.named(rig.actuator)
    arrangement = actuator.file.arrangement
    if model.arrangement != arrangement:
        raise UsageError(
            f"Model {model.name} is of a {_arrangement_text(model.arrangement)} rig, '{rig.name}' is a "
            f"{_arrangement_text(arrangement)} one."
        )
    if model.unit != actuator.unit:
        raise UsageError(
            f"Model {model.name} speaks in {model.unit}, rig '{rig.name}' measures in {actuator.unit}."
        )
    if model.input.unit != "K":
        raise UsageError(
            f"Model {model.name} has an input in {model.input.unit or 'no unit'}; a rig is driven by kelvin above "
            "ambient."
        )
    setup = Setup(actuator, rig.limits, rig.period_s)
    controller_model = ControllerModel(
        setup, model.hysteresis, rig.encoder.counts_per_rev, from_json(model.effects)
    )
    _check_motion(controller_model, model)
    return controller_model


def _check_motion(controller_model: ControllerModel, model: Model) -> None:
    """UsageError where the output does not rise with the input by more than noise: these loops heat to raise it."""
    low, high = controller_model.reach
    setup = controller_model.setup
    limits = f"within this rig's limits, {setup.lower_K:.4g} to {setup.upper_K:.4g} K"
    least = LEAST_COUNTS * setup.actuator.position_per_count(controller_model.counts_per_rev)
    if low == high:
        raise UsageError(
            f"The output of model {model.name} does not move {limits}: no loop can be closed by it."
        )
    if abs(high - low) < least:
        raise UsageError(
            f"Model {model.name} moves by {abs(high - low):.3g} {model.unit} only {limits}: less than {LEAST_COUNTS} "
            f"counts of the encoder ({least:.3g} {model.unit}), which no loop can hold."
        )
    if high < low:
        raise UsageError(
            f"The output of model {model.name} falls as its input rises, by {low - high:.4g} {model.unit} {limits}: "
            "these loops hold an output that rises with the input."
        )


def _check_length(followed: Reference, period_s: float) -> None:
    if followed.duration_s < LEAST_TICKS * period_s:
        raise UsageError(
            f"The reference lasts {followed.duration_s:g} s: nothing can be measured in less than {LEAST_TICKS} "
            "samples, "
            f"{LEAST_TICKS * period_s:g} s on this rig."
        )


def _check_push(push_K: float, setup: Setup) -> None:
    range_K = setup.upper_K - setup.lower_K
    if abs(push_K) > range_K:
        raise UsageError(
            f"A disturbance of {push_K:g} K is more than this rig's whole range, {range_K:.4g} K; give a smaller one."
        )


def _check_arguments(controller: Any, numbers: Any) -> None:
    """UsageError for a notebook's slip: what is no name, and what is no mapping."""
    if not isinstance(controller, str | Path):
        raise UsageError(f"A controller is given by its name, not by {controller!r}.")
    if not isinstance(numbers, Mapping | None):
        raise UsageError(
            f"A controller's numbers are given by name, such as {{'gain': 2}}, not by {numbers!r}."
        )


def _check_path(what: str, source: Any) -> None:
    if not isinstance(source, str | Path):
        raise UsageError(f"{what} is given by a name or a path, not by {source!r}.")


def _arrangement_text(arrangement: str) -> str:
    return arrangement.replace("_", "-") or "nameless"


def _reference(
    wanted: str, settings: Mapping[str, Any], controller_model: ControllerModel, unit: str
) -> Reference:
    if wanted not in SHAPES:
        if not Path(wanted).suffix and not Path(wanted).is_file():
            raise UsageError(
                f"No reference '{wanted}'{suggestion(wanted, list(SHAPES))}, or a CSV file with time_s and "
                f"position_{unit}."
            )
        if settings:
            raise UsageError(
                "--set belongs to steps, ramps and multisine; a file says itself what is wanted."
            )
        return from_csv(Path(wanted), unit)
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


def _whole_seed(seed: Any) -> int:
    """A seed as typed."""
    try:
        found = float(seed)
    except (TypeError, ValueError, OverflowError):
        found = -1.0
    if not 0 <= found <= 2**53 or found != int(found):
        raise UsageError(f"The reference's seed is a whole number from 0 to 2^53 (given: {seed}).")
    return int(found)


def _check_reach(followed: Reference, controller_model: ControllerModel, unit: str) -> None:
    low, high = controller_model.reach
    count = controller_model.setup.actuator.position_per_count(controller_model.counts_per_rev)
    least, most = min(followed.position), max(followed.position)
    if not low - count <= least <= most <= high + count:
        raise UsageError(
            f"The reference goes from {least:.4g} to {most:.4g} {unit}: this model on this rig reaches from {low:.4g} "
            f"to {high:.4g} {unit}, counted from the encoder's zero."
        )


def _regulator(name: str, pairs: Mapping[str, Any], setup: Setup, model: Model) -> SetpointPI:
    """The loop that holds a set-point, its numbers in K per unit (gain) and units (band)."""
    if name not in REGULATORS:
        raise UsageError(
            f"No regulating controller '{name}'{suggestion(name, list(REGULATORS))}; "
            f"{', '.join(names(TRACKING))} track."
        )
    loop = SetpointPI.for_model(setup, model.hysteresis)
    for key, value in pairs.items():
        if key not in REGULATORS[name]:
            raise UsageError(
                f"Controller '{name}' has no number '{key}'{suggestion(key, list(REGULATORS[name]))}."
            )
        found = finite_number(f"Controller '{name}', {key}", value)
        if found < 0 or (found == 0 and key == "gain"):
            at_least = "must be positive" if key == "gain" else "must not be negative"
            raise UsageError(f"Controller '{name}': {key} {at_least} (given: {value}).")
        setattr(loop, key, found)
    return loop


# --- a notebook's way in ----------------------------------------------------------------------------------


def run_loop(
    loop: ClosedLoop, rig: str, out: str | Path, *, seed: int = 0, wire: str = "", force: bool = False
) -> Run:
    """Run a closed loop on a rig, record it, and return the run."""
    _check_path("The run", out)
    with Session(rig, seed=seed, wire=wire) as session:
        return load_run(
            session.run(loop.protocol, loop.settings, out, force=force, protocol_factory=loop.make)
        )


def track(
    model: str | Path,
    wanted: str,
    *,
    rig: str,
    out: str | Path,
    controller: str = "inverse",
    numbers: Mapping[str, Any] | None = None,
    offset_K: float | None = None,
    seed: int = 0,
    wire: str = "",
    force: bool = False,
    **settings: Any,
) -> Run:
    """Follow a reference (steps, ramps, multisine with its settings, or a CSV file) on a rig and return the run.

    ``controller`` is a name (``smarig list controllers``) or the path of an own file; ``numbers`` are the controller's,
    ``offset_K`` is u_o of a velocity controller.
    """
    loop = tracking(ModelSource.of(model), load_rig(rig), wanted, settings, controller, numbers, offset_K)
    return run_loop(loop, rig, out, seed=seed, wire=wire, force=force)


def regulate(
    model: str | Path,
    setpoint: float,
    *,
    rig: str,
    out: str | Path,
    seed: int = 0,
    wire: str = "",
    force: bool = False,
    **settings: Any,
) -> Run:
    """Bring a wire to a state of the wanted output, hold it there, and return the run; settings of ``regulation``."""
    loop = regulation(ModelSource.of(model), load_rig(rig), setpoint, **settings)
    return run_loop(loop, rig, out, seed=seed, wire=wire, force=force)
