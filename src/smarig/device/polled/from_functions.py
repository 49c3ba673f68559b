"""Roles made of functions, for instruments that another library already drives: PyMeasure, QCoDeS, ophyd, a script.

A property of PyMeasure becomes ``lambda: supply.current``; a parameter of QCoDeS is a function as it is. The adapter
adds what a rig needs besides: read-backs, a confirmed switch-off, one kind of error, and no NaN on its way to a wire.
"""

import contextlib
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

import numpy as np

from smarig.core import NAN, UsageError, error_text
from smarig.device.encoding.link_faults import Garbled, LinkFault, Silent
from smarig.device.polled.falling_current import OFF_PAUSE_S, current_after_off
from smarig.device.polled.line_counts import garbled_remedy
from smarig.device.roles.polled import Electrical

_T = TypeVar("_T")
_TOLERANCE_A = 2e-3  # between a setting and its read-back
_OFF_A = 0.02  # measured at most by an instrument whose output is off


def _nothing() -> None:
    """Do nothing."""


@dataclass
class FunctionOutput:
    """A current output. ``switch_on`` and ``switch_off`` act on the output; without one, leave them out.

    ``prepare`` is called while the output is off, before the watchdog is armed: function, protections, voltage limit.
    ``setting_A`` reads the set current back, ``is_on`` the state of the output (True or False). All of them, and the
    measured current, must confirm ``off``. ``arm_watchdog`` is given the lease in seconds, arms the watchdog, reads it
    back, and returns whether it is armed; without it the output has no lease. ``line``: a TextLine or VisaLine, whose
    repeated queries mark their samples. Errors of the library become ``Silent``.
    """

    identity: str
    set_current_A: Callable[[float], Any]
    current_A: Callable[[], float]
    voltage_V: Callable[[], float]
    switch_on: Callable[[], Any] = _nothing
    switch_off: Callable[[], Any] = _nothing
    setting_A: Callable[[], float] | None = None
    is_on: Callable[[], Any] | None = None
    wire_degC: Callable[[], float] | None = None
    prepare: Callable[[], Any] = _nothing
    arm_watchdog: Callable[[float], bool] | None = None
    lease_s: float = 0.0
    close_all: Callable[[], Any] = _nothing
    line: Any = None
    has_lease: bool = field(default=False, init=False)
    tripped: str = field(default="", init=False)
    _on: bool = field(default=False, init=False)
    _ordered_A: float = field(default=0.0, init=False)

    def arm(self) -> None:
        """Off, confirmed; then the watchdog. Raises Silent if the output is not confirmed to be off."""
        self.has_lease = False
        unconfirmed = self.off()
        if unconfirmed:
            raise Silent(unconfirmed)
        self.tripped = ""
        self._call("preparing the output", self.prepare)
        if self.arm_watchdog is not None:
            self.has_lease = bool(self._call("arming its watchdog", self.arm_watchdog, self.lease_s))

    def set_current(self, current_A: float) -> None:
        """Set, switch on, and read the setting back."""
        if not math.isfinite(current_A):
            raise UsageError(f"A current of {current_A:g} A cannot be driven.")
        self._notice_trip()
        if self.tripped:
            return
        self._call("setting the current", self.set_current_A, float(current_A))
        self._ordered_A = float(current_A)
        if not self._on:
            self._call("switching on", self.switch_on)
            self._on = True
        if self.setting_A is not None:
            taken_A = self._number("reading the setting", self.setting_A)
            if not abs(taken_A - current_A) <= _TOLERANCE_A:
                self.off()
                raise Garbled(
                    f"{self.identity} set {taken_A:g} A instead of {current_A:g} A. {garbled_remedy(self)}"
                )

    def measure(self) -> Electrical:
        """Current, voltage and, with ``wire_degC``, the temperature of the wire."""
        self._notice_trip()
        current_A = self._number("measuring the current", self.current_A)
        voltage_V = self._number("measuring the voltage", self.voltage_V)
        wire_degC = NAN if self.wire_degC is None else self._number("measuring", self.wire_degC)
        return Electrical(current_A, voltage_V, wire_degC)

    def off(self) -> str:
        """Zero and off, then confirmed by every read-back that there is."""
        self._on, self._ordered_A = False, 0.0
        try:
            self._order_off()
            if self._confirmed_off():
                return ""
        except BaseException:  # whatever the library raises: nobody has confirmed anything
            pass
        where = getattr(self.line, "where", "")
        text = f"{self.identity}{f' at {where}' if where else ''} did not confirm that it is off."
        if not self.has_lease:
            return f"{text} It has no lease: switch it off by hand now."
        return f"{text} Its watchdog switches it off within {self.lease_s:g} s of silence; if not, do so by hand."

    def close(self) -> None:
        """Close what the library has opened. Never raises."""
        closed(self.close_all)

    def _order_off(self) -> None:
        try:
            self._call("setting zero", self.set_current_A, 0.0)
        finally:  # whether or not the first order was confirmed
            self._call("switching off", self.switch_off)

    def _confirmed_off(self) -> bool:
        """Whether state, setting and measured current all say so, of those that there are."""
        if self.is_on is not None and self._state() is not False:
            return False
        if self.setting_A is not None:
            setting_A = self._number("reading the setting", self.setting_A)
            if not abs(setting_A) <= _TOLERANCE_A:
                return False
        return self._flows_after_off_A() == 0.0

    def _flows_after_off_A(self) -> float:
        measured_A = partial(self._number, "measuring the current", self.current_A)
        return current_after_off(measured_A, self._order_off, _OFF_A, partial(time.sleep, OFF_PAUSE_S))

    def _state(self) -> bool | None:
        """Whether the output is on; None for an answer that is neither yes nor no."""
        assert self.is_on is not None  # noqa: S101 - its callers ask before
        answer = self._call("reading its state", self.is_on)
        return bool(answer) if isinstance(answer, bool | int | np.bool_) and answer in (0, 1) else None

    def _notice_trip(self) -> None:
        """An output that was switched on, and is off or at zero now, has switched itself off."""
        if not self._on or self.tripped:
            return
        off = self.is_on is not None and self._state() is False
        if self.setting_A is not None and self._ordered_A:
            setting_A = self._number("reading the setting", self.setting_A)
            off = off or abs(setting_A) <= _TOLERANCE_A < abs(self._ordered_A)
        if off:
            self.tripped = (
                f"{self.identity} has switched its output off, or it was never on: check its watchdog, protections, "
                "whether somebody pressed its output key, and the command that switches it on."
            )

    def _call(self, what: str, function: Callable[..., _T], *values: float) -> _T:
        return called(self.identity, what, function, *values)

    def _number(self, what: str, function: Callable[[], Any]) -> float:
        return called(self.identity, what, lambda: float(function()))


