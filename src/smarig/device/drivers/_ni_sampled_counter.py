"""An encoder on a counter of an NI device, sampled by a second counter of it: the tick is the device's own clock.

The one converter of a multifunction device must own all inputs of a timed task, and the roles have tasks of their own;
counters are free of that, so the position is timed by the hardware and the analogue inputs by the host.
Untested on hardware.
"""

import time
from collections import deque
from itertools import takewhile
from typing import Any

from smarig.core import Quality
from smarig.device.drivers._ni import close_task, closed_on_failure, identity_of, ni_errors, ni_package
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.roles.ticked import PositionReading

KEPT_S = 60.0  # readings that the host and NI-DAQmx keep for a slow reader
FIRST_PERIODS = 20  # to wait for the first sample
LATEST_WAIT_S = 2.0


class NiSampledCounter:
    """Counts since the last zero (n ticks), one sample per period of the rig.

    ``counter`` decodes the encoder, four counts per line; each edge of ``clock`` latches it. Tick k is the k-th edge.
    """

    def __init__(self, device: str, counter: str, clock: str, period_s: float, ambient_degC: float) -> None:
        self._device, self._period_s, self._ambient_degC = device, period_s, ambient_degC
        self.identity = f"{identity_of(device)}, {counter} sampled by {clock} since {time.time():.3f}"
        kept = max(100, round(KEPT_S / period_s))
        self._ring: deque[PositionReading] = deque(maxlen=kept)
        self._read = self._raw = self._zero = 0
        with ni_errors(device):
            self._task = ni_package().Task()
        with closed_on_failure(self._task):
            self._sample(f"{device}/{counter}", f"/{device}/{_output_of(clock)}", kept)
            with ni_errors(device):
                self._clock_task = ni_package().Task()
            with closed_on_failure(self._clock_task):
                self._start_clock(f"{device}/{clock}")
                self._wait_for_first()

    def since(self, tick: int, at_most: int) -> list[PositionReading]:
        """Samples from a tick on, of the last ``KEPT_S``."""
        self._take()
        found = list(takewhile(lambda reading: reading.tick >= tick, reversed(self._ring)))
        return found[::-1][: max(at_most, 0)]

    def tick(self) -> int:
        """The number of samples so far, from 0."""
        self._take()
        return self._read - 1

    def zero(self) -> None:
        """Count from the present position on."""
        self._take()
        self._zero = self._raw

    def close(self) -> None:
        """Give both counters back."""
        close_task(self._clock_task)
        close_task(self._task)

    def _sample(self, counter: str, source: str, kept: int) -> None:
        with ni_errors(self._device):
            constants = ni_package().constants
            self._task.ci_channels.add_ci_ang_encoder_chan(
                counter, decoding_type=constants.EncoderType.X_4, units=constants.AngleUnits.TICKS
            )
            self._task.timing.cfg_samp_clk_timing(
                1 / self._period_s,
                source=source,
                sample_mode=constants.AcquisitionType.CONTINUOUS,
                samps_per_chan=kept,
            )
            self._task.start()

    def _start_clock(self, clock: str) -> None:
        """Last: no edge may pass before the counter waits for it."""
        with ni_errors(self._device):
            continuous = ni_package().constants.AcquisitionType.CONTINUOUS
            self._clock_task.co_channels.add_co_pulse_chan_freq(clock, freq=1 / self._period_s)
            self._clock_task.timing.cfg_implicit_timing(sample_mode=continuous)
            self._clock_task.start()

    def _wait_for_first(self) -> None:
        until_s = time.monotonic() + max(LATEST_WAIT_S, FIRST_PERIODS * self._period_s)
        while not self._read:
            if time.monotonic() > until_s:
                raise Silent(f"{self.identity} gives no sample: its clock does not run. {Silent.remedy}")
            time.sleep(min(self._period_s / 4, 0.01))
            self._take()

    def _take(self) -> None:
        """Fetch what was sampled since the last call. Raises Silent for a lost device, or samples lost in between."""
        with ni_errors(self._device):
            found: Any = self._task.read(ni_package().constants.READ_ALL_AVAILABLE)
        for value in found if isinstance(found, list) else [found]:
            self._raw = self._count(value)
            self._ring.append(
                PositionReading(self._read, self._raw - self._zero, self._ambient_degC, Quality.GOOD)
            )
            self._read += 1

    def _count(self, value: Any) -> int:
        try:
            return round(float(value))
        except (TypeError, ValueError, OverflowError):
            raise Garbled(f"{self.identity} gives {value!r} for a count. {Garbled.remedy}") from None


def _output_of(counter: str) -> str:
    """The terminal of a counter's pulses.

    >>> _output_of("ctr1")
    'Ctr1InternalOutput'
    """
    return f"{counter[:1].upper()}{counter[1:]}InternalOutput"
