"""A wire wired to a LabJack: what a DAC drives through it, and what the inputs see, by the settings of the rig file."""

import random
from typing import Any

from simulators.labjack_box import CHANNELS, LabJackBox
from simulators.wire_quantities import WireQuantities
from smarig.config import LinkFile, RigFile
from smarig.core import UsageError
from smarig.rig import TwinSettings

NOISE_V = 0.0002  # standard deviation of one analogue reading
PER_TICK_S = 4  # steps of the watchdog per tick of the rig


class LabJackWire:
    """One box, one wire, one time in seconds of the devices."""

    def __init__(self, file: RigFile, settings: TwinSettings, product: int = 7) -> None:
        if file.links is None:
            raise UsageError(f"Rig '{file.name}' has no table [links].")
        self.file = file
        self._wire = WireQuantities(file, settings)
        self._output = file.links.amplifier.settings
        self._inputs = _inputs(file)
        self._noise = random.Random(settings.seed)
        self._noise_V = NOISE_V if settings.noise else 0.0
        self.box = LabJackBox(self._volts, self._degC, lambda: self._wire.counts, product)
        self.current_A = 0.0
        self._steps = 0

    def advance(self, now_s: float) -> None:
        """Let the time until ``now_s`` pass: the watchdog in quarters of a tick, the wire in ticks."""
        step_s = self.file.period_s / PER_TICK_S
        while (self._steps + 1) * step_s <= now_s:
            self._steps += 1
            self.box.pass_time(self._steps * step_s)
            if self._steps % PER_TICK_S == 0:
                self.current_A = self._driven_A()
                self._wire.advance(self.current_A)

    def _driven_A(self) -> float:
        """The current of the external amplifier or voltage stage."""
        dac_V = self.box.dac_V[self._output["dac"]]
        if "amperes_per_volt" in self._output:
            return dac_V * self._output["amperes_per_volt"]
        return (
            dac_V * self._output["volts_per_volt"] / self._wire.specimen.plant.resistance_ohm(self.current_A)
        )

    def _volts(self, channel: int) -> float:
        """The voltage at an input: its quantity through the inverse of scale and offset, with noise."""
        noise_V = self._noise.gauss(0.0, self._noise_V) if self._noise_V else 0.0
        for name, one in self._inputs:
            if one["channel"] == channel:
                return (self._wire.quantity(name) - one.get("offset", 0.0)) / one["scale"] + noise_V
        return noise_V

    def _degC(self, channel: int) -> float:
        """Any extended feature: the temperature of the room."""
        del channel
        return self._wire.quantity("temperature")


def _inputs(file: RigFile) -> list[tuple[str, dict[str, Any]]]:
    """Every input of the rig file with its quantity."""
    links = file.links
    assert links is not None  # noqa: S101 - checked by the caller
    wired = (
        ("current", links.amplifier, "current_input"),
        ("voltage", links.amplifier, "voltage_input"),
        ("position", links.encoder_daq, "input"),
        ("temperature", links.thermometer, "input"),
        ("temperature", links.room_thermometer, "input"),
        ("force", links.load_cell, "input"),
    )
    found = [(name, one) for name, link, key in wired if (one := _input(link, key))]
    if any(one["channel"] >= CHANNELS for _, one in found):
        raise UsageError(f"The simulated LabJack has the analogue inputs 0 to {CHANNELS - 1}.")
    return found


def _input(link: LinkFile | None, key: str) -> dict[str, Any] | None:
    return link.settings.get(key) if link is not None and link.driver.startswith("labjack_") else None