@dataclass
class FunctionInput:
    """A position (``unit`` "count", "mm" or "deg"), a temperature in °C or a force in N, read by one function.

    ``absolute``: the zero of the position survives a restart of the instrument and of the host, so that ``resume`` may
    rely on it: a laser, a potentiometer; not a counter that starts at 0.
    """

    identity: str
    read: Callable[[], float]
    unit: str = ""
    close_all: Callable[[], Any] = _nothing
    line: Any = None
    absolute: bool = False

    def position(self) -> float:
        """The position in ``unit``."""
        return self._number()

    def temperature_degC(self) -> float:
        """The temperature."""
        return self._number()

    def force_N(self) -> float:
        """The force."""
        return self._number()

    def close(self) -> None:
        """Close what the library has opened. Never raises."""
        closed(self.close_all)

    def _number(self) -> float:
        """The reading; NaN if it is none."""

        def number() -> float:
            value = self.read()
            return NAN if value is None else float(value)

        return called(self.identity, "reading", number)


def closed(close: Callable[[], Any]) -> None:
    """Close, whatever the library raises: an error here must not hide the one before it."""
    with contextlib.suppress(BaseException):
        close()


def called(identity: str, what: str, function: Callable[..., _T], *values: float) -> _T:
    """The result of a function of another library. Raises Silent, with its error, whatever it raises."""
    try:
        return function(*values)
    except LinkFault:
        raise
    except (Exception, SystemExit) as error:
        raise Silent(f"{identity}: {what} failed ({error_text(error)}). {Silent.remedy}") from error
