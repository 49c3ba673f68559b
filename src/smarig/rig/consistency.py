"""Checks a bench's rig file before any device is opened: its parts against each other and against the devices."""

from collections.abc import Iterator

from smarig.config import LinksFile, ProtectionFile, RigFile
from smarig.core import (
    ConfigError,
    DataError,
    UsageError,
    catalogue_names,
    offered_names,
    resolve_name,
    suggestion,
)
from smarig.device import ATTEMPTS, load_register_map, no_scheme_text
from smarig.plant import Actuator, load_of, stress_of_phases_MPa
from smarig.rig.stress_limit import stress_limit

DRIVERS = "smarig.device.drivers"
SIMULATED = {  # links whose devices [simulator] starts
    "reference": ("amplifier", "encoder_daq"),
    "labjack": tuple(LinksFile.model_fields),  # one box serves all roles
    "supply": tuple(LinksFile.model_fields),  # and a meter for each other role
    "text": ("amplifier", "encoder_daq"),  # one instrument serves both
}
PLACEHOLDER = "REPLACE"  # in the addresses of the templates
_OTHER_ADDRESSES = ("labjack_", "ni_", "visa_")  # drivers whose addresses have a form of their own
OVER_CURRENT = 1.05  # of the largest current; above it the amplifier trips by itself


def inconsistencies(file: RigFile) -> list[str]:
    """The inconsistencies, one sentence each; none for a twin."""
    try:
        actuator = Actuator.named(file.actuator)  # once: reading it takes longer than all the checks
    except ConfigError as wrong:
        return [str(wrong)]
    found = [*_stress(file, actuator), *_load(file, actuator)]
    if file.links is None or file.protection is None:
        return found
    return [*found, *_links(file, file.links), *_protection(file, actuator, file.protection)]


def _stress(file: RigFile, actuator: Actuator) -> Iterator[str]:
    try:
        stress_limit(file, actuator)
    except ConfigError as wrong:
        yield str(wrong)
    hardware = file.kind == "bench" and file.simulator is None
    if hardware and actuator.two_wire and file.limits.stress_max_MPa is None:
        yield (
            "limits.stress_max_MPa is missing: two wires that are both hot would pull with up to "
            f"{stress_of_phases_MPa(2.0):.0f} MPa. Set it, for example to 300."
        )


def _load(file: RigFile, actuator: Actuator) -> Iterator[str]:
    try:
        load_of(file, actuator)
    except (ConfigError, DataError, UsageError) as wrong:
        yield str(wrong)


def _links(file: RigFile, links: LinksFile) -> Iterator[str]:
    simulated = _simulated_devices(file)
    given = {name: getattr(links, name) for name in LinksFile.model_fields}
    for device, link in ((name, link) for name, link in given.items() if link is not None):
        try:
            driver = resolve_name(DRIVERS, link.driver)
        except UsageError as wrong:
            yield f"links.{device}.driver: {wrong}"
            continue
        if driver not in (known := catalogue_names(DRIVERS)):
            known = sorted({*known, *offered_names(DRIVERS)})
            yield f"links.{device}.driver: no driver '{driver}'{suggestion(driver, known)}."
        if not link.url and device not in simulated:
            yield f"links.{device}.url is missing. Give the port or address of the device."
        if PLACEHOLDER in link.url:
            yield f"links.{device}.url is the placeholder of the template. Give the port or address of the device."
        wrong = no_scheme_text(link.url)
        if wrong and not link.driver.startswith(_OTHER_ADDRESSES):
            yield f"links.{device}.url = {wrong}"
    yield from _shared_port(links)
    if not links.amplifier.driver.endswith(".py"):  # an own driver tells when it is opened
        yield from _timeout(file, links)
    if links.amplifier.driver == "smarig_amplifier":
        lease = load_register_map("amplifier")["lease"]
        low, high = (lease.value.decode(raw) for raw in lease.limits)
        if not low <= file.lease_s <= high:
            yield f"lease_s = {file.lease_s:g} is outside {low:g}…{high:g} s, the range of the amplifier."


def _timeout(file: RigFile, links: LinksFile) -> Iterator[str]:
    timeout_s = links.amplifier.timeout_s
    if file.simulator is None and ATTEMPTS * timeout_s > file.lease_s:
        yield (
            f"links.amplifier.timeout_s = {timeout_s:g}: {ATTEMPTS} attempts take {ATTEMPTS * timeout_s:g} s, "
            f"longer than lease_s = {file.lease_s:g}, so the amplifier would trip before a lost reply is repeated."
        )


def check_lease(file: RigFile, links: LinksFile) -> None:
    """Raise ConfigError if the lease of a source that has one, as was seen when it was opened, is too short."""
    for problem in (file.period_problem, *_timeout(file, links)):
        if problem:
            raise ConfigError(f"Rig '{file.name}': {problem}")


def _simulated_devices(file: RigFile) -> tuple[str, ...]:
    """The links that need no url, because the command starts their devices."""
    simulator = file.simulator
    return SIMULATED[simulator.devices] if simulator is not None and simulator.start else ()


def _shared_port(links: LinksFile) -> Iterator[str]:
    """Two devices of the reference protocol on one serial port differ by their addresses, which only Modbus RTU has.

    An instrument of another kind may serve both roles by itself.
    """
    a, b = links.amplifier, links.encoder_daq
    if not {a.driver, b.driver} & {"smarig_amplifier", "smarig_encoder_daq"}:
        return
    if not a.url or a.url != b.url or "modbus_tcp" in (a.framing, b.framing):
        return
    if a.framing != "modbus_rtu" or b.framing != "modbus_rtu":
        yield f'Both links use {a.url}. Devices on one port need framing = "modbus_rtu", which has addresses.'
    elif a.baud != b.baud:
        yield f"Both links use {a.url}, at {a.baud} and at {b.baud} baud. Give both the same baud."
    elif a.serial_format != b.serial_format:
        yield (
            f"Both links use {a.url}, as {a.serial_format} and as {b.serial_format}. Give both the same serial_format."
        )
    elif a.address and a.address == b.address:
        yield f"Both links use {a.url} and address {a.address}. Give each device its own address."


def _protection(file: RigFile, actuator: Actuator, p: ProtectionFile) -> Iterator[str]:
    limits = file.limits
    largest_A = max(limits.current_max_A, -limits.current_min_A)
    if p.slew_max_A_per_s < limits.current_rate_A_per_s:
        yield (
            f"protection.slew_max_A_per_s = {p.slew_max_A_per_s:g} is below limits.current_rate_A_per_s = "
            f"{limits.current_rate_A_per_s:g}: the amplifier would trip at rates that the host may command."
        )
    low, high = actuator.resistance_range_ohm
    if not p.resistance_min_ohm < low <= high < p.resistance_max_ohm:
        yield (
            f"protection.resistance_min_ohm … max_ohm = {p.resistance_min_ohm:g} … {p.resistance_max_ohm:g} do not "
            f"contain the wire's {low:g} … {high:g} ohm."
        )
    steady = largest_A**2 * p.heat_settle_s
    if not steady < p.heat_max_A2s < OVER_CURRENT**2 * steady:
        yield (
            f"protection.heat_max_A2s = {p.heat_max_A2s:g} should be between {steady:g} (a steady {largest_A:g} A) "
            f"and {OVER_CURRENT**2 * steady:.4g} (over-current trips first): a lower limit trips in normal use, a "
            "higher one never trips."
        )
