"""Readings of queried instruments, checked to be what their interface promises: a driver can return anything."""

from contextlib import suppress
from numbers import Real
from typing import Any

from smarig.core import shown
from smarig.device.encoding.link_faults import Garbled
from smarig.device.roles.polled import Electrical


def number_from(instrument: Any, query: str) -> float:
    """What a query such as ``position`` of an instrument returns. Raises Garbled if that is no number.

    >>> from types import SimpleNamespace
    >>> number_from(SimpleNamespace(identity="laser", position=lambda: 3), "position")
    3.0
    """
    return _number(getattr(instrument, query)(), instrument, query)


def electrical_from(output: Any) -> Electrical:
    """What ``measure`` of an output returns. Raises Garbled if that is no ``Electrical`` of numbers."""
    measured = output.measure()
    if not isinstance(measured, tuple) or len(measured) != len(Electrical._fields):
        raise _no(measured, output, "measure", "an Electrical")
    return Electrical(*(_number(value, output, "measure") for value in measured))


def _number(value: Any, instrument: Any, query: str) -> float:
    if type(value) is float:  # nearly always
        return value
    if isinstance(value, Real) and not isinstance(value, bool):
        with suppress(OverflowError):
            return float(value)
    raise _no(value, instrument, query, "a number")


def _no(value: Any, instrument: Any, query: str, expected: str) -> Garbled:
    returned = f"{query} returned {shown(value)}, which is not {expected}"
    return Garbled(f"{instrument.identity}: {returned}. Correct the driver.")
