"""Quantities by the words of a column's name, in the languages of the labs, and by units."""

import re
import unicodedata
from collections.abc import Iterable

from smarig.exchange import dimension, known_unit

TIME, INDEX, CYCLE, RATE = "time", "row number", "cycle number", "rate"
SCATTER, STATUS = "error of a reading", "status of an instrument"
NO_SIGNALS = (TIME, INDEX, CYCLE, RATE, SCATTER, STATUS)  # whatever their units
TEMPERATURE, AMBIENT = "temperature", "ambient temperature"
STRAIN, DISPLACEMENT, ANGLE = "strain", "displacement", "angle"
FORCE, STRESS, PRESSURE, MODULUS = "force", "stress", "pressure", "modulus"
CURRENT, VOLTAGE, RESISTANCE, POWER, DUTY = "current", "voltage", "resistance", "power", "duty cycle"
RESISTIVITY = "resistivity"
FIELD, FLUX, MOMENT, MAGNETISATION = "magnetic field", "flux density", "magnetic moment", "magnetisation"
POLARISATION, ELECTRIC_FIELD = "polarisation", "electric field"
HEAT_FLOW = "heat flow"
CHARGE = "charge"
ADSORBED, WATER_CONTENT, MATRIC_POTENTIAL = "quantity adsorbed", "water content", "matric potential"
MASS, HUMIDITY, RELATIVE_PRESSURE = "mass", "relative humidity", "relative pressure"
LOADS = (STRESS, FORCE, FIELD)  # under which a wire is cycled, if they are held
HELD = (*LOADS, TEMPERATURE)  # conditions of a run, if they are held in it

_OF_LENGTHS = r"(\bd|\bdelta|δ|∆) ?l ?/ ?l"  # ΔL/L0

