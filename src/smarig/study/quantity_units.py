"""What a unit says of a quantity: which one it measures, whether it is a rate, a strain or that of a motion."""

import re

from smarig.exchange import dimension, known_unit
from smarig.study import quantity_words as q

_ELONGATION = re.compile(r"extens|elong|allonge")
_BY_DIMENSION = {
    "time": q.TIME,
    "temperature": q.TEMPERATURE,
    "length": q.DISPLACEMENT,
    "angle": q.ANGLE,
    "stress or pressure": q.STRESS,
    "force": q.FORCE,
    "current": q.CURRENT,
    "voltage": q.VOLTAGE,
    "resistance": q.RESISTANCE,
    "resistivity": q.RESISTIVITY,
    "power": q.POWER,
    "magnetic field": q.FIELD,
    "magnetic moment": q.MOMENT,
    "specific moment": q.MAGNETISATION,
    "polarisation": q.POLARISATION,
    "electric field": q.ELECTRIC_FIELD,
    "heat flow": q.HEAT_FLOW,
    "charge": q.CHARGE,
    "amount per mass": q.ADSORBED,
}
_RELATIVE = ("mm/mm", "1e-3", "ppm", "%")  # units of changes of length
_OF_GASES = ("Torr", "mbar", "hPa", "atm", "bar")  # no stress of a solid is given in them
_PER_TIME = re.compile(r"(.*?)\s*(?:/\s*(?:s|sec|min|h)|[·* ]?(?:s|min|h)(?:\^?-1|⁻¹))")
_INPUTS_ONLY = (q.TEMPERATURE, q.AMBIENT, q.CURRENT, q.VOLTAGE, q.POWER, q.DUTY)
_RATE_UNIT = re.compile(r".+/(s|ms|min|h|d)")


def is_rate_unit(written: str) -> bool:
    """Whether a unit is one of a possible output, per time.

    >>> is_rate_unit("T/s"), is_rate_unit("1/s"), is_rate_unit("ml/min"), is_rate_unit("°C/min")
    (True, True, False, False)
    """
    match = _PER_TIME.fullmatch(written.strip())
    if match is None:
        return False
    base = known_unit(match[1] or "1")
    quantity = q.STRAIN if dimension(base) == "ratio" else quantity_of_unit(base)
    return quantity not in ("", *q.NO_SIGNALS, *_INPUTS_ONLY)


def quantity_of_unit(unit: str) -> str:
    """The quantity that a unit measures, "" for ratios, counts and unknown units, and for C, which may mean °C.

    >>> quantity_of_unit("N"), quantity_of_unit("%"), quantity_of_unit("K/min"), quantity_of_unit("Torr")
    ('force', '', 'rate', 'pressure')
    """
    if unit == "C":
        return ""
    if unit in _OF_GASES:
        return q.PRESSURE
    return q.RATE if _RATE_UNIT.fullmatch(unit) else _BY_DIMENSION.get(dimension(unit), "") if unit else ""


def is_of_motion(written: str) -> bool:
    """Whether a unit as written may be that of a motion: none, a length, a ratio, counts, or one that is not known at
    all. One of known parts, as V/mA, is no motion.

    >>> is_of_motion(""), is_of_motion("mV/V"), is_of_motion("a.u."), is_of_motion("V/mA"), is_of_motion("mA.h")
    (True, True, True, False, False)
    """
    unit = known_unit(written)
    if unit:
        return dimension(unit) in ("length", "ratio", "raw counts", "voltage ratio")
    return not written or not all(known_unit(part) for part in written.split("/"))


def is_strain_unit(written: str) -> bool:
    """Whether a unit as it is written says that a ratio is a strain.

    >>> is_strain_unit("microstrain"), is_strain_unit("µm/m"), is_strain_unit("ppm"), is_strain_unit("%")
    (True, True, False, False)
    """
    unit = known_unit(written)
    of_lengths = "/" in written and unit in ("mm/mm", "ppm")
    return of_lengths or (unit == "ppm" and re.search("strain|[εɛ]", written.lower()) is not None)


def quantity_in_unit(quantity: str, unit: str, name: str = "") -> str:
    """A quantity that its letter names, as its unit tells it from another: a moment in A/m is a magnetisation, and a
    displacement in mm/mm a strain; a position in % may be one of a valve, unless its name is that of an elongation.

    >>> quantity_in_unit(q.MOMENT, "kA/m"), quantity_in_unit(q.MOMENT, "emu"), quantity_in_unit(q.RESISTANCE, "ohm cm")
    ('magnetisation', 'magnetic moment', 'resistivity')
    >>> quantity_in_unit(q.DISPLACEMENT, "mm/mm"), quantity_in_unit(q.DISPLACEMENT, "%", "Extensometer 1")
    ('strain', 'strain')
    """
    if quantity == q.DISPLACEMENT and unit in _RELATIVE:
        return q.STRAIN if unit != "%" or _ELONGATION.search(q.plain(name)) else quantity
    other = {(q.MOMENT, "magnetic field"): q.MAGNETISATION, (q.RESISTANCE, "resistivity"): q.RESISTIVITY}
    return other.get((quantity, dimension(unit)), quantity)
