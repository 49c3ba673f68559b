"""Estimates the duration and range of a run: its protocol runs on a noise-free twin without a record.

The estimate follows the rig's own model; the settling times of a real wire differ. It has no noise, so within a process
one of the same protocol, settings and rig is computed once.
"""

import time
from collections.abc import Callable, Hashable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from smarig.config import RigFile
from smarig.core import (
    NOT_NUMBERS,
    LimitExceeded,
    Protocol,
    Sample,
    StepResult,
    StepVerdict,
    UsageError,
    catalogue_names,
    own_entries,
)
from smarig.plant import Actuator
from smarig.protocols import PROTOCOLS, Chooser, Setup, build_protocol, file_settings
from smarig.rig import Guard, Twin, TwinSettings, limits_in_force, stress_limit
from smarig.runner.listener import CallbackListener
from smarig.runner.run_control import RunControl
from smarig.runner.runner import Runner

MAX_SAMPLES = 5_000_000  # nearly six days at 10 Hz
SAMPLES_BETWEEN_LOOKS, REPORT_EVERY_S = 5000, 3.0
BYTES_PER_SAMPLE = 90  # measured on run files, with a margin

ProtocolFactory = Callable[[Setup], Protocol]
_MOST_KEPT = 64
_computed: dict[Hashable, "Preview"] = {}


@dataclass(frozen=True)
class Preview:
    """Predicted duration, steps, peak current, peak predicted temperature, holds that time out, size.

    ``without_lease_A`` is the lower limit that applies if the current source of a bench has no lease, None
    if the run stays within it.
    """

    protocol: str
    duration_s: float
    steps: int
    peak_current_A: float
    peak_temperature_K: float
    timed_out: int
    bytes: int
    without_lease_A: float | None = None

    def sentence(self) -> str:
        """The preview in one line."""
        timeout_text = f", {self.timed_out} holds would time out" if self.timed_out else ""
        lower = (
            f" (at most {self.without_lease_A:.3g} A if its source turns out to have no lease)"
            if self.without_lease_A
            else ""
        )
        return (
            f"{self.protocol}: {self.duration_s / 3600:.2f} h, {self.steps} steps, peak {self.peak_current_A:.3g} A, "
            f"{self.peak_temperature_K:.1f} K above ambient{lower}{timeout_text}"
        )


class _Peaks:
    """The extremes of a run. ``report`` is told its time every few seconds of real time."""

    def __init__(self, report: Callable[[float], None] | None) -> None:
        self.current_A = self.temperature_K = 0.0
        self.samples = self.timed_out = 0
        self._report, self._reported_s = report, time.monotonic()

    def sample(self, s: Sample, _step: int | None, input_K: float) -> None:
        self.samples += 1
        if self._report and not self.samples % SAMPLES_BETWEEN_LOOKS and self._is_due():
            self._report(s.t_s)
        if self.samples > MAX_SAMPLES:
            raise UsageError(
                f"The run would take more than {s.t_s / 86400:.1f} days. Reduce its settings, or split it."
            )
        self.current_A = max(self.current_A, abs(s.current_A))
        self.temperature_K = max(self.temperature_K, abs(input_K))

    def _is_due(self) -> bool:
        now_s = time.monotonic()
        if now_s - self._reported_s < REPORT_EVERY_S:
            return False
        self._reported_s = now_s
        return True

    def step(self, result: StepResult) -> None:
        self.timed_out += result.verdict is StepVerdict.TIMED_OUT


def preview(
    protocol: str,
    rig: RigFile,
    settings: Mapping[str, Any] | None = None,
    control: RunControl | None = None,
    chooser: Chooser | None = None,
    protocol_factory: ProtocolFactory | None = None,
    report: Callable[[float], None] | None = None,
) -> Preview:
    """Run a protocol on the rig's noise-free twin. Raises UsageError if it would exceed the limits.

    ``chooser`` is for protocols that take one. ``protocol_factory`` makes a closed loop, whose protocol is not in the
    catalogue. ``report``, if given, is told the time that the preview has reached, in seconds of the run, every few
    seconds: every tick is simulated, about 100,000 a second.
    """
    actuator = Actuator.named(rig.actuator)
    key = None if protocol_factory else _key(protocol, rig, actuator, settings or {}, chooser)
    if key in _computed:
        if control is not None:
            control.raise_if_stopped()
        return _computed[key]
    nothing_hidden = rig.model_copy(update={"hidden_effect": False})  # a preview must not reveal it
    twin = Twin(nothing_hidden, actuator, TwinSettings(noise=False))
    peaks = _Peaks(report)
    runner = Runner(
        Guard(twin, rig.limits, actuator, stress=stress_limit(rig, actuator)),
        twin.position_per_count,
        [CallbackListener(peaks.sample, peaks.step)],
        control,
    )
    try:
        setup = Setup(actuator, rig.limits, rig.period_s)
        runner.run(
            protocol_factory(setup)
            if protocol_factory
            else build_protocol(protocol, setup, settings, chooser)
        )
    except LimitExceeded as refused:
        refused.current_text = ""  # nothing was driven
        raise UsageError(
            f"Protocol '{protocol}' was not started, because it would trip on the twin. {refused}"
            f"{_too_large(settings or {}, rig)}"
        ) from None
    found = Preview(
        protocol=protocol,
        duration_s=runner.t_s,
        steps=runner.steps_done,
        peak_current_A=peaks.current_A,
        peak_temperature_K=peaks.temperature_K,
        timed_out=peaks.timed_out,
        bytes=peaks.samples * BYTES_PER_SAMPLE,
        without_lease_A=_lower_limit(rig, actuator, peaks.current_A),
    )
    if key is not None:
        if len(_computed) >= _MOST_KEPT:
            del _computed[next(iter(_computed))]
        _computed[key] = found
    return found


def _lower_limit(rig: RigFile, actuator: Actuator, peak_A: float) -> float | None:
    """The limit of a bench without a lease (A), which only the opened device tells; None if a run stays within it."""
    if rig.kind != "bench":
        return None
    limits = limits_in_force(rig.limits, actuator, has_lease=False)
    largest_A = max(limits.current_max_A, -limits.current_min_A)
    return largest_A if peak_A > largest_A else None


def _key(
    protocol: str, rig: RigFile, actuator: Actuator, settings: Mapping[str, Any], chooser: Chooser | None
) -> Hashable:
    """What a preview depends on; None where a file is read, which may have changed since."""
    reads_file = rig.load is not None and bool(rig.load.file)
    shipped = protocol in catalogue_names(PROTOCOLS) and protocol not in own_entries(PROTOCOLS)
    if reads_file or not shipped or set(settings) & set(file_settings(protocol)):
        return None
    texts = tuple(sorted((key, repr(value)) for key, value in settings.items()))
    return protocol, rig.model_dump_json(), actuator.file.model_dump_json(), texts, chooser


def _too_large(settings: Mapping[str, Any], rig: RigFile) -> str:
    """Which of the settings is a current beyond the limits; "" if none is."""
    found = []
    for name, value in settings.items():
        with suppress(*NOT_NUMBERS):
            if (
                name.endswith("_A")
                and not rig.limits.current_min_A <= float(value) <= rig.limits.current_max_A
            ):
                found.append(f"{name} = {float(value):g}")
    return f" It is set to {', '.join(found)}." if found else ""
