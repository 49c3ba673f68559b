"""NI-DAQmx through the package ``nidaqmx``: its channels, and its errors as link faults. Untested on hardware.

Readings and outputs are software-timed (on demand): a task that is not started takes its hardware for one reading only,
so that several roles can use the analogue inputs of one device.
"""

import contextlib
import importlib
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Literal

from pydantic import Field

from smarig.config import LinkFile
from smarig.core import NAN, ConfigError, MissingExtra, Number, TomlTable
from smarig.device.encoding.link_faults import Silent

UNTESTED = "untested on hardware"  # part of every identity
WITHOUT_DRIVER = "DaqNotFoundError", "DaqNotSupportedError"


class NiInput(TomlTable):
    """An analogue input: value = scale · V + offset."""

    channel: str = Field(min_length=1, max_length=40)  # name on the device: "ai0"
    scale: Number = Field(ge=-1e9, le=1e9)  # unit per volt
    offset: Number = Field(default=0.0, ge=-1e9, le=1e9)  # unit at 0 V
    range_V: Number = Field(
        default=10.0, gt=0, le=60
    )  # the smallest range of the device that holds ± range_V
    terminal: Literal["DEFAULT", "RSE", "NRSE", "DIFF"] = "DEFAULT"  # reference of the input


def ni_package() -> Any:
    """The package. Raises UsageError if it is not installed."""
    try:
        package = importlib.import_module("nidaqmx")
        for part in ("constants", "errors", "system", "types"):
            importlib.import_module(f"nidaqmx.{part}")
    except ImportError:
        raise MissingExtra("An NI-DAQmx device (with the driver of NI)", "ni") from None
    return package


def device_name(where: LinkFile) -> str:
    """The name that NI's software gave the device, from ``url``. Raises ConfigError if it is none."""
    if not where.url or "/" in where.url:
        raise ConfigError(f"'{where.url}' is no name of an NI device. Give links.DEVICE.url, such as Dev1.")
    return where.url


@contextmanager
def ni_errors(device: str) -> Iterator[None]:
    """Errors of NI-DAQmx as Silent, in one line."""
    try:
        yield
    except ni_package().errors.Error as error:
        if type(error).__name__ in WITHOUT_DRIVER:
            raise Silent("The driver NI-DAQmx is not installed. Install it from NI.") from None
        what = next((line for line in str(error).splitlines() if line.strip()), type(error).__name__)
        raise Silent(f"{device}: {what.rstrip('.')}. {Silent.remedy}") from None


def identity_of(device: str) -> str:
    """Product and serial number. Raises Silent if there is no such device."""
    with ni_errors(device):
        found = ni_package().system.Device(device)
        return f"NI {found.product_type} {found.serial_num:X} ({device}), {UNTESTED}"


class NiInputs:
    """Analogue inputs that are read together, one sample each."""

    def __init__(self, device: str, inputs: Sequence[NiInput]) -> None:
        self._device, self._inputs = device, tuple(inputs)
        with ni_errors(device):
            self._task = ni_package().Task()
            with closed_on_failure(self._task):
                for one in self._inputs:
                    self._task.ai_channels.add_ai_voltage_chan(
                        f"{device}/{one.channel}",
                        terminal_config=ni_package().constants.TerminalConfiguration[one.terminal],
                        min_val=-one.range_V,
                        max_val=one.range_V,
                    )

    def values(self) -> list[float]:
        """The values now; NaN without a reading."""
        with ni_errors(self._device):
            read = self._task.read()
        volts = read if isinstance(read, list) else [read]
        return [
            one.scale * volt + one.offset if math.isfinite(volt) else NAN
            for one, volt in zip(self._inputs, volts)
        ]

    def close(self) -> None:
        """Give the inputs back. Never raises."""
        close_task(self._task)


def close_task(task: Any) -> None:
    """Close a task. Never raises and may be called repeatedly."""
    with contextlib.suppress(Exception):
        task.close()


@contextmanager
def closed_on_failure(task: Any) -> Iterator[None]:
    """Close a task (or several, with ``close``) if the body raises."""
    try:
        yield
    except BaseException:
        close_task(task)
        raise
