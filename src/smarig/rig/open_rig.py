"""Opens the rig of a rig file: the twin in process, or a bench on the instruments of its links.

With a ``[simulator]`` table it starts the simulated devices in a process of their own, which ends with this one.
"""

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from smarig.config import LinkFile, LinksFile, LoadFile, RigFile, SimulatorFile
from smarig.core import (
    AT_ZERO,
    HeldSignals,
    Interrupted,
    RigFault,
    SmarigError,
    StorageError,
    UsageError,
    at_forced_end,
    catalogue_entry,
    catalogue_names,
    passed,
    resolve_name,
)
from smarig.device import (
    TemperatureInput,
    as_current_source,
    as_force_input,
    as_position_sensor,
    as_temperature_input,
)
from smarig.plant import EFFECTS, Actuator, Effect, effects_to_arguments
from smarig.rig.bench import Bench
from smarig.rig.consistency import DRIVERS, check_lease
from smarig.rig.further_sensors import FurtherSensors
from smarig.rig.paced_rig import PacedRig
from smarig.rig.rig import Rig
from smarig.rig.shutdown import after_shutdown, confirm_zero, switch_off
from smarig.rig.simulator_process import running_devices
from smarig.rig.twin import Twin, TwinSettings

_NOT_ZEROED = "Make sure that no current flows: its source did not answer."
LOCK_STEP_S = 5.0  # reply time of simulated devices that lose no reply: a busy machine delays them
HOST_TIMEOUT_S = 60.0  # time that they wait for a delayed host; they detect its end at once


@contextmanager
def open_rig(
    rig: str,
    file: RigFile,
    actuator: Actuator,
    settings: TwinSettings,
    *,
    speed: float | None = None,
    while_waiting: Callable[[], None] = lambda: None,
    report: Callable[[str], None] = lambda _: None,
    recorded: bool = True,
) -> Iterator[Rig]:
    """A rig that is safe and closed afterwards. ``settings`` are those of a twin or of simulated devices. ``report``
    gets the sentence about a rig that does not confirm that it is off, at once. ``recorded``: whether there are data.

    If ``settings`` contain the hysteresis of a model, the rig is a twin in process.
    """
    with contextlib.ExitStack() as open_:
        signals = open_.enter_context(HeldSignals())
        if file.kind == "twin" or settings.hysteresis is not None:  # a model replaces the hardware
            twin = Twin(file, actuator, settings)
            found: Rig = PacedRig(twin, speed, while_waiting=while_waiting) if speed else twin
        else:
            links, pace = required_links(file), 1.0
            if file.simulator is not None:
                pace = file.simulator.speed if speed is None else speed
            if file.simulator is not None and file.simulator.start:
                links = open_.enter_context(
                    started_simulator(rig, file.simulator, links, settings, pace, file.load, while_waiting)
                )
            found = _open_bench(file, actuator, links, pace, open_)
        open_.callback(found.close)
        with (
            at_forced_end(lambda: _zeroed(found), _NOT_ZEROED, zeroes=True),
            _confirmed_shutdown(found, signals, report, recorded=recorded),
        ):
            yield found


def _zeroed(rig: Rig) -> str:
    """Set the current to zero for a process that is ended by force, and say so."""
    rig.safe()
    confirm_zero(rig)
    return rig.shutdown_unconfirmed or AT_ZERO


@contextmanager
def _confirmed_shutdown(
    rig: Rig, signals: HeldSignals, report: Callable[[str], None] = lambda _: None, *, recorded: bool = True
) -> Iterator[None]:
    """Set the current to zero at every exit. A fault of the rig or of the disk says what became of
    it; so does every error, if it may still flow.

    A second Ctrl-C neither cuts the end off nor takes its words away.
    """
    try:
        yield
    except BaseException as error:
        signals.hold()
        switch_off(rig, report=report)
        if rig.shutdown_unconfirmed and isinstance(error, Interrupted | KeyboardInterrupt):
            how = str(error) or "interrupted by the keyboard (Ctrl-C)"
            ended = f"Run {how}. Its file is closed." if recorded else f"It was {how}."
            raise RigFault(f"{ended} {rig.shutdown_unconfirmed}") from None
        if isinstance(error, RigFault | StorageError) or (
            rig.shutdown_unconfirmed and isinstance(error, SmarigError)
        ):
            after_shutdown(error, rig)
        raise
    signals.hold()
    switch_off(rig, report=report)
    if rig.shutdown_unconfirmed:
        raise RigFault(f"{rig.shutdown_unconfirmed}{' The recorded data are complete.' if recorded else ''}")


def required_links(file: RigFile) -> LinksFile:
    """The links of a bench. Raises UsageError for a rig without any."""
    if file.links is None:
        raise UsageError(f"Rig '{file.name}' has no table [links]. Its devices require it.")
    return file.links


def _open_bench(
    file: RigFile, actuator: Actuator, links: LinksFile, speed: float, open_: contextlib.ExitStack
) -> Bench:
    source = as_current_source(_open_instrument(links.amplifier, file, open_), links.amplifier.driver, file)
    if source.has_lease:
        check_lease(file, links)
    sensor = as_position_sensor(
        _open_instrument(links.encoder_daq, file, open_), links.encoder_daq.driver, file
    )
    return Bench(file, actuator, source, sensor, _further_sensors(links, file, open_), speed=speed)