_WORDS: tuple[tuple[str, str], ...] = (  # the first that matches counts
    (
        SCATTER,
        r"std ?(dev|err)|standard (dev|err)|st dev|percent err|uncertain|unsicherheit|\breg fit|"
        r"(position|follow\w*|track\w*|control|servo|loop) err|regelabweich|schleppfehler|erreur de|error de",
    ),
    (STATUS, r"status"),  # "Field Status (code)" is no field
    (
        RATE,
        r"deriv|\brate|d\w*/dt|dtdt|gradient|velocity|speed|geschwindigkeit|\bslope|\bd\w{1,3} dt\b|"
        r"pick ?up|search coil|sens\w* coil|\binduced|induktionsspannung|\b[uv] ?ind\b",
    ),
    (
        HEAT_FLOW,
        r"heat ?fl(ow|ux)|\bdsc\b|w(ae|a)rme(strom|fluss)|(flux|debit) (de chaleur|thermique)|flujo de calor",
    ),
    (AMBIENT, r"ambien|room|umgebung|raumtemp|\bt ?amb|t ?room|air ?temp"),
    (CYCLE, r"cycle (no|num|count|index)|^cycle$|\bcycles$|^zyklus|^loop$|segment"),
    (
        INDEX,
        r"^ind(ex|ice|eks)$|^#$|^nr$|^no$|^n$|^row|^scan|^sample$|^point|^unnamed|^record|^messpunkt|^lfd|^id$|"
        r"^table no|\bseq\b",
    ),
    (
        TIME,
        r"^t$|^tout$|time|epoch|zeit|tiempo|^temps$|^tempo$|elapsed|^sec|uhr|datum|^date|^x value|\bstamp$",
    ),
    (DUTY, r"pwm|duty|control input|tastgrad"),
    (
        TEMPERATURE,
        r"temp|thermo|pyro|celsius|^tc ?\d*$|^t ?\d+$|^t (wire|sample|probe|oven|heater|front|end)\b",
    ),
    (MODULUS, r"modulus|\b(speicher|verlust|schub|e|g)?modul\b"),
    (STRAIN, rf"strain|dehn|deform|\beps|elongation rel|stretch|\be(xx|yy|zz|xy|yz|xz)\b|{_OF_LENGTHS}"),
    (STRESS, r"stress|\bsigma|contrainte|(zug|druck)spannung|tension mech"),
    (MAGNETISATION, r"magneti[sz]ation|magnetisierung|aimantation"),
    (MOMENT, r"moment|^m$|^m [a-z]*$"),
    (FLUX, r"flux|induction|^b$|^bmeas|^b\b|flussdichte"),
    (FIELD, r"field|feld|champ|campo|^h$|^hmeas|^h\b|mu ?0 ?h"),
    (POLARISATION, r"polari|^p\d?$"),
    (CHARGE, r"charge|ladung|\bq qo\b|^d?q$"),
    (MASS, r"\bmass[ea]?\b|\bmasa\b|weight|gewicht|\bpoids\b|\bpeso\b"),
    (FORCE, r"force|kraft|\bload|\blast\b|fuerza|forza|\bf$|^fn?$|^f ?\d$"),
    (
        WATER_CONTENT,
        r"(water|moisture) content|soil moisture|\bvwc\b|wassergehalt|bodenfeuchte|teneur en eau|"
        r"contenido de (agua|humedad)",
    ),
    (
        MATRIC_POTENTIAL,
        r"matri(c|x) ?pot|(soil|water) (water )?(potential|tension)|suction|saugspannung|potenti(el|al) (hydr|matri)",
    ),
    (HUMIDITY, r"humid|feucht|\brh\b|umidita|humedad"),
    (RELATIVE_PRESSURE, r"rel\w* (pressure|druck)|pression relative|presion relativa|\bp ?/ ?p(o|0|s|sat)\b"),
    (ADSORBED, r"adsorbed|desorbed|\bads\b|uptake|adsorbiert|adsorbe|\bstp\b"),
    (PRESSURE, r"pressure|druck|pression|presion|vacuum|vakuum"),
    (
        DISPLACEMENT,
        r"disp|position|\bpos\b|\bweg|hub|stroke|crosshead|travers|extens|elong|laser|lvdt|encoder|\bdl|"
        r"verschieb|deplacement|contraction|^x$|^d\d?$|laenge|length|longueur|piston|spostamento|desplaz",
    ),
    (ANGLE, r"angle|winkel|rotation|theta|shaft"),
    (RESISTANCE, r"resist|widerstand|^r$|^r[a-z]? ?\d?$"),
    (POWER, r"power|leistung|puissance|watt"),
    (CURRENT, r"current|strom|courant|corriente|^i$|^iz|^i ?\d?$|ampere|^i\w{0,5}$"),
    (VOLTAGE, r"volt|spannung|^u$|^uz|^v$|^v ?\d?[+-]?$|^u ?\d$|tension|^u\w{0,5}$"),
)
_OTHERS = re.compile(  # names of what is read beside a loop
    r"\brpm\b|speed|drehzahl|\bflow|durchfluss|\bph\b|conductiv|leitf|concentr|konzentr|content|gehalt|percent|"
    r"frequen|energ|volum|dichte|density|lux\b|illumin|\bco2\b|\bcount|\braw\b|\badc\b"
)
_LETTERS = re.compile(
    r"[iu]\w{1,5}", re.IGNORECASE
)  # letter of a current or voltage, and what may be its index
_BRANCH = re.compile(
    r"(?<![a-z])(heat(ing)?|cool(ing)?|up|down|forth|back(ward)?|forward|reverse|fwd|bwd|rev|(in|de)creasing|rising|"
    r"falling|(a|de)scending)(?![a-z])",
    re.IGNORECASE,
)
_COMMANDED = re.compile(
    r"\b(set|soll|vorgabe|command|cmd|target|setpoint|demand|desired|reference|ref|consign[ea]|sp\b)|zad|sollwert"
)
_REMARKED = re.compile(r"set ?point|set value|\bsoll|vorgabe|\bcommand|\btarget|\bdemand|consign[ea]|zadan")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")  # fSollStrom, TSetpoint
DIMENSIONS = {  # of the units in which a quantity may be given
    TIME: ("time",),
    TEMPERATURE: ("temperature",),
    AMBIENT: ("temperature",),
    STRAIN: ("ratio",),
    DISPLACEMENT: ("length",),
    ANGLE: ("angle",),
    STRESS: ("stress or pressure",),
    PRESSURE: ("stress or pressure",),
    MODULUS: ("stress or pressure",),
    FORCE: ("force", "mass"),
    CURRENT: ("current",),
    VOLTAGE: ("voltage",),
    RESISTANCE: ("resistance",),
    RESISTIVITY: ("resistivity",),
    POWER: ("power",),
    FIELD: ("magnetic field",),
    FLUX: ("magnetic field",),
    MOMENT: ("magnetic moment",),
    MAGNETISATION: ("magnetic moment", "specific moment", "magnetic field"),
    POLARISATION: ("polarisation",),
    ELECTRIC_FIELD: ("electric field",),
    DUTY: ("ratio",),
    HEAT_FLOW: ("heat flow", "power"),
    CHARGE: ("charge",),
    ADSORBED: ("volume per mass", "amount per mass", "volume", "amount", "mass", "ratio"),
    MASS: ("mass", "ratio"),
    HUMIDITY: ("ratio",),
    WATER_CONTENT: ("ratio",),
    MATRIC_POTENTIAL: ("stress or pressure",),
    RELATIVE_PRESSURE: ("ratio",),
}
USUAL_UNITS = {  # by quantity, the most usual first
    TIME: ("s", "ms", "min", "h"),
    TEMPERATURE: ("degC", "K", "degF"),
    STRAIN: ("%", "mm/mm", "1e-3", "ppm"),
    DISPLACEMENT: ("mm", "m", "um", "%", "V"),  # a column without a unit may be the voltage of a sensor
    ANGLE: ("deg", "rad"),
    FORCE: ("N", "mN", "kN"),
    STRESS: ("MPa", "Pa", "GPa"),
    PRESSURE: ("Pa", "kPa", "bar", "MPa"),
    MODULUS: ("Pa", "MPa", "GPa"),
    CURRENT: ("A", "mA"),
    VOLTAGE: ("V", "mV"),
    RESISTANCE: ("ohm", "mohm", "kohm"),
    POWER: ("W", "mW"),
    FIELD: ("T", "mT", "Oe", "A/m"),
    FLUX: ("T", "mT", "G"),
    MOMENT: ("A m^2", "emu"),
    MAGNETISATION: ("A/m", "emu/g"),
    POLARISATION: ("uC/cm^2", "C/m^2"),
    ELECTRIC_FIELD: ("kV/cm", "V/m"),
    CHARGE: ("C", "uC", "Ah"),
    DUTY: ("%", "1", "count"),
    ADSORBED: ("cm^3/g", "mmol/g"),
    MASS: ("g", "mg", "kg"),
    HUMIDITY: ("%", "1"),
    WATER_CONTENT: ("1", "%"),
    MATRIC_POTENTIAL: ("kPa", "MPa", "hPa"),
    RELATIVE_PRESSURE: ("1", "%"),
}
_BRACKET = re.compile(r"[\s_]*[\[(<{]\s*([^\[\](){}<>]*)\s*[\])>}]\s*")
_EMPTY_BRACKET = re.compile(r"\s*(\[\s*\]|\(\s*\)|<\s*>|\{\s*\})")
_REMARK = re.compile(r"[^:]+:\s.*")  # "LGR S/N: 10224511" in a bracket is no unit
_BRACKETED_NAME = re.compile(r"^\(([^()/]+)\)\s*/\s*(\S+)$")
_BEHIND_SIGN = re.compile(r"^(.+?)\s*(?:/|,| in |_in_)\s*(\S+)$")
_BEHIND_LAST_STROKE = re.compile(r"^(.+)\s*/\s*(\S+)$")  # dL/L0/%
_BARE_POWER = re.compile(
    r"(?<=[/\[(])([eE]-\d+)(?=[\])]?\s*$)"
)  # of ten, behind a name: the cell 5e-7 has a number
_AGAIN = re.compile(r"(.+) \(\d+\)")  # a head that was written before
_WORD = re.compile(r"[^_\s]+")
_LAST_WORD = re.compile(r"^(.*?)[_\s-]+([^\s_-]+)$")
_LETTERS_ONLY = ("t", "h", "m", "l", "f", "d", "g")  # behind most names, an index or a word


