"""The units that are converted, and the one spelling that each of them is stored in.

A unit that is not in this table is stored as it is written.
"""

import math
import re

_MU_0 = 4e-7 * math.pi

# unit: (dimension, factor, offset); value in the dimension's first unit = factor × value + offset
_PLAIN: dict[str, tuple[str, float, float]] = {
    "min": ("time", 60.0, 0.0),
    "h": ("time", 3600.0, 0.0),
    "d": ("time", 86400.0, 0.0),
    "degC": ("temperature", 1.0, 0.0),
    "K": ("temperature", 1.0, -273.15),
    "mK": ("temperature", 1e-3, -273.15),
    "degF": ("temperature", 5 / 9, -160 / 9),
    "cm": ("length", 10.0, 0.0),
    "in": ("length", 25.4, 0.0),
    "ft": ("length", 304.8, 0.0),
    "mil": ("length", 0.0254, 0.0),
    "deg": ("angle", 1.0, 0.0),
    "rad": ("angle", 180 / math.pi, 0.0),
    "mrad": ("angle", 0.18 / math.pi, 0.0),
    "count": ("raw counts", 1.0, 0.0),
    "mm/mm": ("ratio", 1.0, 0.0),
    "1": ("ratio", 1.0, 0.0),
    "%": ("ratio", 1e-2, 0.0),
    "1e-3": ("ratio", 1e-3, 0.0),
    "ppm": ("ratio", 1e-6, 0.0),
    "V/V": ("voltage ratio", 1.0, 0.0),  # of a bridge or an LVDT: output by excitation
    "mV/V": ("voltage ratio", 1e-3, 0.0),
    "uV/V": ("voltage ratio", 1e-6, 0.0),
    "kgf": ("force", 9.80665, 0.0),
    "gf": ("force", 9.80665e-3, 0.0),
    "lbf": ("force", 4.4482216152605, 0.0),
    "bar": ("stress or pressure", 0.1, 0.0),
    "mbar": ("stress or pressure", 1e-4, 0.0),
    "hPa": ("stress or pressure", 1e-4, 0.0),
    "atm": ("stress or pressure", 0.101325, 0.0),
    "Torr": ("stress or pressure", 0.101325 / 760, 0.0),
    "psi": ("stress or pressure", 6.894757e-3, 0.0),
    "ksi": ("stress or pressure", 6.894757, 0.0),
    "kip": ("force", 4448.2216152605, 0.0),
    "Ah": ("charge", 3600.0, 0.0),
    "mAh": ("charge", 3.6, 0.0),
    "uAh": ("charge", 3.6e-3, 0.0),
    "Wh": ("energy", 3600.0, 0.0),
    "mWh": ("energy", 3.6, 0.0),
    "ohm m": ("resistivity", 1.0, 0.0),
    "ohm cm": ("resistivity", 1e-2, 0.0),
    "mohm cm": ("resistivity", 1e-5, 0.0),
    "uohm cm": ("resistivity", 1e-8, 0.0),
    "N m": ("torque", 1.0, 0.0),
    "mN m": ("torque", 1e-3, 0.0),
    "Oe": ("magnetic field", 1e-4, 0.0),
    "kOe": ("magnetic field", 0.1, 0.0),
    "G": ("magnetic field", 1e-4, 0.0),
    "kG": ("magnetic field", 0.1, 0.0),
    "A/m": ("magnetic field", _MU_0, 0.0),
    "kA/m": ("magnetic field", 1e3 * _MU_0, 0.0),
    "A m^2/kg": ("specific moment", 1.0, 0.0),
    "emu/g": ("specific moment", 1.0, 0.0),
    "V/m": ("electric field", 1.0, 0.0),
    "kV/m": ("electric field", 1e3, 0.0),
    "kV/cm": ("electric field", 1e5, 0.0),
    "V/um": ("electric field", 1e6, 0.0),
    "kV/mm": ("electric field", 1e6, 0.0),
    "MV/m": ("electric field", 1e6, 0.0),
    "W/g": ("heat flow", 1.0, 0.0),
    "mW/mg": ("heat flow", 1.0, 0.0),
    "uW/mg": ("heat flow", 1e-3, 0.0),
    "mW/g": ("heat flow", 1e-3, 0.0),
    "W/kg": ("heat flow", 1e-3, 0.0),
    "uC/cm^2": ("polarisation", 1.0, 0.0),
    "C/m^2": ("polarisation", 100.0, 0.0),
    "mmol/g": ("amount per mass", 1.0, 0.0),
    "mol/kg": ("amount per mass", 1.0, 0.0),
    "umol/g": ("amount per mass", 1e-3, 0.0),
    "cm^3/g": ("volume per mass", 1.0, 0.0),
    "cm^3": ("volume", 1.0, 0.0),
    "mL": ("volume", 1.0, 0.0),
    "L": ("volume", 1e3, 0.0),
    "m^3": ("volume", 1e6, 0.0),
    "mm/s": ("velocity", 1.0, 0.0),
    "m/s": ("velocity", 1e3, 0.0),
}
_PREFIXES = {"p": 1e-12, "n": 1e-9, "u": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
# unit: (dimension, its factor without prefix, the prefixes that are in use with it)
_PREFIXED = {
    "s": ("time", 1.0, "n u m"),
    "A": ("current", 1.0, "p n u m k"),
    "V": ("voltage", 1.0, "n u m k M"),
    "m": ("length", 1e3, "p n u m k"),
    "Pa": ("stress or pressure", 1e-6, "m k M G"),
    "N": ("force", 1.0, "n u m k M"),
    "Hz": ("frequency", 1.0, "m k M G"),
    "T": ("magnetic field", 1.0, "n u m"),
    "ohm": ("resistance", 1.0, "u m k M G"),
    "C": ("charge", 1.0, "p n u m k"),
    "F": ("capacitance", 1.0, "p n u m"),
    "W": ("power", 1.0, "n u m k M"),
    "J": ("energy", 1.0, "n u m k M"),
    "g": ("mass", 1.0, "n u m k"),
    "mol": ("amount", 1.0, "n u m k"),
    "emu": ("magnetic moment", 1e-3, "n u m"),
    "A m^2": ("magnetic moment", 1.0, "n u m"),
}
UNITS = {
    f"{prefix}{unit}": (dimension, _PREFIXES[prefix] * factor, 0.0)
    for unit, (dimension, factor, prefixes) in _PREFIXED.items()
    for prefix in ["", *prefixes.split()]
} | _PLAIN
_SIGNS = str.maketrans(
    {"µ": "u", "μ": "u", "Ω": "ohm", "\N{OHM SIGN}": "ohm", "°": "deg", "℃": "degC", "℉": "degF"}
)
_POWERS = str.maketrans("⁻¹²³", "-123")
_PRODUCT = re.compile(r"[\s·⋅×*.]+|(?<=[A-Za-z])-(?=[A-Za-z])")
_SPELLINGS = {
    _PRODUCT.sub("", unit): unit for unit in UNITS if " " in unit or unit.endswith("h") or "deg" in unit
} | {
    "": "1",
    "-": "1",
    "ml": "mL",
    "l": "L",
    "sec": "s",
    "inch": "in",
    "inches": "in",
}
_SPELLINGS |= {
    f"{prefix}{name}": f"{'k' if prefix == 'K' else prefix}ohm"  # K is kelvin, but no kelvin has an ohm
    for prefix in ["", "K", *_PREFIXED["ohm"][2].split()]
    for name in ("ohm", "Ohm", "OHM", "ohms", "Ohms", "OHMS")
}
_SPELLINGS |= {
    _PRODUCT.sub("", unit).replace("ohm", name): unit
    for unit, (dimension, *_) in UNITS.items()
    if dimension == "resistivity"
    for name in ("Ohm", "OHM")
}
_SPELLINGS |= {f"{volume}/g": "cm^3/g" for volume in ("cc", "mL", "ml")}
_LONG = 4  # letters: a name of this length that misses a unit by one letter is a slip


def spelled(unit: str) -> str:
    """The one spelling of a known unit; any other unit as it is written.

    >>> spelled("mA*h"), spelled("Am²"), spelled("µm"), spelled("kΩ"), spelled("uOhm-cm"), spelled("beats")
    ('mAh', 'A m^2', 'um', 'kohm', 'uohm cm', 'beats')
    """
    text = re.sub(r"[⁻¹²³]+", lambda power: "^" + power[0].translate(_POWERS), unit.strip())
    text = re.sub(r"(?<=m)[23]\b", r"^\g<0>", text).translate(_SIGNS)
    if text in UNITS:
        return text
    return _SPELLINGS.get(_PRODUCT.sub("", text), unit.strip())


def meant(unit: str) -> str | None:
    """The known unit that an unknown one is a slip of: another case, a letter doubled, or one letter of a long name.

    >>> meant("degc"), meant("mmm"), meant("countt"), meant("rpm")
    ('degC', 'mm', 'count', None)
    """
    for same in (str.casefold, _without_repeats):
        if near := [known for known in UNITS if same(known) == same(unit)]:
            return min(near, key=lambda known: sum(a != b for a, b in zip(known, unit)))
    return next((k for k in UNITS if len(k) >= _LONG and k.isalpha() and _one_letter_apart(k, unit)), None)


def _without_repeats(text: str) -> str:
    """Each letter that is written more than twice in a row, twice; no other change."""
    return re.sub(r"(.)\1{2,}", r"\1\1", text)


def _one_letter_apart(a: str, b: str) -> bool:
    """Whether one letter more, less or other makes ``a`` of ``b``."""
    if abs(len(a) - len(b)) > 1:
        return False
    k = next((k for k, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
    return a != b and (a[k + 1 :] == b[k + 1 :] or a[k:] == b[k + 1 :] or a[k + 1 :] == b[k:])