def instrument_of(link: LinkFile, file: RigFile) -> Any:
    """What the driver of a link returns; the driver may be an own file."""
    return catalogue_entry(DRIVERS, resolve_name(DRIVERS, link.driver))(link, file)


def _open_instrument(link: LinkFile, file: RigFile, open_: contextlib.ExitStack) -> Any:
    """An instrument made by its driver; closed at the end."""
    instrument = instrument_of(link, file)
    open_.callback(getattr(instrument, "close", lambda: None))
    return instrument


def _further_sensors(links: LinksFile, file: RigFile, open_: contextlib.ExitStack) -> FurtherSensors:
    """The thermometers and the load cell that the rig file names."""

    def thermometer(link: LinkFile | None) -> TemperatureInput | None:
        return as_temperature_input(_open_instrument(link, file, open_), link.driver) if link else None

    cell = links.load_cell
    return FurtherSensors(
        wire=thermometer(links.thermometer),
        room=thermometer(links.room_thermometer),
        load_cell=as_force_input(_open_instrument(cell, file, open_), cell.driver) if cell else None,
    )


@contextmanager
def started_simulator(
    rig: str,
    how: SimulatorFile,
    links: LinksFile,
    settings: TwinSettings,
    speed: float,
    load: LoadFile | None,
    while_waiting: Callable[[], None] = lambda: None,
) -> Iterator[LinksFile]:
    """The links of the devices while they run. They detect the end of this process at the end of their input.

    ``while_waiting`` may raise, so that a stop does not wait for their start.
    """
    if settings.initial is not None or not settings.noise:
        raise UsageError(
            "Simulated devices follow the rig file. For another initial state, or no noise, use a rig with kind = "
            '"twin".'
        )
    with_type = [effect for effect in settings.effects if isinstance(effect, Effect)]
    if len(with_type) < len(settings.effects) or any(
        e.kind.name not in catalogue_names(EFFECTS) for e in with_type
    ):
        raise UsageError("Simulated devices accept only effects of the catalogue.")
    if how.make and how.devices != "supply":
        raise UsageError("simulator.make is the make of a supply. Omit it for other simulated devices.")
    is_reference = how.devices == "reference"
    specific = _reference_command(how, links, speed) if is_reference else _timed_command(how, speed)
    effects = [word for pair in effects_to_arguments(with_type) for word in ("--effect", pair)]
    wire = ["--rig", rig, "--seed", str(settings.seed), *effects, *([f"--load={load.text}"] if load else [])]
    min_timeout_s = LOCK_STEP_S if not (speed or how.faults) else 0.0
    with tempfile.TemporaryDirectory(prefix="smarig-", ignore_cleanup_errors=True) as folder:
        specific += ["--folder", folder] if is_reference else []
        messages = Path(folder) / "messages"
        with running_devices(
            [*specific, *wire], messages, while_waiting, keep_until_lease=bool(how.trace)
        ) as urls:
            given = {name: link for name in LinksFile.model_fields if (link := getattr(links, name))}
            yield LinksFile(
                **{
                    name: _with_url(link, urls[name]["url"], min_timeout_s) if name in urls else link
                    for name, link in given.items()
                }
            )


def _timed_command(how: SimulatorFile, speed: float) -> list[str]:
    """Devices without ticks that could wait for the host follow the clock. Raises UsageError for options."""
    name, module = {
        "labjack": ("LabJack", "simulators.labjack"),
        "supply": ("supply", "simulators.supply_bench"),
        "text": ("text instrument", "simulators.text_bench"),
    }[how.devices]
    unknown = [key for key in ("faults", "library", "trace") if getattr(how, key)]
    if unknown or not speed:
        wrong = f"no simulator.{unknown[0]}" if unknown else "no lock-step; give simulator.speed above 0"
        raise UsageError(f"The simulated {name} has {wrong}.")
    return [module, "--speed", str(speed), *(["--make", how.make] if how.make else [])]


def _reference_command(how: SimulatorFile, links: LinksFile, speed: float) -> list[str]:
    """The devices of firmware_protocol."""
    if links.amplifier.framing != links.encoder_daq.framing:
        raise UsageError("Simulated devices use one framing. Give both links the same framing.")
    pace = ["--speed", str(speed)] if speed else ["--lock-step", "--gone-after", str(HOST_TIMEOUT_S)]
    files = {"--faults": how.faults, "--device-library": how.library, "--trace": how.trace}
    extra = [word for option, path in files.items() if path for word in (option, passed(path))]
    if how.trace and os.path.lexists(how.trace):
        raise UsageError(
            f"simulator.trace names {how.trace}, which exists and is not overwritten. Name a new file, or move it."
        )
    return ["simulators", "--framing", links.amplifier.framing, *pace, *extra]


def _with_url(link: LinkFile, url: str, min_timeout_s: float) -> LinkFile:
    return link.model_copy(update={"url": url, "timeout_s": max(link.timeout_s, min_timeout_s)})