def name_and_unit(name: str, written_unit: str = "") -> tuple[str, str]:
    """The name of a column without its unit, and the unit as it is written ("" for none).

    >>> name_and_unit("Force (N)"), name_and_unit("Kraft/N"), name_and_unit("T_degC"), name_and_unit("SMA temperature")
    (('Force', 'N'), ('Kraft', 'N'), ('T', 'degC'), ('SMA temperature', ''))
    >>> name_and_unit("DSC/(mW/mg)")
    ('DSC', 'mW/mg')
    >>> name_and_unit("H_kA_per_m"), name_and_unit("field E_kV_per_cm")
    (('H', 'kA_per_m'), ('field E', 'kV_per_cm'))
    >>> name_and_unit("(Q-Qo)/mA.h"), name_and_unit("Kraft (Analog 1) [kN]"), name_and_unit("103 <Rwire> (OHM)")
    (('Q-Qo', 'mA.h'), ('Kraft (Analog 1)', 'kN'), ('103 Rwire', 'OHM'))
    >>> name_and_unit("Temp, °C (LGR S/N: 10224511, LBL: bath)"), name_and_unit("U2-1[]")
    (('Temp', '°C'), ('U2-1', ''))
    >>> name_and_unit("dL/Lo/*10^-3"), name_and_unit("dL/L0"), name_and_unit("ΔL/L0/%")
    (('dL/Lo', '*10^-3'), ('dL/L0', ''), ('ΔL/L0', '%'))
    >>> name_and_unit("dL/Lo/E-03"), name_and_unit("strain [e-6]")
    (('dL/Lo', '1E-03'), ('strain', '1e-6'))
    >>> name_and_unit("T / °C (2)"), name_and_unit("coil (2)")
    (('T', '°C'), ('coil (2)', ''))
    >>> name_and_unit("mass_g"), name_and_unit("run_g"), name_and_unit("pos_m")
    (('mass', 'g'), ('run_g', ''), ('pos_m', ''))
    """
    again = _AGAIN.fullmatch(name)
    if not written_unit and again and (stated := name_and_unit(again[1]))[1]:
        return stated
    name = _BARE_POWER.sub(r"1\1", name)
    name = _EMPTY_BRACKET.sub("", name) or name
    if not written_unit and (match := _BRACKETED_NAME.match(name)) and known_unit(match[2]):
        return match[1], match[2]
    if stated := _in_brackets(name, written_unit):
        return stated
    if written_unit:
        return name, written_unit
    if per := _with_quotient(name):
        return per
    for pattern in (_BEHIND_SIGN, _LAST_WORD):
        match = pattern.match(name)
        if match and match[2].isdigit():  # "axis 1": the unit 1 stands in brackets or behind a sign
            continue
        if match and _is_stated(match[2], pattern) and (pattern is _BEHIND_SIGN or len(match[2]) <= 6):
            if (
                pattern is _LAST_WORD
                and match[2].lower() in _LETTERS_ONLY
                and not _is_measured_in(*match.groups())
            ):
                continue
            return match[1], match[2]
    if (match := _BEHIND_LAST_STROKE.match(name)) and _is_share(match[2]):
        return match[1], match[2]
    return name, ""


