"""The watchdog task of NI-DAQmx as the lease of an output, on devices that have one. Untested on hardware."""

from typing import Any

from smarig.core import ConfigError
from smarig.device.drivers._ni import close_task, ni_errors, ni_package
from smarig.device.encoding.link_faults import Silent


class NiWatchdog:
    """Sets one analogue output to 0 V when ``feed`` was not called for ``timeout_s``."""

    def __init__(self, device: str, channel: str, timeout_s: float) -> None:
        self._device, self._channel, self._timeout_s = device, channel, timeout_s
        self._task: Any = None

    def start(self) -> None:
        """Start, or start again after it has expired, and read it back. Raises ConfigError if there is none."""
        ni = ni_package()
        self.close()
        try:
            with ni_errors(self._device):
                self._task = ni.system.WatchdogTask(self._device, timeout=self._timeout_s)
                if self._task.expired:
                    self._task.clear_expiration()
                state = ni.types.AOExpirationState(
                    physical_channel=self._channel,
                    expiration_state=0.0,
                    output_type=ni.constants.WatchdogAOExpirState.VOLTAGE,
                )
                self._task.cfg_watchdog_ao_expir_states([state])
                self._task.start()
                found_s, expired = self._task.timeout, self._task.expired
        except Silent as fault:
            self.close()
            raise ConfigError(
                f"{self._device} has no watchdog for its analogue output. Give watchdog = false in the settings of "
                f"the output: the rig then has no lease and takes lower limits. NI-DAQmx says: {fault}"
            ) from None
        if expired or abs(found_s - self._timeout_s) > 0.01 * self._timeout_s:
            self.close()
            raise ConfigError(
                f"The watchdog of {self._device} does not keep {self._timeout_s:g} s: it has {found_s:g} s."
            )

    def feed(self) -> None:
        """Restart its time."""
        if self._task is not None:
            with ni_errors(self._device):
                self._task.reset_timer()

    def expired(self) -> bool:
        """Whether it has acted."""
        if self._task is None:
            return False
        with ni_errors(self._device):
            return bool(self._task.expired)

    def close(self) -> None:
        """Stop it. Never raises."""
        if self._task is not None:
            close_task(self._task)
        self._task = None
