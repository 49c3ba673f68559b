"""The parameters of effects and the constants of a wire in words: pages and texts print these, JSON keeps the names.

A word comes without its unit, which follows the value: "shift 8 K", not "shift_K 8 K".
"""

_OF_THE_WIRE = {
    "R_M": "resistance of martensite R_M",
    "R_A": "resistance of austenite R_A",
    "tau": "thermal time constant τ",
    "R_over_hA": "steady temperature per squared current R/hA",
    "hA": "heat loss to the room hA",
    "dead_time": "dead time of the position",
}
_OTHERS = {
    "at": "position in the range",
    "latent": "latent heat",
    "h": "heat transfer coefficient",
    "tau": "time constant",
    "cooler": "temperature of the ends over that of the middle",
}


def constant_words(name: str) -> str:
    """A calibrated constant of the wire in words, with its symbol; one without words as it is.

    >>> constant_words("R_M")
    'resistance of martensite R_M'
    """
    return _OF_THE_WIRE.get(name, name.replace("_", " "))


def parameter_words(name: str, unit: str) -> str:
    """A parameter of an effect in words, without its unit.

    >>> parameter_words("swing_K", "K"), parameter_words("latent_J_per_g", "J/g"), parameter_words("gain_percent", "%")
    ('swing', 'latent heat', 'gain')
    >>> parameter_words("percent_per_cycle", "%/cycle"), parameter_words("at", "range"), parameter_words("at_h", "h")
    ('rate', 'position in the range', 'at')
    """
    if name.startswith("percent_per_"):
        return "rate"
    plain = name.removesuffix(f"_{unit.replace('/', '_per_')}").removesuffix("_percent")
    if plain == "at" and unit != "range":
        return "at"  # a moment
    return _OTHERS.get(plain, plain.replace("_", " "))