def _is_measured_in(label: str, letter: str) -> bool:
    """Whether a letter behind a name is the unit of the quantity of that name; m stands for "measured", too."""
    known = DIMENSIONS.get(quantity_of_name(label)[0], ())
    return letter != "m" and dimension(known_unit(letter)) in known


def _in_brackets(name: str, written_unit: str) -> tuple[str, str] | None:
    """The name without the unit in the last of its brackets that holds a known one, else in the last one; None if no
    bracket holds a unit. "<Name>" and "(serial no: 7)" hold none.
    """
    brackets = [b for b in _BRACKET.finditer(name) if b[1].strip() and not b[1].strip().isdigit()]
    known = [b for b in brackets if known_unit(b[1], temperature=True)]
    words = [b for b in brackets if "<" not in b[0] and not _REMARK.fullmatch(b[1])]
    able = known or (words if not written_unit else [])
    if not able:
        bare = _without_remarks(name, brackets)
        return name_and_unit(bare, written_unit) if bare != name else None
    unit = able[-1]
    label = f"{name[: unit.start()]} {name[unit.end() :]}".strip()
    return _without_remarks(label, _BRACKET.finditer(label)).rstrip(" /") or name, written_unit or unit[
        1
    ].strip()


def _without_remarks(name: str, brackets: Iterable[re.Match[str]]) -> str:
    """A name without the remarks in its brackets, and with "<Name>" as that name."""
    for b in brackets:
        if "<" in b[0] or _REMARK.fullmatch(b[1]):
            name = name.replace(b[0], f" {b[1].strip()} " if "<" in b[0] else " ")
    return name.strip()


