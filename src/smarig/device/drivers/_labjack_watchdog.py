"""The watchdog of a LabJack as the lease of its output: a silent host, and the DAC goes to 0 V.

It counts whole seconds since the last request of any program. Its registers are flash, so they are read first and
written only if one differs. It stays armed when the host leaves: a DAC that is at 0 V is set to 0 V again.
"""

from smarig.core import ConfigError
from smarig.device.drivers import _labjack_registers as reg
from smarig.device.drivers._labjack import LabJack
from smarig.device.encoding.link_faults import Garbled

LEAST_S, MOST_S = 1, 60


def whole_seconds(lease_s: float) -> int:
    """The lease as the watchdog counts it. Raises ConfigError if it cannot."""
    if lease_s != round(lease_s) or not LEAST_S <= lease_s <= MOST_S:
        nearest = min(max(round(lease_s), LEAST_S), MOST_S)
        raise ConfigError(
            f"lease_s = {lease_s:g}: the watchdog of a LabJack counts whole seconds from {LEAST_S} to {MOST_S}. Give "
            f"lease_s = {nearest}."
        )
    return int(lease_s)


def arm_watchdog(box: LabJack, dac: int, timeout_s: int) -> None:
    """Let the watchdog set the DAC to 0 V, and read it back. Raises Garbled if the box does not keep the settings."""
    if _armed(box, dac, timeout_s):
        return
    box.write_whole(reg.WATCHDOG_ENABLE, 0)  # LabJack: disable before any other change
    for at, value in _settings(dac, timeout_s).items():
        if box.whole(at) != value:
            box.write_whole(at, value)
    box.write_number(reg.WATCHDOG_DAC + 10 * dac, 0.0)
    box.write_whole(reg.WATCHDOG_ENABLE, 1)
    if not _armed(box, dac, timeout_s):
        raise Garbled(
            f"The LabJack at {box.where} does not keep the settings of its watchdog. Check its firmware, or give "
            "watchdog = false in the settings of the output: the rig then has no lease and takes lower limits."
        )


def _armed(box: LabJack, dac: int, timeout_s: int) -> bool:
    wanted = {**_settings(dac, timeout_s), reg.WATCHDOG_ENABLE: 1}
    return all(box.whole(at) == value for at, value in wanted.items()) and (
        box.number(reg.WATCHDOG_DAC + 10 * dac) == 0.0
    )


def _settings(dac: int, timeout_s: int) -> dict[int, int]:
    return {
        reg.WATCHDOG_TIMEOUT_S: timeout_s,
        reg.WATCHDOG_STRICT_ENABLE: 0,
        reg.WATCHDOG_RESET_ENABLE: 0,
        reg.WATCHDOG_DAC_ENABLE + 10 * dac: 1,
    }
