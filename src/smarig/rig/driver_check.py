"""Checks the driver of a rig's link against the contract of its role, on the device itself or on a simulated one."""

import contextlib
import time
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlsplit

from smarig.config import LinkFile, RigFile, SimulatorFile
from smarig.core import UsageError
from smarig.device import (
    Check,
    ContractCase,
    Role,
    as_current_source,
    as_force_input,
    as_position_sensor,
    as_temperature_input,
    check_contract,
)
from smarig.rig.open_rig import instrument_of, required_links, started_simulator
from smarig.rig.specimen import TwinSettings

SIMULATED_DRIVERS = {  # of [simulator].devices: how the names of their drivers begin, and a rig that has them
    "reference": ("smarig_", "one_wire_serial"),
    "labjack": ("labjack_", "labjack_one_wire"),
    "supply": ("visa_", "laboratory_supply"),
}
SIMULATED_SPEED = 10.0  # of simulated devices, in device seconds per second


def rig_for_check(file: RigFile, role: Role, driver: str = "", url: str = "") -> RigFile:
    """The rig file with this driver and this address. A device at an address of its own is in its own time, not in that
    of devices which the rig file would start.

    Raises UsageError if the rig has no such device.
    """
    links, simulator = required_links(file), file.simulator
    if getattr(links, role) is None and not driver:
        raise UsageError(f"Rig '{file.name}' has no link {role}. Give --driver and --url.")
    changed = {key: value for key, value in (("driver", driver), ("url", url)) if value}
    link = (getattr(links, role) or links.encoder_daq).model_copy(update=changed)
    if url and simulator is not None and simulator.start:
        simulator = None
    return file.model_copy(update={"links": links.model_copy(update={role: link}), "simulator": simulator})


def check_driver(rig: str, file: RigFile, role: Role, driver: str = "", url: str = "") -> Iterator[Check]:
    """Check the device of a role of a rig. ``driver`` and ``url`` replace those of the rig file.

    Raises UsageError if the rig has no such device, and what the driver raises if it cannot open it. The output is at
    zero afterwards.
    """
    with contextlib.ExitStack() as open_:
        file = rig_for_check(file, role, driver, url)
        links, speed = required_links(file), 1.0
        simulator = file.simulator
        if simulator is not None:
            speed = simulator.speed or SIMULATED_SPEED
            if simulator.start:
                _refuse_other_devices(file, simulator, driver)
                links = open_.enter_context(
                    started_simulator(rig, simulator, links, TwinSettings(), speed, file.load)
                )
            file = file.model_copy(update={"simulator": simulator.model_copy(update={"speed": speed})})
        link = getattr(links, role)
        case = ContractCase(
            open=lambda: in_role(role, link, file),
            open_absent=lambda: in_role(role, _without_device(link), file),
            rig=file,
            wait=lambda seconds: time.sleep(seconds / speed),
            clock=lambda: time.monotonic() * speed,
        )
        with case.opened():
            pass  # a device that is not there is one error, not a list of broken requirements
        yield from check_contract(role, case)


def _refuse_other_devices(file: RigFile, simulator: SimulatorFile, driver: str) -> None:
    """Raise UsageError for a shipped driver whose device the rig does not simulate."""
    devices = next((d for d, (prefix, _) in SIMULATED_DRIVERS.items() if driver.startswith(prefix)), None)
    if devices is not None and devices != simulator.devices:
        raise UsageError(
            f"Rig '{file.name}' simulates no device for the driver '{driver}'. Name a rig that does, such as "
            f"{SIMULATED_DRIVERS[devices][1]}, or a rig file of yours; or give --url."
        )


def in_role(role: Role, link: LinkFile, file: RigFile) -> Any:
    """The instrument of a link, opened in a role. Raises ConfigError if it lacks members."""
    instrument = instrument_of(link, file)
    try:
        if role == "amplifier":
            return as_current_source(instrument, link.driver, file)
        if role == "encoder_daq":
            return as_position_sensor(instrument, link.driver, file)
        if role == "load_cell":
            return as_force_input(instrument, link.driver)
        return as_temperature_input(instrument, link.driver)
    except BaseException:
        getattr(instrument, "close", lambda: None)()
        raise


def _without_device(link: LinkFile) -> LinkFile:
    """The same link at an address where there is no device."""
    parts = urlsplit(link.url)
    if parts.scheme and parts.port:
        url = link.url.replace(f":{parts.port}", ":1")
    elif "::" in link.url:  # a VISA resource
        url = _absent_visa(link.url)
    else:
        url = f"{link.url}.absent"
    return link.model_copy(update={"url": url, "timeout_s": min(link.timeout_s, 0.3)})


def _absent_visa(resource: str) -> str:
    """A VISA address of no device: of the same interface if it is a serial port or the network, else of the network."""
    interface = resource.split("::")[0]
    if not interface.upper().startswith("ASRL"):
        return f"{interface if interface.upper().startswith('TCPIP') else 'TCPIP0'}::192.0.2.1::9::SOCKET"
    return "ASRL255::INSTR" if interface[4:].isdigit() else f"{interface}.absent::INSTR"