def _is_stated(unit: str, pattern: re.Pattern[str]) -> bool:
    """Whether a word behind a name is a unit; behind a sign also one of known parts, such as V/mA."""
    parts = unit.split("/") if pattern is _BEHIND_SIGN else [unit]
    return known_unit(unit) != "" or all(known_unit(part) for part in parts)


def _is_share(unit: str) -> bool:
    """Whether a word is a unit of ratios, as % or *10^-3."""
    known = known_unit(unit)
    return known not in ("", "1") and dimension(known) == "ratio"


def _with_quotient(name: str) -> tuple[str, str] | None:
    """The name without the unit at its end that is written with "per", and that unit."""
    for word in list(_WORD.finditer(name))[1:]:
        label, unit = name[: word.start()].strip("_- "), name[word.start() :]
        if "per" in _WORD.findall(unit) and known_unit(unit):
            return label, unit
    return None


def quantity_of_name(name: str) -> tuple[str, bool]:
    """The quantity that a name means ("" if none), and whether it is a commanded value.

    >>> quantity_of_name("Kraft"), quantity_of_name("T_soll"), quantity_of_name("spam")
    (('force', False), ('', True), ('', False))
    """
    text = plain(name)
    quantity = next((q for q, words in _WORDS if re.search(words, text)), "")
    return quantity, is_commanded(name)


def names_another(name: str) -> bool:
    """Whether a name says a quantity that is none of a wire, and no temperature.

    >>> names_another("Rotor rpm"), names_another("flow_rate"), names_another("ch 3")
    (True, True, False)
    """
    return _OTHERS.search(plain(name)) is not None


def is_commanded(text: str) -> bool:
    """Whether a name says that a value was commanded, and not measured.

    >>> is_commanded("fSollKraft"), is_commanded("MAIN.fActForce"), is_commanded("Consigne"), is_commanded("offset")
    (True, False, True, False)
    """
    return any(_COMMANDED.search(plain(words)) for words in (text, _CAMEL.sub(" ", text)))


def is_remarked_as_commanded(comment: str) -> bool:
    """Whether the comment of a column says so: its other words may refer to anything.

    >>> is_remarked_as_commanded("Sollwert"), is_remarked_as_commanded("ref. 20 °C, set 3")
    (True, False)
    """
    return _REMARKED.search(plain(comment)) is not None


def is_letter_with_index(name: str) -> bool:
    """Whether a name is the letter of a current or a voltage with an index, as any short word with it may be.

    >>> is_letter_with_index("Iheat"), is_letter_with_index("Strom"), is_letter_with_index("U")
    (True, False, False)
    """
    return _LETTERS.fullmatch(name.strip()) is not None


def is_quotient(name: str) -> bool:
    """Whether a name with a stroke is a quotient of two quantities, and no path.

    >>> is_quotient("dB/dt"), is_quotient("ΔL/L0"), is_quotient("p/p0"), is_quotient("rig/temp")
    (True, True, True, False)
    """
    return (
        quantity_of_name(name)[0] in (RATE, RELATIVE_PRESSURE)
        or re.search(_OF_LENGTHS, plain(name)) is not None
    )


def plain(name: str) -> str:
    """A name in small letters without accents, with one blank for each other sign between its words."""
    text = without_accents(name.replace("ß", "ss").replace("ε", "eps").replace("σ", "sigma")).lower()
    return re.sub(r"[_\s.:-]+", " ", text).strip()


def without_accents(text: str) -> str:
    """A text with plain letters in place of accented ones.

    >>> without_accents("échantillon")
    'echantillon'
    """
    return "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))


def without_branch(label: str) -> str:
    """The name of a column without the word that says on which branch it was read.

    >>> without_branch("R_heating"), without_branch("M up")
    ('R', 'M')
    """
    return _BRANCH.sub("", label).strip(" _.-")
