"""Units as data files of other programs and languages write them."""

import re
from collections.abc import Sequence

from smarig.exchange.units.units import UNITS, spelled

_BRACKETED = re.compile(r"[\[(<{](.*)[\])>}]")


# \+(o) raised, \-(2) lowered, \g(m) Greek, as Origin writes
_MARKUP = re.compile(r"\\(\+|-|g|i|b|u)\(([^()]*)\)")
_GREEK = str.maketrans("abgdezhqklmnprstfcyowGDQLPSFYW", "αβγδεζηθκλµνπρστφχψοωΓΔΘΛΠΣΦΨΩ")
_RAISED = str.maketrans("o-0123456789", "°⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def without_markup(text: str) -> str:
    """A text with the signs that the markup of a plotting program means.

    >>> without_markup("\\\\+(o)C"), without_markup("\\\\g(m)m"), without_markup("R\\\\-(2)")
    ('°C', 'µm', 'R2')
    """
    return _MARKUP.sub(_sign_of, text)


def _sign_of(markup: re.Match[str]) -> str:
    table = {"+": _RAISED, "g": _GREEK}.get(markup[1])
    return markup[2].translate(table) if table else markup[2]


def is_units_row(row: Sequence[str]) -> bool:
    """Whether the cells of a row are units, in brackets or not.

    >>> is_units_row(["s", "°C", "[mm]"]), is_units_row(["Time", "Temperature"]), is_units_row(["", "(N)", "-"])
    (True, False, True)
    """
    cells = [cell.strip() for cell in row if cell.strip()]
    units = [_BRACKETED.fullmatch(cell) is not None or is_unit(cell) or cell in ("-", "--") for cell in cells]
    return bool(cells) and sum(units) >= max(1, (3 * len(cells) + 3) // 4)


def is_unit(text: str) -> bool:
    """Whether a text is a unit that is known, however it is spelled.

    >>> is_unit("°C"), is_unit("N/mm²"), is_unit("stC"), is_unit("Temp")
    (True, True, True, False)
    """
    return known_unit(text) != ""


_FOREIGN = {  # spellings of other programs and languages
    "c": "degC",
    "stc": "degC",
    "cel": "degC",  # as UCUM writes it
    "celsius": "degC",
    "deg.c": "degC",
    "deg c": "degC",
    "deg.f": "degF",
    "deg f": "degF",
    "deg k": "K",
    "grad c": "degC",
    "°": "deg",
    "kelvin": "K",
    "sec": "s",
    "secs": "s",
    "seconds": "s",
    "sek": "s",
    "sekunden": "s",
    "second": "s",
    "minutes": "min",
    "minuten": "min",
    "hours": "h",
    "hr": "h",
    "std": "h",
    "msec": "ms",
    "millimeter": "mm",
    "volts": "V",
    "volt": "V",
    "amps": "A",
    "amp": "A",
    "ampere": "A",
    "newton": "N",
    "lb": "lbf",  # of what a machine pulls with, it is a force
    "lbs": "lbf",
    "pound": "lbf",
    "pounds": "lbf",
    "kips": "kip",
    "klbf": "kip",
    "kp": "kgf",
    "feet": "ft",
    "inch": "in",
    "inches": "in",
    '"': "in",
    "mils": "mil",
    "thou": "mil",
    "percent": "%",
    "pct": "%",
    "prozent": "%",
    "n/mm^2": "MPa",
    "n/mm2": "MPa",
    "n/mm²": "MPa",
    "mm/mm": "mm/mm",
    "m/m": "mm/mm",
    "in/in": "mm/mm",
    "‰": "1e-3",
    "microstrain": "ppm",
    "ustrain": "ppm",
    "µstrain": "ppm",
    "με": "ppm",  # in small letters, as all are looked up
    "µε": "ppm",
    "µm/m": "ppm",
    "um/m": "ppm",
    "oersted": "Oe",
    "gauss": "G",
    "tesla": "T",
    "am2": "A m^2",
    "counts": "count",
    "adc": "count",
    "uc/cm2": "uC/cm^2",
    "µc/cm²": "uC/cm^2",
    "µc/cm2": "uC/cm^2",
    "ohms": "ohm",
    "ohm2w": "ohm",
    "ohm4w": "ohm",
    "volt dc": "V",
    "amp dc": "A",
    "mmhg": "Torr",
    "mm hg": "Torr",
    "fahrenheit": "degF",
    "f": "degF",
}
_POWER_OF_TEN = re.compile(r"[*×x·]?\s*(?:10\s*\^?\s*\(?[-−⁻]|1[eE]-)0*([236²³⁶])\)?")  # *10^-3, 1E-06
_RATIOS = {"2": "%", "3": "1e-3", "6": "ppm", "²": "%", "³": "1e-3", "⁶": "ppm"}
_OF_GAS = re.compile(
    r"\s*[(\s](STP|NTP)\b\)?|(?<=[a-z³3])(STP|NTP)(?=/)"
)  # a remark: at standard temperature
_OF_REFERENCE = re.compile(r"([a-z])/\1_?(o|0|s|sat|max|ref)", re.IGNORECASE)  # p/p0
_PER = re.compile(r"(.+)[_\s]per[_\s](.+)")  # kA_per_m
_POWER = re.compile(r"(?:\^?[23]|[²³])$")
_CASED = {"C": "degC", "F": "degF"}  # one letter that stands for a temperature beside a name of one only


def known_unit(text: str, *, temperature: bool = False) -> str:
    """The one spelling of a unit, "" if it is unknown; ``temperature``: C and F are degrees.

    >>> known_unit("sec"), known_unit("N/mm²"), known_unit("C"), known_unit("C", temperature=True), known_unit("rpm")
    ('s', 'MPa', 'C', 'degC', '')
    >>> known_unit("kV_per_cm"), known_unit("W per g"), known_unit("cycles_per_s")
    ('kV/cm', 'W/g', '')
    >>> known_unit("*10^-3"), known_unit("x 1E-06"), known_unit("10⁻³"), known_unit("‰")
    ('1e-3', 'ppm', '1e-3', '1e-3')
    >>> known_unit("cm³(STP)/g"), known_unit("cc/g STP"), known_unit("STP")
    ('cm^3/g', 'cm^3/g', '')
    >>> known_unit("m³/m³"), known_unit("P/Po"), known_unit("g/g"), known_unit("m/m")
    ('1', '1', '1', 'mm/mm')
    >>> known_unit("e-006")  # the end of a number
    ''
    """
    word = without_markup(text).strip().strip("[](){}<>").strip()
    if temperature and word in _CASED:
        return _CASED[word]
    if not word or word == "-":
        return ""
    if spelled(word) in UNITS:
        return spelled(word)
    if match := _POWER_OF_TEN.fullmatch(word):
        return _RATIOS[match[1]]
    if _OF_GAS.search(word):
        return known_unit(_OF_GAS.sub("", word))
    if _OF_REFERENCE.fullmatch(word) or _is_of_equal_parts(word):
        return "1"
    if match := _PER.fullmatch(word):
        return _quotient(match[1], match[2])
    found = _FOREIGN.get(word.lower().replace("_", " "), "")
    return "" if len(word) == 1 and word not in ('"', "°", "‰") else found


def _is_of_equal_parts(word: str) -> bool:
    """Whether a unit is one over itself, but no strain."""
    above, stroke, below = word.partition("/")
    return stroke == "/" and above == below and spelled(above) in UNITS and word.lower() not in _FOREIGN


def _quotient(above: str, below: str) -> str:
    """The unit ``above`` per ``below``, each known or a power of a known one; "" if one is unknown."""
    if unit := known_unit(f"{above}/{below}".replace("_", " ")):
        return unit
    parts = [
        known_unit(part) or (part if known_unit(_POWER.sub("", part)) else "") for part in (above, below)
    ]
    return "/".join(parts) if all(parts) else ""
